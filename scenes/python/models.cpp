#include <nanobind/stl/filesystem.h>

#include "scenes/export/mjcf_export.h"
#include "scenes/export/urdf_export.h"
#include "scenes/import/import.h"
#include "scenes/python/access.h"
#include "scenes/python/parts.h"
#include "scenes/python/texts.h"
#include "scenes/support/format.h"

namespace taut::python {
namespace {

void bind_notice(nb::module_& m) {
  nb::class_<ImportNotice>(
      m, "ImportNotice",
      "Something of a model file that the scene does not have, or has otherwise.  As a text: \"arm.urdf:12: "
      "<gazebo>: has no counterpart (and 3 more)\".")
      .def_prop_ro(
          "file", [](const ImportNotice& it) { return decoded_path(it.place.file); },
          nb::sig("def file(self) -> str"), "Where the first of them is, as it was opened.")
      .def_prop_ro(
          "line", [](const ImportNotice& it) { return it.place.line; },
          "From 1; of the start of the element.")
      .def_prop_ro(
          "message", [](const ImportNotice& it) { return decoded(it.message); },
          nb::sig("def message(self) -> str"), "What it is, and what became of it.")
      .def_ro("count", &ImportNotice::count, "How many there are.")
      .def(
          "__str__", [](const ImportNotice& it) { return decoded(it.text()); },
          nb::sig("def __str__(self) -> str"))
      .def(
          "__repr__", [](const ImportNotice& it) { return decoded("<ImportNotice " + it.text() + ">"); },
          nb::sig("def __repr__(self) -> str"));
}

/// What the program says of a model that runs, as a warning of Python.
void warn_of(const std::vector<ImportNotice>& notices, const std::string& file) {
  if (notices.empty()) return;
  const std::string text = notices_in_short(notices.size(), file) + "load_model() lists them";
  if (PyErr_WarnEx(PyExc_UserWarning, nb::cast<std::string>(decoded(text)).c_str(), 1) != 0)
    throw nb::python_error();
}

void bind_import(nb::module_& m) {
  m.def("is_model_file", &is_model_file, nb::arg("name"),
        "True for what ends in .urdf, .sdf, .world, .mjcf or .xml.");
  m.def(
      "load_model",
      [](const std::filesystem::path& path) {
        std::vector<ImportNotice> notices;
        Scene scene = load_model_file(path, &notices);
        return std::pair(std::move(scene), std::move(notices));
      },
      nb::arg("path"),
      "The scene of a model of a robot, URDF, SDF or MJCF, and what it lacks of it: scene, notices = "
      "load_model(\"arm.urdf\").  Bodies, joints and axes have the names of links, joints and their "
      "degrees of freedom.  Actuators of joints are motors, with the controls of the first key that starts "
      "where the model does, else 0; others have a notice each with their name.  "
      "Raises ModelError with file and line if the file cannot be read or understood, or what it describes "
      "cannot be a scene, as a body that moves and has no mass.");
  m.def(
      "model_scene_text",
      [](const std::filesystem::path& path) {
        std::vector<ImportNotice> notices;
        std::string text = model_scene_text(path, &notices);
        return std::pair(std::move(text), std::move(notices));
      },
      nb::arg("path"),
      "The text of a scene file (JSON) that says what a model file says, as `taut import` writes it, and "
      "what it lacks; raises likewise.");
  m.def(
      "open_scene",
      [](const std::filesystem::path& name, const nb::kwargs& parameters) {
        std::vector<ImportNotice> notices;
        Scene scene =
            open_scene_or_model(name.string(), nb::cast<std::map<std::string, double>>(parameters), &notices);
        warn_of(notices, name.string());
        return scene;
      },
      nb::arg("name_or_file"), nb::arg("parameters"),
      "A scene by what `taut run` takes: the name of one of the catalogue with its parameters, a scene file, "
      "or a model of a robot; that a model lacks something is a warning.",
      nb::sig("def open_scene(name_or_file: str | os.PathLike, **parameters: float) -> Scene"));
}

using Writer = std::string (*)(const Scene&, std::vector<std::string>&);
void bind_writer(nb::module_& m, const char* name, Writer write, const char* doc) {
  m.def(
      name,
      [write](const Scene& scene) {
        require_askable(scene.world);
        std::vector<std::string> notices;
        std::string text = write(scene, notices);
        return std::pair(std::move(text), std::move(notices));
      },
      nb::arg("scene"), doc);
}

}  // namespace

void bind_models(nb::module_& m) {
  bind_notice(m);
  bind_import(m);
  bind_writer(
      m, "mjcf_of", &mjcf_of,
      "A scene as a model for MuJoCo, and what MJCF cannot say, one sentence each: text, notices = "
      "mjcf_of(scene).  Trees of bodies, with equalities and tendons for what closes loops.  MuJoCo's "
      "contacts, limits and equalities are compliant; taut's are not.");
  bind_writer(m, "urdf_of", &urdf_of,
              "A scene as a robot, and what URDF cannot say: text, notices = urdf_of(scene).  One tree of "
              "links, the ground is its link \"world\".  URDF knows hinges, slides and links that are fixed "
              "or free.  Values of joints are 0 at the start.");
}

}  // namespace taut::python
