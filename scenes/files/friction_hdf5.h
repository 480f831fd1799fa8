#pragma once

#include "scenes/files/friction_file.h"

namespace taut {

/// Reads a file of FCLIB's layout, `fclib_local` or `fclib_global`, with equalities (V, R, s; G, b) if it
/// has.
/// @throws std::invalid_argument, also if this build reads no HDF5.
FrictionFile read_friction_hdf5(const std::filesystem::path& file);

}  // namespace taut
