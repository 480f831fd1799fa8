#include "core/base/check.h"

#include <Eigen/Core>

namespace taut {

void detail::fail_matrix(std::string_view name, std::string_view problem, const double* values, int rows,
                         int columns) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  fail(name, problem, Eigen::Map<const Matrix>(values, rows, columns));
}

}  // namespace taut
