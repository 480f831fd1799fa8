#include "scenes/program/export_command.h"

#include <iostream>

#include "core/base/check.h"
#include "scenes/export/mjcf_export.h"
#include "scenes/export/urdf_export.h"
#include "scenes/import/import.h"
#include "scenes/program/run_command.h"
#include "scenes/support/output_file.h"

namespace taut {

int export_command(const std::string& name, const std::map<std::string, double>& parameters,
                   const std::string& output) {
  const bool urdf = output.ends_with(".urdf");
  if (!urdf && !output.ends_with(".xml") && !output.ends_with(".mjcf"))
    fail("--output", "must end in .urdf, .xml or .mjcf", output);
  std::vector<NamedFile> inputs;
  if (is_scene_or_model_file(name)) inputs.push_back({"the scene", name});
  require_distinct({{"--output", output}}, inputs);
  require_writable("--output", output);
  const Scene scene = open_scene_or_model(name, parameters);
  std::vector<std::string> notices;
  const std::string text = urdf ? urdf_of(scene, notices) : mjcf_of(scene, notices);
  for (const std::string& notice : notices) std::cerr << "taut: " << notice << '\n';
  const std::string error = write_output(output, text);
  if (error.empty()) return kExitSuccess;
  std::cerr << "taut: could not write " << error << '\n';
  return kExitFailure;
}

}  // namespace taut
