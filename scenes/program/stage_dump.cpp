#include "scenes/program/stage_dump.h"

#include <utility>

#include "scenes/files/friction_file.h"
#include "scenes/support/format.h"
#include "scenes/support/output_file.h"

namespace taut {

void StageDump::watch(Simulator& simulator) {
  simulator.set_stage_watch(
      [this](const ContactStage& stage) { last_[static_cast<int>(stage.kind)] = stage.problem; });
}

std::string StageDump::write(std::int64_t step) {
  constexpr const char* kKinds[] = {"positions", "velocities"};
  for (std::size_t kind = 0; kind < last_.size(); ++kind) {
    if (!last_[kind]) continue;
    std::filesystem::create_directories(folder_);
    const std::string name = format("%06lld-%s.dat", static_cast<long long>(step), kKinds[kind]);
    const FrictionProblem problem = std::exchange(last_[kind], std::nullopt)->without_equalities();
    if (std::string error = write_output((folder_ / name).string(), friction_text(problem)); !error.empty())
      return error;
  }
  return "";
}

}  // namespace taut
