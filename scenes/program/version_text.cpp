#include "scenes/program/version_text.h"

#include <stdexcept>

#include "scenes/export/html_export.h"
#include "scenes/files/friction_file.h"
#include "scenes/program/live_server.h"
#include "scenes/support/format.h"
#include "solvers/linear/cholmod_factor.h"
#include "solvers/linear/front_kernels.h"

// Versions that CMake has found, or "".
#ifndef TAUT_LIBRARY_VERSIONS
#define TAUT_LIBRARY_VERSIONS \
  { "", "", "" }
#endif

namespace taut {
namespace {

struct LibraryVersions {
  const char *pugixml, *assimp, *fcl;
};
constexpr LibraryVersions kLibraryVersions = TAUT_LIBRARY_VERSIONS;

std::string with_version(const char* name, const char* version) {
  return std::string(name) + (*version ? " " : "") + version;
}

/// What draws in a page, or why nothing can.
std::string pages_text() {
  try {
    return "three.js in " + find_three().string();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace

std::string version_text() {
  const std::pair<const char*, std::string> parts[] = {
      {"models", "URDF, SDF, MJCF by " + with_version("pugixml", kLibraryVersions.pugixml) + "; meshes by " +
                     with_version("assimp", kLibraryVersions.assimp)},
      {"contacts", with_version("FCL", kLibraryVersions.fcl)},
      {"solver", std::string("multifrontal ") + front_kernels().name + "; CHOLMOD " +
                     (CholmodFactor::has_supernodal() ? "with" : "without") + " its supernodal module; " +
                     blas_name()},
      {"live view", serves_live() ? "Boost.Beast" : "not built in: Boost's headers were missing"},
      {"HDF5", reads_hdf5() ? "problems of friction" : "not built in: its library was missing"},
      {"pages", pages_text()},
      {"pictures", "SVG of --plot; those of studies by gnuplot, where it is installed"},
  };
  std::string text = "taut " TAUT_VERSION;
  for (const auto& [part, what] : parts) text += "\n" + format("%-11s", part) + what;
  return text;
}

}  // namespace taut
