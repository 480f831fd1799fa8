#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// Error policy: bad input throws std::invalid_argument with the name of the thing, what is wrong and the
/// offending value.  Numerical outcomes are never exceptions; they are a Status in a StepReport.
template <typename Value>
[[noreturn]] void fail(std::string_view name, std::string_view problem, const Value& value) {
  std::ostringstream message;
  message.precision(17);
  message << name << ": " << problem << " (value: " << value << ")";
  throw std::invalid_argument(message.str());
}

namespace detail {
/// As fail(); `values` row by row.
[[noreturn]] void fail_matrix(std::string_view name, std::string_view problem, const double* values, int rows,
                              int columns);
}  // namespace detail

/// As fail(), for an Eigen vector, which is written as a row, or matrix, written as its transpose.
template <typename Matrix>
[[noreturn]] void fail_with(std::string_view name, std::string_view problem, const Matrix& matrix) {
  std::vector<double> values;
  for (int c = 0; c < matrix.cols(); ++c)
    for (int r = 0; r < matrix.rows(); ++r) values.push_back(matrix(r, c));
  detail::fail_matrix(name, problem, values.data(), static_cast<int>(matrix.cols()),
                      static_cast<int>(matrix.rows()));
}

inline void require_finite(std::string_view name, double value) {  ///< refuses what is not, as fail()
  if (!std::isfinite(value)) fail(name, "must be finite", value);
}

inline void require_positive(std::string_view name, double value) {  ///< refuses what is not, as fail()
  if (!std::isfinite(value) || value <= 0) fail(name, "must be finite and positive", value);
}

inline void require_not_negative(std::string_view name, double value) {  ///< refuses what is, as fail()
  if (!std::isfinite(value) || value < 0) fail(name, "must be finite and not negative", value);
}

/// Refuses an Eigen vector or matrix with an entry that is not finite, as fail_with().
template <typename Matrix>
void require_all_finite(std::string_view name, const Matrix& matrix) {
  if (!matrix.allFinite()) fail_with(name, "must be finite", matrix);
}

/// By how much lengths may differ from 1 and cosines from 0; nothing is normalised behind the user's back.
inline constexpr double kUnitTolerance = 1e-9;
template <typename Vector>
void require_unit(std::string_view name, const Vector& direction) {  ///< of length 1 to kUnitTolerance
  require_all_finite(name, direction);
  if (std::abs(direction.norm() - 1) > kUnitTolerance) fail_with(name, "must have length 1", direction);
}

/// Refuses what is no unit vector perpendicular to `axis` (both to kUnitTolerance), as fail_with().
template <typename Vector>
void require_across(std::string_view name, const Vector& direction, const Vector& axis) {
  require_unit(name, direction);
  if (std::abs(direction.dot(axis)) > kUnitTolerance)
    fail_with(name, "must be perpendicular to its axis", direction);
}

}  // namespace taut
