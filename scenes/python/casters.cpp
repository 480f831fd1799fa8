#include "scenes/python/casters.h"

#include <algorithm>

namespace taut::python {

bool read_floats(nb::handle source, double* values, int count) noexcept {
  if (PyUnicode_Check(source.ptr()) || PyBytes_Check(source.ptr()) || !PySequence_Check(source.ptr()))
    return false;
  const Py_ssize_t size = PySequence_Size(source.ptr());
  bool good = size == count;
  for (int i = 0; good && i < count; ++i) {
    PyObject* const item = PySequence_GetItem(source.ptr(), i);
    // A string has a float too, but is no number.
    good = item && !PyUnicode_Check(item) && !PySequence_Check(item);
    if (good) values[i] = PyFloat_AsDouble(item);
    Py_XDECREF(item);
    good = good && !PyErr_Occurred();
  }
  PyErr_Clear();
  return good;
}

nb::handle new_array(const double* values, int rows, int columns) noexcept {
  try {
    const std::size_t size = static_cast<std::size_t>(rows) * std::max(columns, 1);
    auto* const copy = new double[size];
    std::copy_n(values, size, copy);
    const nb::capsule owner(copy, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    const std::size_t shape[] = {static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)};
    return nb::cast(nb::ndarray<nb::numpy, double>(copy, columns == 0 ? 1 : 2, shape, owner)).release();
  } catch (nb::python_error& error) {
    error.restore();
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_MemoryError, error.what());
  }
  return {};
}

}  // namespace taut::python

bool nanobind::detail::type_caster<taut::Mat3>::from_python(handle source, uint32_t, cleanup_list*) noexcept {
  if (PyUnicode_Check(source.ptr()) || !PySequence_Check(source.ptr()) ||
      PySequence_Size(source.ptr()) != 3) {
    PyErr_Clear();
    return false;
  }
  for (int r = 0; r < 3; ++r) {
    PyObject* const row = PySequence_GetItem(source.ptr(), r);
    double values[3];
    const bool good = row && taut::python::read_floats(row, values, 3);
    Py_XDECREF(row);
    PyErr_Clear();
    if (!good) return false;
    for (int c = 0; c < 3; ++c) value(r, c) = values[c];
  }
  return true;
}
