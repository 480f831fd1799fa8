#include "scenes/program/import_command.h"

#include <iostream>

#include "scenes/files/scene_file.h"
#include "scenes/import/import.h"
#include "scenes/program/run_command.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/format.h"
#include "scenes/support/output_file.h"

namespace taut {

int import_command(const std::string& model, const std::string& output) {
  require_distinct({{"--output", output}}, {{"the model", model}});
  require_ending("--output", output, FileKind::kJson);
  require_writable("--output", output);
  std::vector<ImportNotice> notices;
  const std::string text = model_scene_text(model, &notices);
  const Scene scene = parse_scene(text, output.empty() ? model : output);
  for (const ImportNotice& notice : notices) std::cerr << notice.text() << '\n';
  const World& world = scene.world;
  std::cerr << "taut: " << counted(world.moving_body_count(), "moving body", "moving bodies") << ", "
            << counted(world.joint_count(), "joint") << ", " << counted(world.shape_count(), "shape") << "; "
            << counted(static_cast<long long>(notices.size()), "notice") << '\n';
  if (output.empty()) {
    std::cout << text;
    return kExitSuccess;
  }
  const std::string error = write_output(output, text);
  if (error.empty()) return kExitSuccess;
  std::cerr << "taut: could not write " << error << '\n';
  return kExitFailure;
}

}  // namespace taut
