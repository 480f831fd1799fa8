#pragma once

#include <span>
#include <vector>

#include "core/state/state.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// q ← q₀ ⊕ h V of the bodies that move, rotations by exp(h ω) in world axes.
inline void move_poses(const MassMatrix& mass, std::span<const Pose> from, std::span<const Twist> velocity,
                       double h, std::span<Pose> to) {
  for (int b = 0; b < mass.size(); ++b) {
    if (mass[b].fixed) continue;
    to[b].p = from[b].p + h * velocity[b].v;
    to[b].q = (exp_so3(h * velocity[b].w) * from[b].q).normalized();
  }
}

/// V ← V₀ + h V̇.
inline void add_twists(std::span<const Twist> from, double h, std::span<const Twist> rate,
                       std::span<Twist> to) {
  for (std::size_t b = 0; b < to.size(); ++b) to[b] = {from[b].w + h * rate[b].w, from[b].v + h * rate[b].v};
}

/// The classical method of order 4 for bodies whose accelerations follow from the state; rotations as
/// rotation vectors from the start of the step [MuntheKaas1998], so that order 4 is kept.
class RungeKutta {
 public:
  struct LeaveAlone {
    void operator()(State&) const {}
  };

  explicit RungeKutta(int bodies) {
    for (auto* twists : {&acceleration_, &slope_, &sum_, &mean_velocity_}) twists->resize(bodies);
  }

  /// A step of h from `state`, whose time stays.  accelerate(stage, weight, accelerations) is called with the
  /// four stages in their order and their weights, whose sum is 1.  Before, close(stage) may move a stage to
  /// where accelerations are to be asked: a smooth map that leaves states alone which joints allow, so that
  /// the method is of order 4 for V̇ and q̇ of there.
  template <typename Accelerate, typename Close = LeaveAlone>
  void advance(const MassMatrix& mass, State& state, double h, Accelerate accelerate, Close close = {}) {
    constexpr double kNode[] = {0, 0.5, 0.5, 1}, kWeight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    stage_ = state;
    for (std::size_t b = 0; b < sum_.size(); ++b) sum_[b] = mean_velocity_[b] = slope_[b] = {};
    for (int i = 0; i < 4; ++i) {
      if (i > 0) {
        move_poses(mass, state.poses, slope_, kNode[i] * h, stage_.poses);
        add_twists(state.twists, kNode[i] * h, acceleration_, stage_.twists);
      }
      stage_.time = state.time + kNode[i] * h;
      if (i > 0) close(stage_);
      // slope_ still holds this stage's displacement per time: its rotation vector turns ω into a rate of
      // rotation vectors.
      for (std::size_t b = 0; b < slope_.size(); ++b) {
        const Vec3 theta = kNode[i] * h * slope_[b].w;
        slope_[b] = {rotation_rate(theta, stage_.twists[b].w), stage_.twists[b].v};
      }
      accelerate(stage_, kWeight[i], acceleration_);
      add_twists(sum_, kWeight[i], acceleration_, sum_);
      add_twists(mean_velocity_, kWeight[i], slope_, mean_velocity_);
    }
    move_poses(mass, state.poses, mean_velocity_, h, state.poses);
    add_twists(state.twists, h, sum_, state.twists);
  }

 private:
  /// Rate of the rotation vector θ of q = exp(θ) q₀ when q turns with ω in world axes: the inverse of the
  /// right-trivialised derivative, dexp⁻¹_θ ω = ω − ½ θ × ω + 1/12 θ × (θ × ω) + O(θ⁴) [Hairer2006, III.4].
  static Vec3 rotation_rate(const Vec3& theta, const Vec3& w) {
    return w - 0.5 * theta.cross(w) + theta.cross(theta.cross(w)) / 12;
  }

  State stage_;
  std::vector<Twist> acceleration_, slope_, sum_, mean_velocity_;
};

}  // namespace taut
