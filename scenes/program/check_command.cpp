#include "scenes/program/check_command.h"

#include <iostream>

#include "scenes/import/import.h"
#include "scenes/program/run_command.h"
#include "scenes/program/run_settings.h"
#include "scenes/program/start_warnings.h"
#include "scenes/support/format.h"
#include "solvers/common/report_names.h"
#include "solvers/diagnosis/start_checks.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

constexpr std::size_t kMostRows = 20, kMostHolders = 4, kMostReactions = 40;

std::string joint_names(const World& world, const std::vector<JointId>& joints, std::size_t most) {
  return first_of(joints, most, [&](JointId joint) { return world.name(joint); });
}

void print_redundant(const World& world, const std::vector<RedundantRow>& redundant, std::size_t most) {
  if (redundant.empty()) return;
  std::cout << "\nRedundant rows, which do not affect the motion:\n";
  for (std::size_t i = 0; i < redundant.size() && i < most; ++i) {
    const RedundantRow& row = redundant[i];
    std::cout << "  " << world.joint(row.joint).type() << ' ' << world.name(row.joint) << ": " << row.name;
    if (!row.held_by.empty())
      std::cout << " is already held by " << joint_names(world, row.held_by, kMostHolders);
    std::cout << '\n';
  }
  if (redundant.size() > most)
    std::cout << "  and " << redundant.size() - most << " more, which --all names\n";
}

std::string joint_counts(const World& world) {
  std::map<std::string, int, std::less<>> count;
  for (int j = 0; j < world.joint_count(); ++j) ++count[std::string(world.joint(JointId{j}).type())];
  std::string text = std::to_string(world.joint_count());
  const char* before = " (";
  for (const auto& [type, number] : count) {
    text += before + std::to_string(number) + " " + type;
    before = ", ";
  }
  return count.empty() ? text : text + ")";
}

/// What the first step would fail by: limits, motors and contacts included.
void add_contradiction(std::vector<Problem>& problems, const World& world, const Contradiction& found) {
  if (found.empty()) return;
  problems.push_back({"contradiction", "these cannot hold together at the first step (" +
                                           format("%.3g", found.residual) +
                                           " is left): " + list_of(names_of(found, world))});
}

}  // namespace

int check_command(const std::string& name, const std::map<std::string, double>& parameters, bool all) {
  std::vector<ImportNotice> notices;
  Scene scene = open_scene_or_model(name, parameters, &notices);
  World& world = scene.world;
  RunOptions options;
  options.scene = name;
  const SettingSources sources(options, scene);
  require_compatible(scene, sources);
  std::vector<std::string> warnings = scene.warnings;
  for (std::string& warning : settings_without_effect(scene.settings, sources))
    warnings.push_back(std::move(warning));
  for (std::string& warning : start_warnings(world, scene.settings, scene.dt))
    warnings.push_back(std::move(warning));
  for (const ImportNotice& notice : notices) warnings.push_back(notice.text());
  Simulator simulator(world, scene.settings);
  std::vector<Problem> problems;
  if (scene.assemble) {
    const StepReport& report = simulator.assemble();
    if (!report.ok()) problems.push_back({"assembly", report.message});
  }
  const std::vector<Problem> invalid = world.validate();
  problems.insert(problems.end(), invalid.begin(), invalid.end());
  if (const Crowd crowd = start_crowd(world, scene.settings, scene.dt); !crowd.empty())
    problems.push_back({"contacts", "the first step cannot be done: " + text_of(crowd, world)});
  add_contradiction(problems, world, simulator.contradiction(scene.dt));
  for (const Problem& problem : problems)
    std::cout << "problem: " << problem.subject << ": " << problem.message << '\n';
  for (const std::string& warning : warnings) std::cout << "warning: " << warning << '\n';
  const RankReport rank = simulator.analyze_rank();
  std::cout << "scene           " << scene.name << '\n'
            << "bodies          " << world.moving_body_count() << " moving, "
            << world.body_count() - world.moving_body_count() << " fixed (with the ground)\n"
            << "joints          " << joint_counts(world) << '\n'
            << "constraint rows " << rank.rows << '\n'
            << "rank            " << rank.rank << '\n'
            << "freedoms        " << rank.freedoms << '\n'
            << "redundant rows  " << rank.rows - rank.rank << '\n'
            << "solver          " << simulator.solver_description() << '\n';
  print_redundant(world, rank.redundant, all ? rank.redundant.size() : kMostRows);
  if (!rank.not_unique.empty())
    std::cout << "\nReactions that are not unique, of " << rank.not_unique.size()
              << " joints: " << joint_names(world, rank.not_unique, kMostReactions) << '\n';
  if (problems.empty())
    std::cout << (warnings.empty() ? "\nfine: nothing wrong found\n"
                                   : "\nnothing wrong found but the warnings\n");
  else
    std::cout << '\n' << problems.size() << " problem(s) found\n";
  return problems.empty() ? kExitSuccess : kExitFailure;
}

}  // namespace taut
