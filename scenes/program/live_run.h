#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/base/clock.h"
#include "scenes/builders/scene.h"
#include "scenes/program/live_controls.h"
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
  void answer(const LiveServer::Message& message);
  void note(int browser, const std::string& problem);
  bool is_waiting() const;
  void restart_clock();
  void show();
  nlohmann::json state() const;

  Scene& scene_;
  Simulator& simulator_;
  FrameSampler sampler_;
  RecordingHeader header_;
  LiveControls controls_;
  std::unique_ptr<LiveServer> server_;
  int notes_ = 0;
  Clock::time_point clock_ = Clock::now(), shown_{};  // when the time was time_, and of the last frame
  double time_ = 0;
  std::string status_ = "running", message_;
};

}  // namespace taut
