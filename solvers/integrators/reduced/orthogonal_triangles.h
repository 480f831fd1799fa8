#pragma once

#include <Eigen/Core>

namespace taut {

/// Six numbers a column, six columns at most.
using SixColumns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

/// J⁺ [6 × m] of m ≤ 6 rows J, given as the columns of Jᵀ, and if asked for an orthonormal N with J N = 0, by
/// Jᵀ P = Q R.  False, and nothing is written, if the rows depend on each other.
bool invert_rows(const SixColumns& J_transposed, Eigen::Matrix<double, 6, Eigen::Dynamic>& inverse,
                 SixColumns* null_space);

}  // namespace taut
