#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "scenes/run_record.h"
#include "scenes/scene.h"
#include "solvers/simulator.h"

// Very many steps of scenes that are meant to run for ever:
//   soak [--steps 1000000] [--seconds S] [--once] [--only NAME]...
// Each scene is run twice, and must end with the same bits; joints must be closed to 1e-9 after each step,
// and the memory of the process must not grow.  Prints a table; the exit status is 1 if anything of that does
// not hold.  With
// --seconds each run ends after that time, the second after as many steps as the first.

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;

struct SoakScene {
  const char* name;
  const char* builder;
  std::map<std::string, double> parameters;
  double dt;
};
// Steps short enough that a million of them is the time in which things happen.
const std::vector<SoakScene> kScenes = {
    {"net-corners(20)", "net-corners", {{"n", 20}}, 1e-3},
    {"tank", "tank", {}, 1e-4},
    {"pile(100)", "pile", {{"n", 100}}, 1e-3},
    {"bridge with truck", "vehicle-bridge", {}, 1e-5},
};

double resident_megabytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

struct Result {
  long steps = 0, inexact = 0;
  double seconds = 0, gap = 0, longest = 0;
  double memory_early = 0, memory_late = 0;  ///< most in the second tenth of the steps, and in the last [MB]
  std::uint64_t fingerprint = 0;
  std::string failed;
};

Result soak(const SoakScene& what, long steps, double seconds) {
  Scene scene = build_scene(what.builder, what.parameters);
  scene.settings.threads = 1;
  scene.settings.report_energy = false;
  Result result;
  std::vector<double> memory;
  const auto start = Clock::now();
  Simulator simulator(scene.world, scene.settings);
  auto before = start;
  while (result.steps < steps) {
    const StepReport& report = simulator.step(what.dt);
    const auto now = Clock::now();
    result.longest = std::max(result.longest, std::chrono::duration<double>(now - before).count());
    before = now;
    if (!report.advanced()) {
      result.failed = report.message;
      break;
    }
    ++result.steps;
    if (!report.ok()) ++result.inexact;
    result.gap = std::max({result.gap, report.gap.metres, report.gap.radians});
    if (result.steps % 500 == 0) memory.push_back(resident_megabytes());
    if (seconds > 0 && std::chrono::duration<double>(now - start).count() > seconds) break;
  }
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const auto most = [&](std::size_t from, std::size_t to) {
    return from < to ? *std::max_element(memory.begin() + static_cast<long>(from),
                                         memory.begin() + static_cast<long>(to))
                     : 0;
  };
  const std::size_t tenth = memory.size() / 10;
  result.memory_early = most(tenth, 2 * tenth), result.memory_late = most(9 * tenth, memory.size());
  result.fingerprint = fingerprint(scene.world.state());
  return result;
}

void print(const char* name, const Result& r, const char* verdict) {
  std::printf("%-18s %9ld %8.0f s %8.2f ms %8.2f s %9.2g %8ld %7.1f %7.1f  %016llx  %s\n", name, r.steps,
              r.seconds, 1e3 * r.seconds / static_cast<double>(std::max(1L, r.steps)), r.longest, r.gap,
              r.inexact, r.memory_early, r.memory_late, static_cast<unsigned long long>(r.fingerprint),
              verdict);
  std::fflush(stdout);
}

}  // namespace
}  // namespace taut

int main(int argc, char** argv) {
  using namespace taut;
  long steps = 1000000;
  double seconds = 0;
  bool once = false;
  std::vector<std::string> only;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (key == "--steps")
      steps = std::atol(value().c_str());
    else if (key == "--seconds")
      seconds = std::atof(value().c_str());
    else if (key == "--once")
      once = true;
    else if (key == "--only")
      only.push_back(value());
    else
      return std::fprintf(stderr, "unknown option %s\n", argv[i]), 2;
  }
  std::printf("%-18s %9s %10s %11s %10s %9s %8s %15s  %-16s\n", "scene", "steps", "time", "a step", "longest",
              "gap", "inexact", "MB early, late", "fingerprint");
  int bad = 0;
  for (const SoakScene& scene : kScenes) {
    if (!only.empty() && std::find(only.begin(), only.end(), scene.builder) == only.end()) continue;
    const Result first = soak(scene, steps, seconds);
    std::string verdict = !first.failed.empty() ? "failed: " + first.failed : first.gap > 1e-9 ? "open" : "";
    // A tenth is what the allocator may keep.
    if (first.memory_early > 0 && first.memory_late > 1.1 * first.memory_early) verdict += " memory grows";
    print(scene.name, first, verdict.c_str());
    if (!verdict.empty()) ++bad;
    if (once) continue;
    const Result second = soak(scene, first.steps, 0);
    const bool same = second.fingerprint == first.fingerprint;
    print("  again", second, same ? "same bits" : "OTHER BITS");
    if (!same) ++bad;
  }
  return bad > 0;
}
