#pragma once

#include <memory>
#include <utility>

#include "core/state/motion.h"
#include "scenes/python/casters.h"

/// What the library calls in Python, from whatever thread.
namespace taut::python {

/// A Python object that C++ may copy and drop without the GIL.
class HeldObject {
 public:
  explicit HeldObject(nb::object object)
      : object_(new nb::object(std::move(object)), [](nb::object* held) {
          if (!Py_IsInitialized()) return;  // what is left at the end of the process
          const nb::gil_scoped_acquire gil;
          delete held;
        }) {}
  const nb::object& get() const { return *object_; }

 private:
  std::shared_ptr<nb::object> object_;
};

/// A motion as Python sees it.
struct BoundMotion {
  Motion function;
};
/// A motion of a pose likewise.
struct BoundPoseMotion {
  PoseMotion function;
};

}  // namespace taut::python
