#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "solvers/simulator/simulator.h"

namespace taut {

/// What pulls a body towards a cursor: a spring with a damper from point P of the body to a place of the
/// world.
struct LivePull {
  BodyId body;               ///< that is pulled
  Vec3 p_BP = Vec3::Zero();  ///< from its centre of mass, body axes [m]
  Vec3 p_WC = Vec3::Zero();  ///< the cursor [m]
  double strength = 1;       ///< factor of the stiffness
};

/// Force on the body at P [N], world axes:  f = k (p_WC − p_WP) − c v_P,  k = m ω², c = 2 ζ m ω, where m is
/// the least mass that P has in any direction, so that a step of h is stable.
/// (scenes/program/LIVE, Eq. 1)
Vec3 pull_force(const World& world, const LivePull& pull, double h);

/// What browsers have asked of a run, by messages: whether it goes on and how fast, where its motors go, and
/// what is pulled.  Knows neither a server nor a clock.
class LiveControls {
 public:
  /// @param may_reset whether the run may go back to its start: not if it writes files
  LiveControls(World& world, Simulator& simulator, bool may_reset);

  /// Does what the text of a message says (scenes/program/LIVE).
  /// @throws std::exception if it is none, which says why; nothing has changed then.
  void obey(int browser, const std::string& text);
  /// A browser has gone: what it pulls is let go.
  void forget(int browser) { pulls_.erase(browser); }

  /// It waits for "play" or "step".
  bool is_waiting() const { return paused_ && asked_steps_ == 0; }
  bool is_paused() const { return paused_; }
  double speed() const { return speed_; }  ///< simulated time against the clock
  /// Lets pulled bodies be pulled in the next step of h.
  void begin_step(double h);
  /// That step was taken.
  void end_step() { ++steps_; }

  /// What is new since this was asked before.
  struct News {
    bool state = false;  ///< something that browsers show
    bool pace = false;   ///< when the next step is due
  };
  News take_news() { return std::exchange(news_, {}); }

  /// What pages need for their sliders, once; and what changes.
  nlohmann::json motors() const;
  nlohmann::json state() const;

 private:
  struct Motor {
    AxisId axis;
    AxisMotor start;         // as the scene has it
    double low, high;        // of its slider [unit of the target]
    bool returning = false;  // to its trajectory, not faster than a slider moves it
  };
  const AxisMotor& motor(const Motor& it) const { return *world_.axis_properties(it.axis).motor; }
  double target(const Motor& it) const;
  void set_target(Motor& it, double target);
  void follow(Motor& it);
  void arrive();
  void set_paused(bool paused);
  void set_speed(double speed);
  void reset();

  World& world_;
  Simulator& simulator_;
  bool may_reset_;
  std::vector<Motor> motors_;
  Checkpoint start_;
  std::map<int, LivePull> pulls_;  // by browser
  bool paused_ = false;
  int asked_steps_ = 0;  // while paused
  std::int64_t steps_ = 0;
  int resets_ = 0;
  double speed_ = 1;
  News news_;
};

}  // namespace taut
