#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/clock.h"
#include "scenes/builders/scene.h"
#include "scenes/program/live_server.h"
#include "scenes/recording/frame_sampler.h"
#include "solvers/simulator/simulator.h"

namespace taut {

/// `--live`: where a run can be watched and driven.
struct LiveOptions {
  std::optional<std::string> port;     ///< as typed; "0": any free one
  std::optional<std::string> address;  ///< --live-address
  bool wanted() const { return port || address; }
};

/// @throws std::invalid_argument for a port or an address that is none, or an address that is given as port.
LiveServer::Options live_server_options(const LiveOptions& options);

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

/// Lets browsers watch a run and drive it: pause, single steps, reset, speed, motors, and pulling bodies.
class LiveRun {
 public:
  /// @param may_reset whether the run may go back to its start: not if it writes files
  LiveRun(const LiveOptions& options, Scene& scene, Simulator& simulator, bool may_reset);

  std::string url() const { return server_->url(); }
  /// Does what browsers ask for, and waits while the run is paused or ahead of the clock; then lets pulled
  /// bodies be pulled in the next step of h.  @returns false if a signal has come.
  bool before_step(double h);
  /// Shows the state after a step, at most 60 times a second.
  void after_step();
  /// Shows how the run ended.
  void finish(const std::string& status, const std::string& message);

 private:
  struct Motor {
    AxisId axis;
    double start;  // target at the start
  };
  void answer(const LiveServer::Message& message);
  void obey(int browser, const std::string& text);
  void note(int browser, const std::string& problem);
  void set_motor(int index, double target);
  void reset();
  void set_paused(bool paused);
  bool is_waiting() const;
  void show();
  nlohmann::json motors() const;
  nlohmann::json state() const;

  Scene& scene_;
  Simulator& simulator_;
  FrameSampler sampler_;
  RecordingHeader header_;
  bool may_reset_;
  std::vector<Motor> motors_;
  Checkpoint start_;
  std::unique_ptr<LiveServer> server_;
  std::map<int, LivePull> pulls_;  // by browser
  bool paused_ = false, changed_ = false;
  int asked_steps_ = 0;  // while paused
  std::int64_t steps_ = 0;
  int resets_ = 0, notes_ = 0;
  double speed_ = 1;
  Clock::time_point clock_ = Clock::now(), shown_{};  // when the time was time_, and of the last frame
  double time_ = 0;
  std::string status_ = "running", message_;
};

}  // namespace taut
