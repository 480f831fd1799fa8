#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/axes/axis.h"
#include "core/base/check.h"
#include "core/math/motion_point.h"
#include "core/state/relocation.h"
#include "core/state/state.h"

namespace taut {

/// How a law pulls point P of A and point Q of B along the line between them, so that it can be drawn.
struct LineForce {
  BodyId a, b;                                    ///< the bodies A and B
  Vec3 p_AP = Vec3::Zero(), p_BQ = Vec3::Zero();  ///< from the centres of mass, body axes [m]
  double tension = 0;                             ///< [N], negative: it pushes them apart
  bool elastic = true;                            ///< its tension depends on the length; else a mere damper
};

/// All that a law does, if it is a spring or damper between point P of A and point Q of B: its force acts
/// along the line between them by their distance L = |p_WQ − p_WP| and dL/dt, as AxisSpring says with L for
/// θ. Solvers that can take it implicitly do.
struct LineSpring {
  BodyId a, b;                                    ///< the bodies A and B
  Vec3 p_AP = Vec3::Zero(), p_BQ = Vec3::Zero();  ///< from the centres of mass, body axes [m]
  AxisSpring law;                                 ///< with L for θ

  /// Linear without a length of its own: its force −k d is smooth where P and Q meet.
  bool is_centred() const { return law.rest == 0 && law.stiffness > 0; }
  bool is_damped() const { return law.damping > 0 || law.damping_table; }  ///< dL/dt matters
};

/// Whether springs between bodies count among the force laws; not where they have rows
/// (core/constraints/rows.h).
enum class Springs { kIncluded, kLeftOut };

/// A force law f(q, V, t).  Gravity is not one of them; the World adds it.
class Force {
 public:
  virtual ~Force() = default;
  /// Adds the wrench on each body, world axes about its centre of mass [N·m, N].
  virtual void accumulate(const State& state, std::span<Wrench> wrenches) const = 0;
  /// Potential energy [J]; 0 for laws that have none.
  virtual double potential_energy(const State&) const { return 0; }
  /// True if f depends on V: the integrator then iterates its second half kick.
  virtual bool depends_on_velocity() const { return false; }
  /// True if f may change between steps for reasons of its own, as a callback that reads a command does: it
  /// is asked anew at the start of each step, so that the whole step has the new value.
  virtual bool may_change() const { return false; }
  /// True if f is no more than the gradient of its potential: its work is then no loss.
  virtual bool conservative() const { return false; }
  /// The bodies it reads or acts on, so that the World can check them.
  virtual std::vector<BodyId> bodies() const { return {}; }
  /// All that it does, if that is a spring between two bodies; null otherwise.
  virtual const LineSpring* spring() const { return nullptr; }
  /// What it does along a line, so that it can be drawn; nothing for laws that do something else too.
  virtual std::optional<LineForce> line_force(const State&) const { return std::nullopt; }
  /// This law for World::append(): its ids changed, and what it has in world axes moved by X.  Null if
  /// the law cannot say; it then gets a copy of the state as its own world would see it, each time.
  virtual std::shared_ptr<const Force> relocated(const Relocation&, const Pose&) const { return nullptr; }
};

/// Force f [N] at point P of a body, in world axes; with `follows_body` in body axes; constant, or with a
/// `factor`, a function of time (core/state/motion.h), f factor(t).
/// Wrench (r × f, f) with r = R_WB p_BP; potential −f·p_WP, none for a follower or with a factor.
/// (core/state, Eq. 2)
/// @throws std::invalid_argument if the point or the force is not finite.
class PointForce final : public Force {
 public:
  PointForce(BodyId body, const Vec3& p_BP, const Vec3& force, bool follows_body = false, Motion factor = {});
  void accumulate(const State& state, std::span<Wrench> wrenches) const override;
  double potential_energy(const State& state) const override;
  bool conservative() const override { return !follows_body_ && !factor_; }
  std::vector<BodyId> bodies() const override { return {body_}; }
  std::shared_ptr<const Force> relocated(const Relocation& to, const Pose& X) const override;

 private:
  BodyId body_;
  Vec3 p_BP_, force_;
  bool follows_body_;
  Motion factor_;
};

/// Torque [N·m] in world axes, or with `follows_body` in body axes; constant, or times a `factor`, a function
/// of time.  It has no potential.
/// @throws std::invalid_argument if the torque is not finite.
class BodyTorque final : public Force {
 public:
  BodyTorque(BodyId body, const Vec3& torque, bool follows_body = false, Motion factor = {});
  void accumulate(const State& state, std::span<Wrench> wrenches) const override;
  std::vector<BodyId> bodies() const override { return {body_}; }
  std::shared_ptr<const Force> relocated(const Relocation& to, const Pose& X) const override;

 private:
  BodyId body_;
  Vec3 torque_;
  bool follows_body_;
  Motion factor_;
};

/// A body and its mass [kg].
struct FieldMass {
  BodyId body;      ///< that the field acts on
  double mass = 0;  ///< ≥ 0
};
/// A field of acceleration a [m/s²], world axes, constant or times a `factor`, a function of time: the force
/// m a factor(t) on each body, beside gravity.  A frame that shakes with the acceleration x¨ is the field
/// −x¨. Potential −m a·p, none with a factor.
/// @throws std::invalid_argument if the acceleration is not finite, or a mass negative or not finite.
class AccelerationField final : public Force {
 public:
  AccelerationField(std::vector<FieldMass> masses, const Vec3& acceleration, Motion factor = {});
  void accumulate(const State& state, std::span<Wrench> wrenches) const override;
  double potential_energy(const State& state) const override;
  bool conservative() const override { return !factor_; }
  std::vector<BodyId> bodies() const override;
  std::shared_ptr<const Force> relocated(const Relocation& to, const Pose& X) const override;

 private:
  std::vector<FieldMass> masses_;
  Vec3 acceleration_;
  Motion factor_;
};

/// Spring and damper between point P of A and point Q of B, L = |p_WQ − p_WP|: tension
/// k (L − L₀) + c dL/dt [N] along the line, potential ½ k (L − L₀)², or both parts by tables; no force where
/// L = 0.                                                                               (core/state, Eq. 3)
/// @throws std::invalid_argument if a point is not finite, k [N/m], L₀ [m] or c [N·s/m] negative or not
/// finite, or the tables are none for an axis (check_axis()).
class SpringDamper final : public Force {
 public:
  SpringDamper(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double stiffness, double rest_length,
               double damping);
  /// `law` over the distance; its `rest` is L₀.
  SpringDamper(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, AxisSpring law);
  void accumulate(const State& state, std::span<Wrench> wrenches) const override;
  double potential_energy(const State& state) const override;
  bool depends_on_velocity() const override { return spring_.is_damped(); }
  bool conservative() const override { return !spring_.is_damped(); }
  std::vector<BodyId> bodies() const override { return {spring_.a, spring_.b}; }
  const LineSpring* spring() const override { return &spring_; }
  std::optional<LineForce> line_force(const State& state) const override;
  std::shared_ptr<const Force> relocated(const Relocation& to, const Pose& X) const override;

 private:
  /// The tension, and what the wrenches need besides.
  struct Pull {
    Vec3 r_A, r_B;          // arms, world axes
    Vec3 n = Vec3::Zero();  // from P to Q, unit; 0 where L = 0
    double tension = 0;
  };
  Pull pull(const State& state) const;

  LineSpring spring_;
};

/// Any law the user writes.  The function adds to the wrenches (world axes, about the centres of mass); it
/// must not keep the span, and must depend on its arguments alone: solvers call it at trial states too.
/// @throws std::invalid_argument for an empty function.
class ForceCallback final : public Force {
 public:
  using Function = std::function<void(const State&, std::span<Wrench>)>;  ///< adds f(q, V, t)
  explicit ForceCallback(Function function, bool depends_on_velocity = true,
                         std::function<double(const State&)> potential = {})
      : function_(std::move(function)), potential_(std::move(potential)), velocity_(depends_on_velocity) {
    if (!function_) fail("force callback", "must be callable", "empty function");
  }
  void accumulate(const State& state, std::span<Wrench> wrenches) const override;
  double potential_energy(const State& state) const override;
  bool depends_on_velocity() const override { return velocity_; }
  bool may_change() const override { return true; }
  bool conservative() const override { return potential_ && !velocity_; }

 private:
  Function function_;
  std::function<double(const State&)> potential_;
  bool velocity_;
};

}  // namespace taut
