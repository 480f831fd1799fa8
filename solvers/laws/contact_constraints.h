#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/laws/contact_cache.h"
#include "solvers/laws/contact_cone.h"
#include "solvers/laws/impact_state.h"
#include "solvers/laws/law_constants.h"

namespace taut {

/// All contacts of a world, by their slots: what they are in the present stage of a step, and what they
/// remember.
struct ContactConstraints {
  /// Along the normal, with the impulse λ of this stage and Λ = λ + what was given before: w + softness λ ≥
  /// target, 0 ≤ Λ ≤ most; between these bounds of Λ there is equality, and at the upper one w + softness λ ≤
  /// target.
  struct NormalLaw {
    double target = 0, softness = 0, most = std::numeric_limits<double>::infinity();
  };
  /// Across it: w + softness λ − target is the slip, which is 0 within the disc.
  struct SlipLaw {
    Vec2 target = Vec2::Zero();
    double softness = 0;
  };
  /// Coulomb's law in two rows: |τ| ≤ bound, against the slip.
  struct Disc {
    double bound = std::numeric_limits<double>::infinity();  ///< a new contact is first taken to hold
    bool slips = false;          ///< it does by the last solution: the state of friction, no mode
    Vec2 direction{1.0, 0.0};    ///< of the slip
    double cross_slope = 0;      ///< friction per slip across its direction; 0: not known
    Vec2 given = Vec2::Zero();   ///< what the first kick gave, in the tangents of now
    Vec2 target = Vec2::Zero();  ///< rate that is rest: takes back what slipped while it should hold

    SlipLaw rigid_law() const { return {slips ? Vec2::Zero() : target, 0}; }  ///< without compliance
  };
  struct Point {
    NormalLaw soft;     ///< of a compliant contact in this stage
    SlipLaw soft_slip;  ///< of its slip in this stage
    bool active = false, live = false, touching = false, pressed = false;
    double gap = 0, approach = 0;
    double least_rate = 0;  ///< that the law of a rigid contact asks for along the normal [m/s]
    double curved = 0;      ///< what is enough for the rates of a drift [m/s]
    bool fresh = true;      ///< has not been through a begin()
    double back = 0;        ///< normal impulse of the first kick
    double yield = 0;       ///< compliance in this stage of a rigid contact that joints hold (let_yield())
    bool stuck = false, slipping = false, stick_candidate = false;
    Vec3 slipped = Vec3::Zero();                             ///< since it sticks [m]
    Vec3 first = Vec3::Zero(), first_torque = Vec3::Zero();  ///< of the first kick on B
    Vec3 first_normal = Vec3::UnitZ();                       ///< along which it was
    double spin_bound = std::numeric_limits<double>::infinity(), spin_given = 0;
    Disc sliding, rolling;
    double borne = 0;             ///< Λ_n of the last solution, if it has friction of turning [N·s]
    double present = 1;           ///< part of the rates of now, not of those before, in linear friction
    Vec3 turning = Vec3::Zero();  ///< B against A before the step, carried with the normal [rad/s]
    Vec3 impulse = Vec3::Zero(), torque = Vec3::Zero();  ///< since clear_reports()
    std::optional<double> impact_time;
    bool slid = false;
  };
  ContactConstraints(const World& world, const Settings& settings)
      : cache(world, {.margin = settings.contact_margin,
                      .threads = settings.threads,
                      .max_contacts = settings.max_contacts}),
        resting_speed(settings.resting_speed),
        locates_plastic(settings.locate_plastic_impacts) {}

  ContactCache cache;
  std::vector<char> moves;  ///< bodies
  std::vector<Point> points;
  std::vector<ImpactState> impacts;
  double resting_speed = 0;
  bool locates_plastic = false;  ///< impacts without restitution, too
  double h = 0;                  ///< of the present step
  double still_rate = 0;  ///< what sticks slips by no more than this for the round-off of positions [m/s]
  bool in_velocities = false;  ///< which stage it is, for those who watch
  bool single_kick = false;
};

}  // namespace taut
