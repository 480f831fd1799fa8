#include "scenes/files/scene_file.h"
#include "scenes/import/notice.h"
#include "scenes/python/parts.h"
#include "scenes/python/texts.h"

namespace taut::python {
namespace {

/// Types of exceptions, made once and kept for good.  What they have besides a text stands in the type, too,
/// so that the stub has it.
struct FileErrors {
  nb::object scene, model;
};
FileErrors& file_errors() {
  static auto* const types = new FileErrors;
  return *types;
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const SceneFileError& error) {
    nb::list problems;
    for (const SceneFileProblem& p : error.problems())
      problems.append(nb::make_tuple(decoded(p.path), decoded(p.message), decoded(p.value)));
    const nb::object instance = file_errors().scene(decoded(error.what()));
    nb::setattr(instance, "problems", problems);
    PyErr_SetObject(file_errors().scene.ptr(), instance.ptr());
  } catch (const ImportError& error) {
    nb::list problems;
    for (const ImportNotice& p : error.problems())
      problems.append(nb::make_tuple(decoded_path(p.place.file), p.place.line, decoded(p.message)));
    const nb::object instance = file_errors().model(decoded(error.what()));
    nb::setattr(instance, "problems", problems);
    nb::setattr(instance, "file", decoded_path(error.place().file));
    nb::setattr(instance, "line", nb::int_(error.place().line));
    PyErr_SetObject(file_errors().model.ptr(), instance.ptr());
  }
}

nb::object new_error(nb::module_& m, const char* name, const nb::dict& members, const char* doc) {
  const std::string full_name = nb::cast<std::string>(m.attr("__name__")) + "." + name;
  nb::object type =
      nb::steal(PyErr_NewExceptionWithDoc(full_name.c_str(), doc, PyExc_ValueError, members.ptr()));
  m.attr(name) = type;
  return type;
}

}  // namespace

void bind_file_errors(nb::module_& m) {
  nb::dict of_scene, of_model;
  of_scene["problems"] = nb::list();
  of_model["file"] = "";
  of_model["line"] = 0;
  of_model["problems"] = nb::list();
  file_errors() = {
      new_error(m, "SceneFileError", of_scene,
                "All that is wrong in a scene or state file: `problems`, tuples of path, message and value."),
      new_error(
          m, "ModelError", of_model,
          "A model file that cannot be a scene (ImportError of C++, a name that Python has for something "
          "else).  `problems`: all that is wrong, tuples of file, line and message; line 0: it is about the "
          "file as a whole.  `file` and `line` are those of the first, with which its text begins.")};
  nb::register_exception_translator(translate);
}

}  // namespace taut::python
