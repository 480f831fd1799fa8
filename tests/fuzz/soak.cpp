#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/program/run_record.h"
#include "solvers/simulator/simulator.h"

// Very many steps of scenes that are meant to run for ever:
//   soak [--steps 1000000] [--seconds S] [--once] [--only NAME]... [--keep DIR] [--run 1|2]
// Each scene is run twice, and must end with the same bits; joints must be closed to 1e-9 after each step,
// and the memory of the process must not grow.  Prints a table; the exit status is 1 if anything of that does
// not hold.
//   --seconds S  each run ends after that time, the second after as many steps as the first
//   --keep DIR   each run leaves a checkpoint there each minute; started again it goes on from that
//   --run N      one of the two only, for two processes; the second is compared with what is in DIR

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
    {"tank", "tank", {{"n", 30}}, 5e-4},
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
  double memory_early = 0, memory_late = 0;  ///< most in the second tenth of what was measured, and the last
  bool memory_grows = false;                 ///< in any of the pieces of the run
  std::uint64_t fingerprint = 0;
  std::string failed;
};

std::string file_of(const SoakScene& what, int run, const std::string& folder) {
  return folder + "/" + what.builder + "." + std::to_string(run);
}

void save(const Result& r, const Checkpoint& checkpoint, const std::string& file) {
  {
    std::ofstream out(file + ".new", std::ios::binary);
    out.precision(17);
    out << r.steps << ' ' << r.inexact << ' ' << r.seconds << ' ' << r.gap << ' ' << r.longest << ' '
        << r.memory_early << ' ' << r.memory_late << ' ' << r.memory_grows << ' ' << r.fingerprint << '\n'
        << checkpoint << '\n'
        << r.failed << '\n';
    if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
  }
  std::filesystem::rename(file + ".new", file);
}

/// What was left in the file; nothing done yet if there is none.
Result load(const std::string& file, Checkpoint& checkpoint) {
  Result r;
  std::ifstream in(file, std::ios::binary);
  if (!in) return r;
  in >> r.steps >> r.inexact >> r.seconds >> r.gap >> r.longest >> r.memory_early >> r.memory_late >>
      r.memory_grows >> r.fingerprint;
  in.ignore();
  in >> checkpoint;
  in.ignore();
  std::getline(in, r.failed);
  if (!in) throw std::runtime_error(file + ": is not whole");
  return r;
}

/// Memory must be flat: a tenth is what the allocator may keep.
void judge_memory(const std::vector<double>& memory, Result& result) {
  const auto most = [&](std::size_t from, std::size_t to) {
    return from < to ? *std::max_element(memory.begin() + static_cast<long>(from),
                                         memory.begin() + static_cast<long>(to))
                     : 0;
  };
  const std::size_t tenth = memory.size() / 10;
  if (tenth == 0) return;
  result.memory_early = most(tenth, 2 * tenth), result.memory_late = most(9 * tenth, memory.size());
  if (result.memory_late > 1.1 * result.memory_early) result.memory_grows = true;
}

Result soak(const SoakScene& what, long steps, double seconds, const std::string& file) {
  Scene scene = build_scene(what.builder, what.parameters);
  scene.settings.threads = 1;
  scene.settings.report_energy = false;
  Checkpoint checkpoint;
  Result result = file.empty() ? Result{} : load(file, checkpoint);
  Simulator simulator(scene.world, scene.settings);
  if (!checkpoint.empty()) simulator.restore(checkpoint);
  std::vector<double> memory;
  const auto start = Clock::now();
  const double before = result.seconds;
  auto last = start, saved = start;
  while (result.steps < steps && result.failed.empty()) {
    const StepReport& report = simulator.step(what.dt);
    const auto now = Clock::now();
    result.longest = std::max(result.longest, std::chrono::duration<double>(now - last).count());
    result.seconds = before + std::chrono::duration<double>(now - start).count();
    last = now;
    if (!report.ok()) {
      result.failed = report.message.empty() ? "failed" : report.message;
      break;
    }
    ++result.steps;
    if (!report.exact()) ++result.inexact;
    result.gap = std::max({result.gap, report.gap.metres, report.gap.radians});
    if (result.steps % 500 == 0) memory.push_back(resident_megabytes());
    if (!file.empty() && now - saved > std::chrono::minutes(1)) {
      save(result, simulator.checkpoint(), file);
      last = saved = Clock::now();
    }
    if (seconds > 0 && now - start > std::chrono::duration<double>(seconds)) break;
  }
  judge_memory(memory, result);
  result.fingerprint = fingerprint(scene.world.state());
  if (!file.empty()) save(result, simulator.checkpoint(), file);
  return result;
}

std::string verdict_of(const Result& r) {
  std::string verdict = !r.failed.empty() ? "failed: " + r.failed : r.gap > 1e-9 ? "open" : "";
  return r.memory_grows ? verdict + " memory grows" : verdict;
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
  int run = 0;  // both
  bool once = false;
  std::string folder;
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
    else if (key == "--keep")
      folder = value();
    else if (key == "--run")
      run = std::atoi(value().c_str());
    else
      return std::fprintf(stderr, "unknown option %s\n", argv[i]), 2;
  }
  if (!folder.empty()) std::filesystem::create_directories(folder);
  const auto file = [&](const SoakScene& scene, int number) {
    return folder.empty() ? std::string() : file_of(scene, number, folder);
  };
  std::printf("%-18s %9s %10s %11s %10s %9s %8s %15s  %-16s\n", "scene", "steps", "time", "a step", "longest",
              "gap", "inexact", "MB early, late", "fingerprint");
  int bad = 0;
  for (const SoakScene& scene : kScenes) {
    if (!only.empty() && std::find(only.begin(), only.end(), scene.builder) == only.end()) continue;
    Checkpoint unused;
    const Result first = run == 2 && !folder.empty() ? load(file(scene, 1), unused)
                                                     : soak(scene, steps, seconds, file(scene, 1));
    if (run != 2) print(scene.name, first, verdict_of(first).c_str());
    bad += run != 2 && !verdict_of(first).empty();
    if (once || run == 1) continue;
    // After as many steps as the first, unless that one is on its way.
    const Result second = soak(scene, run == 2 ? steps : first.steps, run == 2 ? seconds : 0, file(scene, 2));
    std::string verdict = verdict_of(second);
    if (second.steps != first.steps)
      verdict += "not compared yet";
    else
      verdict += second.fingerprint == first.fingerprint ? "same bits" : "OTHER BITS";
    print("  again", second, verdict.c_str());
    bad += verdict != "same bits";
  }
  return bad > 0;
}
