#pragma once

#include <filesystem>
#include <string>

#include "solvers/friction/friction_problem.h"

namespace taut {

/// A problem of frictional contact from a file, with the bodies eliminated.
struct FrictionFile {
  FrictionProblem problem;  ///< in three dimensions
  std::string form;         ///< "local" (W, q, μ) or "global" (M, H, f, b, μ), as in the file
  int dimension = 3;        ///< as in the file; of a plane problem the second tangents are by themselves
};

/// Reads the text files of Siconos (dense or in blocks) and the HDF5 files of FCLIB, whichever the file is;
/// the name does not matter.                                                    (scenes/files/FRICTION.md)
/// @throws std::invalid_argument naming the file and what is wrong with it, or that this build reads no HDF5.
FrictionFile read_friction_file(const std::filesystem::path& file);

/// The text form by itself, `name` for messages.
FrictionFile parse_friction_text(std::string_view text, const std::string& name);

/// A problem without equalities in that text form: local, in blocks of contacts, every number as it is.
/// @throws std::invalid_argument if there are equalities, or as the problem's require_valid().
std::string friction_text(const FrictionProblem& problem);

/// Whether this build reads HDF5.
bool reads_hdf5();

/// A problem in the plane, two rows a contact, with a second tangent that is at rest by itself.
FrictionProblem with_second_tangents(const FrictionProblem::Matrix& W, const Eigen::VectorXd& q,
                                     const Eigen::VectorXd& mu, int equalities);

}  // namespace taut
