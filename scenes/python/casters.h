#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "core/math/so3.h"

/// Vectors, matrices and quaternions from any sequence of floats, and to NumPy arrays.
namespace taut::python {

namespace nb = nanobind;

/// `count` floats of a sequence; false, without a Python error, if it is none of that length.
bool read_floats(nb::handle source, double* values, int count) noexcept;
/// A new NumPy array of this shape with these values, row by row; null with a Python error if there is no
/// memory.
nb::handle new_array(const double* values, int rows, int columns) noexcept;  // columns 0: one dimension

}  // namespace taut::python

namespace nanobind::detail {

inline constexpr auto kVectorName = io_name("numpy.typing.ArrayLike", "numpy.typing.NDArray[numpy.float64]");

template <>
struct type_caster<taut::Vec3> {
  NB_TYPE_CASTER(taut::Vec3, kVectorName)
  bool from_python(handle source, uint32_t, cleanup_list*) noexcept {
    return taut::python::read_floats(source, value.data(), 3);
  }
  static handle from_cpp(const taut::Vec3& v, rv_policy, cleanup_list*) noexcept {
    return taut::python::new_array(v.data(), 3, 0);
  }
};

/// w, x, y, z.
template <>
struct type_caster<taut::Quat> {
  NB_TYPE_CASTER(taut::Quat, kVectorName)
  bool from_python(handle source, uint32_t, cleanup_list*) noexcept {
    double wxyz[4];
    if (!taut::python::read_floats(source, wxyz, 4)) return false;
    value = taut::Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    return true;
  }
  static handle from_cpp(const taut::Quat& q, rv_policy, cleanup_list*) noexcept {
    const double wxyz[] = {q.w(), q.x(), q.y(), q.z()};
    return taut::python::new_array(wxyz, 4, 0);
  }
};

template <>
struct type_caster<taut::Mat3> {
  NB_TYPE_CASTER(taut::Mat3, kVectorName)
  bool from_python(handle source, uint32_t, cleanup_list*) noexcept;
  static handle from_cpp(const taut::Mat3& m, rv_policy, cleanup_list*) noexcept {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = m;
    return taut::python::new_array(rows.data(), 3, 3);
  }
};

}  // namespace nanobind::detail
