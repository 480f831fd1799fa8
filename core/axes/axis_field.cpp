#include "core/axes/axis_field.h"

#include <cmath>

#include "core/base/check.h"

namespace taut::detail {
namespace {

const char* demand(AxisRange range) {
  switch (range) {
    case AxisRange::kFinite:
      return "must be finite";
    case AxisRange::kNotNegative:
      return "must be finite and not negative";
    case AxisRange::kFromZeroToOne:
      return "must be from 0 to 1";
    case AxisRange::kBound:
      return "must not be negative";
    case AxisRange::kSpeed:
      return "must be positive";
    case AxisRange::kLowest:
      return "must be a number or −infinity";
    case AxisRange::kHighest:
      break;
  }
  return "must be a number or infinity";
}

}  // namespace

bool is_in(AxisRange range, double value) {
  switch (range) {
    case AxisRange::kFinite:
      return std::isfinite(value);
    case AxisRange::kNotNegative:
      return std::isfinite(value) && value >= 0;
    case AxisRange::kFromZeroToOne:
      return value >= 0 && value <= 1;
    case AxisRange::kBound:
      return value >= 0;
    case AxisRange::kSpeed:
      return value > 0;
    case AxisRange::kLowest:
      return value < INFINITY;
    case AxisRange::kHighest:
      break;
  }
  return value > -INFINITY;
}

std::string of_axis(const char* what, std::string_view axis) { return what + (" of " + std::string(axis)); }

void fail_axis_number(std::string_view axis, const char* property, const char* key,
                      const AxisFieldNotes& notes, AxisRange range, double value) {
  const std::string label = notes.label ? notes.label : std::string(property) + " " + key;
  fail(of_axis(label.c_str(), axis), demand(range), value);
}

}  // namespace taut::detail
