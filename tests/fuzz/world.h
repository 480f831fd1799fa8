#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Random worlds that touch, and what became of each.
namespace taut::fuzz {

/// The kinds of worlds, in the order of seeds: seed s is of kind s mod their number.
inline constexpr const char* kWorldKinds[] = {"chains", "nets", "ragdolls", "heaps", "mechanisms"};

/// A scene file of the seed, of one second: 3 to some 40 bodies that fall on a floor, on pegs, in a pit or on
/// each other.  The same on every machine.
nlohmann::json make_world(std::uint64_t seed);

/// How a world went; a line of the file that --csv writes.
struct WorldRecord {
  std::uint64_t seed = 0;
  int kind = 0;
  int planned = 0;  ///< steps of a second
  int steps = 0;    ///< that were taken
  /// "done", or why it ended: "not converged", "contradiction", …, "refused", "cut" for want of time,
  /// "crash".
  std::string end = "done";
  bool named = false;           ///< a contradiction says who, or another status has culprits
  int inexact = 0;              ///< steps
  double residual = 0;          ///< largest of inexact steps
  double natural_residual = 0;  ///< largest of exact ones
  long newton = 0;              ///< Newton steps for contacts, of all steps
  long most_newton = 0;         ///< of one
  double gain = -1;  ///< most that contacts gave in a step, with their friction, over the energy of the world
  double gain_time = 0;
  double normal_gain = -1;  ///< likewise their normal impulses alone
  double penetration = 0;   ///< deepest, over the smallest size of a body
  double gap = 0;           ///< largest of a joint, from outside or as reported [m or rad]
  double seconds = 0;       ///< of processor time
  std::string remark;       ///< message, or what an oracle found
};

std::string csv_header();
std::string csv_line(const WorldRecord& record);
/// @throws std::runtime_error for a line that csv_line() has not made
WorldRecord parse_csv_line(const std::string& line);

/// Markdown: a row for each kind and one for all.
std::string campaign_table(const std::vector<WorldRecord>& records);
/// Those that did not do what is asked of all, the worst first, a line each.
std::string campaign_finds(const std::vector<WorldRecord>& records);

}  // namespace taut::fuzz
