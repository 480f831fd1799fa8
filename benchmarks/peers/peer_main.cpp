#include <sys/resource.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "benchmarks/one_blas_thread.h"
#include "benchmarks/peers/peer.h"
#include "benchmarks/timing.h"
#include "collision/contact_finder.h"
#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"

namespace taut::peers {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene = "pendulum-ball", method = "default";
  int n = 2;
  std::string with;
  double rate = 240;  ///< steps per second
  double time = 0;    ///< [s]; 0: the scene's own
  double limit = 60;  ///< processor time of all steps together [s]
};

/// A drift of a hundred times the energy that the scene can turn over, or joints open by its whole size, is
/// no simulation any more.
constexpr double kDivergedDrift = 100, kDivergedGap = 100;
constexpr double kProbeTime = 0.5;
/// Runs that are over sooner [s] are made again, so many times at most, and the fastest counts.
constexpr double kShort = 0.2;
constexpr int kMaxTurns = 5;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Everything measured from the poses and twists that the engine gives.
class Measurer {
 public:
  Measurer(const Scene& scene, double duration)
      : scene_(scene),
        rows_(scene.world),
        phi_(rows_.row_count()),
        duration_(duration),
        start_(energy(scene.world.state())) {
    scale_ = scene.energy_scale > 0 ? scene.energy_scale : std::max(1.0, std::abs(start_));
  }

  double energy(const State& state) const { return total_energy(scene_.world, state); }

  /// @returns false if the motion is none any more.
  bool measure(const State& state) {
    rows_.residual(state, phi_);
    const Gap gap = max_gap(rows_, phi_);
    last_ = gap;
    drift_ = (energy(state) - start_) / scale_;
    const bool sound = std::isfinite(gap.metres) && std::isfinite(drift_) && gap.metres < kDivergedGap &&
                       std::abs(drift_) < kDivergedDrift;
    if (!sound) return false;
    worst_.metres = std::max(worst_.metres, gap.metres);
    worst_.radians = std::max(worst_.radians, gap.radians);
    max_drift_ = std::max(max_drift_, std::abs(drift_));
    max_gain_ = std::max(max_gain_, drift_);
    if (has_contact()) measure_contact(state);
    return true;
  }

  void write(Json& out) const {
    out["max_joint_error_m"] = worst_.metres;
    out["final_joint_error_m"] = last_.metres;
    out["max_joint_angle_error_rad"] = worst_.radians;
    out["energy_drift_rel"] = max_drift_;
    out["final_energy_drift_rel"] = drift_;
    if (!has_contact()) return;
    out["max_energy_gain_rel"] = max_gain_;
    out["max_penetration_m"] = worst_penetration_;
    out["final_penetration_m"] = penetration_;
    out["max_motion_m"] = motion_;
    out["creep_m"] = half_.poses.empty() ? motion_ : creep_;
  }

 private:
  bool has_contact() const { return scene_.world.shape_count() > 0; }
  void measure_contact(const State& state) {
    penetration_ = 0;
    for (const Contact& contact : finder_.find(scene_.world, state))
      penetration_ = std::max(penetration_, -contact.gap);
    worst_penetration_ = std::max(worst_penetration_, penetration_);
    motion_ = std::max(motion_, distance(state, scene_.world.state()));
    if (state.time < 0.5 * duration_) return;
    if (half_.poses.empty()) half_ = state;
    creep_ = std::max(creep_, distance(state, half_));
  }

  /// The farthest that a body's centre is from where it was [m].
  static double distance(const State& now, const State& then) {
    double farthest = 0;
    for (std::size_t b = 1; b < now.poses.size(); ++b)
      farthest = std::max(farthest, (now.poses[b].p - then.poses[b].p).norm());
    return farthest;
  }

  const Scene& scene_;
  Rows rows_;
  std::vector<double> phi_;
  ContactFinder finder_{{.margin = 0, .threads = 1}};
  double duration_;   ///< [s]
  State half_;        ///< at half of that time
  double creep_ = 0;  ///< the farthest that a body's centre has been from there since
  double start_, scale_ = 1, drift_ = 0, max_drift_ = 0, max_gain_ = 0;
  double penetration_ = 0, worst_penetration_ = 0;
  double motion_ = 0;  ///< the farthest that a body's centre has been from its start
  Gap worst_, last_;
};

Scene scene_of(const Options& options) {
  std::map<std::string, double> parameters{{"n", options.n}};
  if (!options.with.empty()) parameters[options.with] = 1;
  return build_scene(options.scene, parameters);
}

double duration_of(const Options& options, const Scene& scene) {
  return options.time > 0 ? options.time : scene.duration;
}

/// The steps of a run.  @returns what became of it.
std::string simulate(Engine& engine, const Scene& scene, const Options& options, Measurer& measurer,
                     Json& out) {
  const double duration = duration_of(options, scene), dt = 1 / options.rate;
  const int steps = static_cast<int>(std::lround(duration / dt));
  const int probe_step = static_cast<int>(std::lround(kProbeTime / dt));
  State state = scene.world.state();
  std::vector<double> times;
  double wall = 0, cpu = 0;
  std::string status = "success";
  for (int i = 1; i <= steps; ++i) {
    const double start = now(), cpu_start = cpu_now();
    engine.step();
    times.push_back(cpu_now() - cpu_start);
    wall += now() - start;
    cpu += times.back();
    if (!engine.trouble().empty()) {
      status = engine.trouble();
      break;
    }
    engine.read(state);
    state.time = i * dt;
    if (!measurer.measure(state)) {
      status = "diverged";
      break;
    }
    if (i == probe_step && !scene.probes.empty()) {
      const Vec3 p = state.poses[scene.probes.front().body.index].p;
      out["probe"] = {p.x(), p.y(), p.z()};
    }
    if (cpu > options.limit && i < steps) {
      status = "time limit";
      break;
    }
  }
  const double simulated = static_cast<double>(times.size()) * dt;
  out["simulated_time_s"] = simulated;
  out["duration_s"] = duration;
  out["steps"] = times.size();
  out["wall_time_s"] = wall;
  out["wall_per_simulated_s"] = wall / simulated;
  out["cpu_per_simulated_s"] = cpu / simulated;
  const std::size_t warm_up = std::min<std::size_t>(10, times.size() / 3);
  out["cpu_per_step_s"] =
      benchmarks::median({times.begin() + static_cast<std::ptrdiff_t>(warm_up), times.end()});
  return status;
}

Json run(const Options& options, const std::string& name, const Factory& factory) {
  const Scene scene = scene_of(options);
  Json out{{"engine", name},
           {"method", options.method},
           {"scene", options.scene},
           {"n", options.n},
           {"with", options.with},
           {"rate_hz", options.rate},
           {"bodies", scene.world.moving_body_count()}};
  out["rows"] = Rows(scene.world).row_count();
  out["probe"] = nullptr;
  try {
    const System system = describe(scene.world);
    Json best;
    double total = 0;
    for (int turn = 0; turn == 0 || (turn < kMaxTurns && total < kShort); ++turn) {
      Json made;
      Measurer measurer(scene, duration_of(options, scene));
      const double start = now();
      const auto engine = factory(system, Method(options.method), 1 / options.rate);
      made["build_time_s"] = now() - start;
      made["status"] = simulate(*engine, scene, options, measurer, made);
      measurer.write(made);
      total += now() - start;
      if (turn == 0 || made["cpu_per_simulated_s"] < best["cpu_per_simulated_s"]) best = made;
    }
    out.update(best);
  } catch (const Unsupported& error) {
    out["status"] = "unsupported";
    out["message"] = error.what();
  } catch (const std::exception& error) {
    out["status"] = "error";
    out["message"] = error.what();
  }
  out["peak_memory_mb"] = peak_memory_mb();
  return out;
}

}  // namespace

int peer_main(int argc, char** argv, const std::string& engine, const Factory& factory) {
  benchmarks::use_one_blas_thread(argv);
  CLI::App app("one scene in " + engine + ", measured from the poses; prints JSON");
  Options options;
  app.add_option("--scene", options.scene, "a scene of the catalogue");
  app.add_option("--n", options.n, "its size");
  app.add_option("--with", options.with, "a parameter of the scene to be 1");
  app.add_option("--method", options.method, "name:key=value,…");
  app.add_option("--rate", options.rate, "steps per second")->check(CLI::PositiveNumber);
  app.add_option("--time", options.time, "time to simulate [s]; default: the scene's");
  app.add_option("--limit", options.limit, "processor time of the steps [s]");
  CLI11_PARSE(app, argc, argv);
  try {
    std::cout << run(options, engine, factory).dump() << std::endl;
  } catch (const std::invalid_argument& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
  return 0;
}

}  // namespace taut::peers
