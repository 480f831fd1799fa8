#include "core/base/check.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace taut {

namespace {

template <typename Value>
[[noreturn]] void fail_with_value(std::string_view name, std::string_view problem, const Value& value) {
  std::ostringstream message;
  message.precision(17);
  message << name << ": " << problem << " (value: " << value << ")";
  throw std::invalid_argument(message.str());
}

}  // namespace

namespace detail {

void fail_text(std::string_view name, std::string_view problem, std::string_view value) {
  fail_with_value(name, problem, value);
}

void fail_number(std::string_view name, std::string_view problem, double value) {
  fail_with_value(name, problem, value);
}

void fail_count(std::string_view name, std::string_view problem, long long value) {
  fail_with_value(name, problem, value);
}

void fail_matrix(std::string_view name, std::string_view problem, const double* values, int rows,
                 int columns) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  fail_with_value(name, problem, Eigen::Map<const Matrix>(values, rows, columns));
}

bool all_finite(const double* values, long count) {
  return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}

double length(const double* values, long count) {
  return std::sqrt(std::inner_product(values, values + count, values, 0.0));
}

}  // namespace detail

}  // namespace taut
