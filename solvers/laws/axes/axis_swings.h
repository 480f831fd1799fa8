#pragma once

#include <array>
#include <span>
#include <vector>

#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_table.h"

namespace taut {

/// Friction and springs of the swing of ball and universal joints, which has no direction at 0: they act
/// along other axes of the joint, by own properties of these.  (solvers/laws, "Axes")
///
/// Where θ₀ ≤ 1e-6 + 2 h |θ̇₀|, friction of the swing acts on the turns about two axes across it: all of it
/// on each of them, until that is more than the disc |(λ_x, λ_y)| ≤ h/2 τ allows; then each has its component
/// of the direction of slip, which moves halfway towards the new one in each solve of the stage.  A spring
/// −k θ j whose rest is 0 is −k s for the swing as a rotation vector s, which is smooth at 0: it acts along
/// both components of s, with the damper −c ṡ, which also resists a bend that goes round, as
/// inside a bent shaft that turns.  At π the components change their sign, so near it the spring acts along
/// the swing itself.  A rest other than 0 is a cone, whose potential has a kink where the swing passes 0.
class AxisSwings {
 public:
  /// Those of the World's properties.
  void find(AxisTable& table);
  /// Properties for a step of h, whose start the axes know.
  void begin(AxisTable& table, std::span<AxisLaw> axes, double h);
  /// Friction of straight swings has another direction than in this solution of a stage, and the stage must
  /// be solved again.
  bool turn(AxisTable& table, std::span<AxisLaw> axes, std::span<const double> lambda,
            std::span<const double> w);

 private:
  /// A joint whose swing has friction: its axes in the table, and the parts of it that the turns bear where
  /// the swing is straight.
  struct Friction {
    int axis = 0;
    std::array<int, 2> turn{-1, -1};
    std::array<double, 2> part{1, 1};
    bool straight = false;  // next to 0
    int solves = 0;         // in which it has turned
  };
  /// A joint with a spring that acts along components of its swing.
  struct Spring {
    int axis = 0;
    std::array<int, 2> component{-1, -1};
  };
  static void begin(const Spring& swing, AxisTable& table, std::span<const AxisLaw> axes, double h);
  static void begin(Friction& swing, AxisTable& table, std::span<AxisLaw> axes, double h);
  static bool turn(Friction& swing, std::span<AxisLaw> axes, const std::array<double, 2>& force,
                   const std::array<double, 2>& rate);
  static void split_friction(const Friction& swing, AxisTable& table);

  std::vector<Friction> frictions_;
  std::vector<Spring> springs_;
};

}  // namespace taut
