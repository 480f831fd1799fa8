#pragma once

#include <map>
#include <string>

namespace taut {

/// `taut export`: a scene as a model, URDF or MJCF by the ending of the file.  What the model lacks is listed
/// on the standard error.  @returns the exit status.
int export_command(const std::string& scene, const std::map<std::string, double>& parameters,
                   const std::string& output);

}  // namespace taut
