#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"

/// Random mechanisms, and what must hold of every one of them, by formulas that are not the library's.
namespace taut::fuzz {

/// A scene file of the seed: 2 to 12 bodies with joints of all types in trees and loops, what acts along
/// their axes, springs, compliance, breaking and contacts; sizes from 1 mm to 1 km, masses over up to 12
/// decades; in gravity on the ground or free; with any integrator, solver and policy.  The same on every
/// machine.
nlohmann::json make_mechanism(std::uint64_t seed);

/// What was found wrong, if anything.
struct Violation {
  std::string oracle;  ///< "gap", "momentum", …
  std::string figures;
};

/// Reads a scene file of make_mechanism() (world frame, masses with principal inertia) by itself, and judges
/// states of the world that the library made of it.
class Judge {
 public:
  explicit Judge(const nlohmann::json& scene);

  /// Of the state that the run starts from, once.
  void start(const World& world);
  /// Of the state after each step that was done.
  std::optional<Violation> judge(const World& world, const StepReport& report, double dt);

 private:
  struct Body {
    double mass = 1;
    Vec3 moments = Vec3::Ones();
    Pose start;
    bool fixed = false;
  };
  /// Points and directions of a joint, in the axes of its bodies, points from the centres of mass.
  struct Tie {
    std::string name, type;
    nlohmann::json keys;
    int a = 0, b = 0;
    Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero(), axis_A = Vec3::UnitZ(), axis_B = Vec3::UnitZ();
    Quat q_AB = Quat::Identity();  ///< at the start
    Quat q_AF = Quat::Identity(), q_BG = Quat::Identity();
    std::vector<std::pair<int, Vec3>> points;
    bool rigid = true;
  };
  struct Momentum {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    double linear_scale = 0, angular_scale = 0;
  };

  void read_bodies(const nlohmann::json& scene);
  void read_joint(const nlohmann::json& joint, int index);
  void read_energy_terms(const nlohmann::json& scene);
  double gap_of(const Tie& tie, const World& world) const;
  double angle_of(const Tie& tie, const State& state) const;
  double displacement_of(const Tie& tie, const State& state) const;
  double wire_of(const Tie& tie, const State& state, double last_weight) const;
  double coupling_gap(const Tie& tie, const State& state) const;
  Momentum momentum(const State& state) const;
  double kinetic(const State& state) const;
  double potential(const State& state, double& push) const;
  double fastest_angle(const State& state, double dt) const;
  std::optional<Violation> judge_gaps(const World& world, const StepReport& report) const;
  std::optional<Violation> judge_momentum(const World& world, const StepReport& report, double dt);
  std::optional<Violation> judge_energy(const World& world, double dt);
  int body(const std::string& name) const;
  const Tie& tie(const std::string& name) const;

  std::vector<Body> bodies_;
  std::vector<std::string> names_;
  std::vector<Tie> ties_;
  nlohmann::json forces_;
  Vec3 gravity_ = Vec3::Zero();
  bool holds_joints_ = true;  ///< the integrator promises closed joints
  bool meets_laws_ = true, keeps_linear_ = false, keeps_angular_ = false, keeps_energy_ = false;
  double angular_bound_ = 1e-7;
  Momentum before_;
  double momentum_scale_ = 0, angular_scale_ = 0;
  std::vector<Twist> twists_before_;
  double least_energy_ = 0, first_potential_ = 0, energy_scale_ = 0, angle_scale_ = 0;
  double size_ = 0, total_mass_ = 0;
  double internal_push_ = 0;  ///< of the tables of springs between bodies [N]
  int steps_ = 0;
};

}  // namespace taut::fuzz
