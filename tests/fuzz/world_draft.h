#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/world/rigid_body.h"
#include "tests/fuzz/mechanism_draft.h"

namespace taut::fuzz {

/// A world that is being made: in gravity, some metres large, of bodies of a few densities.
class WorldDraft {
 public:
  explicit WorldDraft(std::uint64_t seed);

  Random random;
  Json scene;
  bool moreau = false;    ///< the integrator is Moreau–Jean, without compliant contacts
  double size = 1;        ///< [m] of a large body; links and limbs are smaller
  double density = 1000;  ///< [kg/m³]

  /// The friction of most bodies, and what a few have besides.
  Json material();
  Json box(const Vec3& edges) { return {{"type", "box"}, {"size", json_of(edges)}}; }
  Json capsule(double radius, double length) {
    return {{"type", "capsule"}, {"radius", radius}, {"length", length}};
  }
  Json ball(double radius) { return {{"type", "sphere"}, {"radius", radius}}; }
  /// Of any type, about as large as a ball of the radius.
  Json solid(double radius);

  /// With the mass and the inertia of its shape, or of one like it.
  /// @return its name
  std::string add_body(Json shape, const Pose& pose, double its_density);
  std::string add_body(const Json& shape, const Pose& pose) { return add_body(shape, pose, density); }
  void set_velocity(const Vec3& v, const Vec3& w);  ///< of the last body
  void set_groups(const Json& groups, const Json& collides_with);
  Json& add_joint(const std::string& type, const std::string& a, const std::string& b, const Vec3& anchor);
  void add_ground(const Json& shape, const Pose& pose = {});

  /// A floor at z = 0: flat, or with pegs, a step, walls about it, or uneven.  It is `half` [m] wide each
  /// way.
  void add_floor(double half);

 private:
  void add_pegs(double half);
  Json settings();
  Json ground_material_;
  double friction_ = 0.5, restitution_ = 0, compliance_ = 0;
};

/// What each kind adds to a draft.
void add_chains(WorldDraft& draft);
void add_net(WorldDraft& draft);
void add_ragdolls(WorldDraft& draft);
void add_heap(WorldDraft& draft);
void add_linkages(WorldDraft& draft);

}  // namespace taut::fuzz
