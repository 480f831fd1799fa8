#pragma once

#include <string>
#include <vector>

namespace taut {

/// What must not be in a scene: joints that open; with contact also what comes to rest in each other, or
/// anything that stands and moves.
enum class BenchQuality { kJoints, kCarries, kRests, kStands };

/// One run of `taut bench`: a scene of the catalogue in one engine with one method.
struct BenchRun {
  std::string scene;
  int n = 0;
  std::string with;    ///< a parameter of the scene that is 1: "truck", "top_heavy"
  std::string engine;  ///< program peer_<engine>
  std::string method;
  double rate = 240;                             ///< steps per second
  double time = 0;                               ///< to simulate [s]; 0: the scene's own
  double limit = 60;                             ///< processor time [s]
  BenchQuality quality = BenchQuality::kJoints;  ///< kJoints: without contact

  /// "net-corners 20", "bridge-balls 50 truck"
  std::string scene_label() const;
  std::string engine_label() const;
};

/// "joints", "carries", "rests" or "stands".
std::string name_of(BenchQuality quality);

/// The converged run whose probe all others of the scene are compared with; of scenes without contact.
BenchRun reference_of(const BenchRun& run);

/// Every scene of joints, and every one with contact, in every size, engine and method that is run; quick:
/// small ones, so that all of it takes less than three minutes.
/// @param engines those that were built
std::vector<BenchRun> bench_plan(bool quick, const std::vector<std::string>& engines);

/// One run of work_profile: a scene in taut alone.
struct WorkRun {
  std::string scene;
  int n = 0;
  std::string with{};  ///< as BenchRun::with

  std::string label() const;  ///< as BenchRun::scene_label()
};

enum class WorkSizes { kTwo, kSome, kAll };
/// Nets, bridges, chains and grids of all sizes, of one or two each, or just two small ones.
std::vector<WorkRun> work_plan(WorkSizes sizes);

/// Longest processor time that a plan can take [s].
double longest_time(const std::vector<BenchRun>& plan);

}  // namespace taut
