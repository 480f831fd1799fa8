#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/world/world.h"

/// One scene in one engine, measured in one way.  Each engine is a program of its own, so that one that
/// crashes or hangs harms no other.
namespace taut::peers {

enum class JointKind { kBall, kHinge, kFixed };

/// A joint by its public face: bodies as in the World, 0 the ground.
struct PeerJoint {
  JointKind kind = JointKind::kBall;
  int a = 0, b = 0;
  Vec3 p_AP, p_BQ;       ///< anchors, body axes
  Vec3 p_W;              ///< the same point at the start, world axes
  Vec3 axis_W{0, 0, 0};  ///< of a hinge, at the start
};

/// An edge of a spanning tree that starts at the ground: `child` hangs on `parent` by `joint`, or is free if
/// that is kFree.
struct TreeEdge {
  static constexpr int kFree = -1;
  int joint = 0, parent = 0, child = 0;
};

/// What an engine has to build.
struct System {
  const World* world = nullptr;
  std::vector<PeerJoint> joints;
  std::vector<TreeEdge> tree;  ///< parents before children
  std::vector<int> loops;      ///< joints that are not in the tree

  int body_count() const { return world->body_count(); }
  double mass(int body) const { return world->mass_properties(BodyId{body}).mass(); }
  /// Principal moments about the body axes [kg m²].
  Vec3 moments(int body) const { return world->mass_properties(BodyId{body}).principal_moments(); }
  const Pose& pose(int body) const { return world->pose(BodyId{body}); }
  bool has_contact() const { return world->shape_count() > 0; }
  bool has_free_bodies() const;
};

/// @throws std::invalid_argument for another joint than ball, hinge or fixed, a body whose axes are not
/// principal.
System describe(const World& world);

/// A way to use an engine, "method:key=value,key=value".
struct Method {
  std::string text, name;
  std::map<std::string, double> values;

  explicit Method(const std::string& text);
  double get(const std::string& key, double fallback) const;
};

/// An engine does not have what a scene or a method asks for.
class Unsupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What an engine without contact, as it is used here, says to scenes that have it.
/// @throws Unsupported if there are shapes, or free bodies, which only such scenes have.
void refuse_contact(const System& system);

/// What none of the other engines with contact has.
/// @throws Unsupported if a material has restitution, or more static than dynamic friction.
void require_plain_contact(const System& system);

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step() = 0;
  /// Poses and twists of all bodies as the engine has them after a step.
  virtual void read(State& state) = 0;
  /// What the engine says about its last step; "" if nothing is wrong.
  virtual std::string trouble() const { return ""; }
};

/// @param dt length of the steps [s]
using Factory = std::function<std::unique_ptr<Engine>(const System& system, const Method& method, double dt)>;

/// main() of an engine's program: options --scene, --n, --with, --method, --rate, --time, --limit.  Runs the
/// scene, measures every step from the poses alone, and prints one JSON object, also if the run diverged, hit
/// the limit of processor time, or is not supported.  @returns 0 unless the options are wrong.
int peer_main(int argc, char** argv, const std::string& engine, const Factory& factory);

}  // namespace taut::peers
