#include <nanobind/operators.h>

#include <string>

#include "core/state/relocation.h"
#include "core/state/state.h"
#include "core/world/material.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

std::string text_of(const AxisId& id) {
  return "AxisId(" + std::to_string(id.joint.index) + ", " + std::to_string(id.axis) + ")";
}

template <typename Id>
void bind_id(nb::module_& m, const char* name, const char* doc) {
  nb::class_<Id>(m, name, doc)
      .def(
          "__init__", [](Id* id, int index) { new (id) Id{index}; }, nb::arg("index"))
      .def_ro("index", &Id::index, "Place among those of its kind in the world.")
      .def(
          "__index__", [](const Id& id) { return id.index; }, "So that it can index arrays.")
      .def("__hash__", [](const Id& id) { return std::hash<int>()(id.index); })
      .def("__repr__",
           [name](const Id& id) { return std::string(name) + "(" + std::to_string(id.index) + ")"; })
      .def(nb::self == nb::self, nb::sig("def __eq__(self, arg: object, /) -> bool"))
      .def(nb::self < nb::self);
}

}  // namespace

void bind_ids(nb::module_& m) {
  bind_id<BodyId>(m, "BodyId", "Index of a body in its World.  0 is the ground.");
  bind_id<JointId>(m, "JointId", "Index of a joint in its World.");
  bind_id<ForceId>(m, "ForceId", "Index of a force law in its World.");
  bind_id<ShapeId>(m, "ShapeId", "Index of a shape in its World.");
  bind_id<MaterialId>(m, "MaterialId", "Index of a material that has a name in its World.");
  m.attr("GROUND") = kGround;

  nb::class_<AxisId>(m, "AxisId",
                     "A free axis of a joint, for instance the angle of a hinge; World.axis() gives it.")
      .def(
          "__init__",
          [](AxisId* id, JointId joint, int axis) {
            new (id) AxisId{joint, axis};
          },
          nb::arg("joint"), nb::arg("axis"))
      .def_ro("joint", &AxisId::joint, "Whose axis it is.")
      .def_ro("axis", &AxisId::axis, "Its place among those of the joint.")
      .def("__hash__", [](const AxisId& id) { return std::hash<long>()(1000L * id.joint.index + id.axis); })
      .def("__repr__", text_of)
      .def(nb::self == nb::self, nb::sig("def __eq__(self, arg: object, /) -> bool"))
      .def(nb::self < nb::self);
}

}  // namespace taut::python
