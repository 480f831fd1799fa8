#pragma once

#include <string>

#include "scenes/python/casters.h"

/// Texts that files of others may have made: names and paths need not be UTF-8.
namespace taut::python {

/// Bytes that are no UTF-8 as \xNN, since a message must come out whatever a file holds.
inline nb::object decoded(const std::string& bytes) {
  return nb::steal(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace"));
}

/// As os.fsdecode(), so that open() takes it.
inline nb::object decoded_path(const std::string& bytes) {
  return nb::steal(PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<Py_ssize_t>(bytes.size())));
}

}  // namespace taut::python
