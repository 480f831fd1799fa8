#pragma once

#include <cmath>
#include <string_view>
#include <type_traits>

namespace taut {

namespace detail {
[[noreturn]] void fail_text(std::string_view name, std::string_view problem, std::string_view value);
[[noreturn]] void fail_number(std::string_view name, std::string_view problem, double value);
[[noreturn]] void fail_count(std::string_view name, std::string_view problem, long long value);
/// `values` row by row.
[[noreturn]] void fail_matrix(std::string_view name, std::string_view problem, const double* values, int rows,
                              int columns);
bool all_finite(const double* values, long count);
double length(const double* values, long count);
}  // namespace detail

/// Error policy: bad input throws std::invalid_argument with the name of the thing, what is wrong and the
/// offending value, a number or a text.  Numerical outcomes are never exceptions; they are a Status in a
/// StepReport.
template <typename Value>
[[noreturn]] void fail(std::string_view name, std::string_view problem, const Value& value) {
  if constexpr (std::is_floating_point_v<Value>)
    detail::fail_number(name, problem, value);
  else if constexpr (std::is_integral_v<Value>)
    detail::fail_count(name, problem, static_cast<long long>(value));
  else
    detail::fail_text(name, problem, value);
}

/// Throws std::invalid_argument with an Eigen vector, written as a row, or matrix, as its transpose.
template <typename Matrix>
[[noreturn]] void fail_with(std::string_view name, std::string_view problem, const Matrix& matrix) {
  detail::fail_matrix(name, problem, matrix.data(), static_cast<int>(matrix.cols()),
                      static_cast<int>(matrix.rows()));
}

inline void require_finite(std::string_view name, double value) {  ///< throws with name and value if not
  if (!std::isfinite(value)) fail(name, "must be finite", value);
}

inline void require_positive(std::string_view name, double value) {  ///< throws with name and value if not
  if (!std::isfinite(value) || value <= 0) fail(name, "must be finite and positive", value);
}

inline void require_not_negative(std::string_view name, double value) {  ///< throws if it is or not finite
  if (!std::isfinite(value) || value < 0) fail(name, "must be finite and not negative", value);
}

/// @throws std::invalid_argument for an Eigen vector or matrix with an entry that is not finite.
template <typename Matrix>
void require_all_finite(std::string_view name, const Matrix& matrix) {
  if (!detail::all_finite(matrix.data(), matrix.size())) fail_with(name, "must be finite", matrix);
}

/// By how much lengths may differ from 1 and cosines from 0; nothing is normalised behind the user's back.
inline constexpr double kUnitTolerance = 1e-9;
template <typename Vector>
void require_unit(std::string_view name, const Vector& direction) {  ///< of length 1 to kUnitTolerance
  require_all_finite(name, direction);
  if (std::abs(detail::length(direction.data(), direction.size()) - 1) > kUnitTolerance)
    fail_with(name, "must have length 1", direction);
}

/// @throws std::invalid_argument for what is no unit vector, or not across `axis` (both to kUnitTolerance).
template <typename Vector>
void require_across(std::string_view name, const Vector& direction, const Vector& axis) {
  require_unit(name, direction);
  if (std::abs(direction.dot(axis)) > kUnitTolerance)
    fail_with(name, "must be perpendicular to its axis", direction);
}

}  // namespace taut
