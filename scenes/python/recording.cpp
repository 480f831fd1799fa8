#include "scenes/recording/recording.h"

#include <nanobind/stl/filesystem.h>

#include "scenes/export/exports.h"
#include "scenes/export/html_export.h"
#include "scenes/python/arrays.h"
#include "scenes/python/film.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

std::string page_of(RecordingReader& reader, RecordingReader* beside) {
  for (const RecordingReader* each : {&reader, beside})
    if (each && each->frame_count() == 0) throw std::invalid_argument("page: there are no frames to show");
  return html_page(reader, beside).text;
}

/// Writes what a recording is turned into.
void export_to(RecordingReader& reader, const std::string& html, const std::string& gltf,
               const std::string& plot, const std::string& csv, const std::string& vtk_folder) {
  const ExportFiles files{html, gltf, vtk_folder, plot, csv};
  check_exports(files);
  const ExportOutcome outcome = export_recording(reader, files);
  if (!outcome.errors.empty()) throw std::runtime_error(outcome.errors.front());
}

const auto kHtml = nb::arg("html") = "", kGltf = nb::arg("gltf") = "", kPlot = nb::arg("plot") = "",
           kCsv = nb::arg("csv") = "", kVtk = nb::arg("vtk_folder") = "";
constexpr const char* kExportDoc =
    "Writes a page, a glTF animation, curves (SVG), numbers (CSV) or series for ParaView; \"\": not.";

nb::dict frame_columns(const Frame& frame) {
  std::vector<double> reactions;
  for (const JointSample& joint : frame.joints) {
    reactions.insert(reactions.end(), joint.wrench.torque.begin(), joint.wrench.torque.end());
    reactions.insert(reactions.end(), joint.wrench.force.begin(), joint.wrench.force.end());
  }
  nb::dict columns;
  columns["time"] = frame.time;
  columns["poses"] = owning(pose_rows(frame.poses, true), 7);
  columns["twists"] = twist_array(frame.twists);
  columns["reactions"] = owning(std::move(reactions), 6);
  columns["tensions"] = owning(std::vector<double>(frame.tensions));
  columns["scalars"] = owning(std::vector<double>(frame.scalars));
  return columns;
}

/// Frames × bodies × 3.
Array all_positions(RecordingReader& reader) {
  auto values = std::make_unique<std::vector<double>>();
  const std::size_t bodies = reader.header().bodies.size();
  for (int i = 0; i < reader.frame_count(); ++i)
    for (const Pose& X : reader.frame(i).poses) values->insert(values->end(), X.p.begin(), X.p.end());
  const std::size_t shape[] = {static_cast<std::size_t>(reader.frame_count()), bodies, 3};
  double* const data = values->data();
  return Array(data, 3, shape, keep(std::move(values)));
}

/// What the header of a recording says of its joints.
void bind_recorded_joints(nb::module_& m) {
  nb::class_<RecordedAxis>(m, "RecordedAxis", "A free axis of a joint, to be drawn where the joint is.")
      .def_ro("name", &RecordedAxis::name, "In its joint, as \"angle\".")
      .def_ro("angular", &RecordedAxis::angular, "B turns about it; else it moves along it.")
      .def_ro("body", &RecordedAxis::body, "That it is fixed to.")
      .def_ro("axis_B", &RecordedAxis::axis_B, "Unit vector, in axes of this body.")
      .def("__repr__", [](const RecordedAxis& it) { return "<RecordedAxis " + it.name + ">"; });
  nb::class_<RecordedJoint>(m, "RecordedJoint", "A joint of a recording.")
      .def_ro("name", &RecordedJoint::name)
      .def_ro("type", &RecordedJoint::type, "In the words of a scene file, as \"hinge\".")
      .def_ro("a", &RecordedJoint::a, "Its body A.")
      .def_ro("b", &RecordedJoint::b, "Its body B, on which its wrench acts.")
      .def_ro("anchor_B", &RecordedJoint::anchor_B,
              "Where its wrench acts: from the centre of mass of B, body axes [m].")
      .def_prop_ro(
          "course",
          [](const RecordedJoint& it) {
            std::vector<std::pair<BodyId, Vec3>> points;
            for (const WirePoint& point : it.course) points.emplace_back(point.body, point.p_BP);
            return points;
          },
          "Of rods, ropes and wires, whose sections go from point to point: body, and place from its centre "
          "of mass in body axes [m].")
      .def_prop_ro(
          "axes", [](const RecordedJoint& it) { return it.axes; },
          "Those with a direction of their own; files of earlier versions have none.")
      .def("__repr__",
           [](const RecordedJoint& it) { return "<RecordedJoint " + it.name + ": " + it.type + ">"; });
}

void bind_film(nb::module_& m) {
  nb::class_<SessionFilm>(
      m, "Film",
      "The recording of a simulation that goes on: call sample() after each step.  In a notebook it shows "
      "itself.  With "
      "a file it can be read later by Recording and `taut replay`.  A scene gives drawings and probes.")
      .def(
          "__init__",
          [](SessionFilm* it, Session& simulator, const Scene* scene, const std::filesystem::path& file,
             double frames_per_second) {
            new (it) SessionFilm(nb::find(simulator), scene, file.string(), frames_per_second);
          },
          nb::arg("simulator"), nb::arg("scene").none() = nb::none(), nb::arg("file") = "",
          nb::arg("frames_per_second") = 60)
      .def("sample", &SessionFilm::sample, nb::arg("now") = false,
           "Takes a frame if the next instant k / frames_per_second has come, or with `now` if there is none "
           "of this instant; "
           "whether it did.")
      .def(
          "finish",
          [](SessionFilm& it, const std::string& status, const std::string& message) {
            it.film().finish(status, message);
          },
          nb::arg("status") = "success", nb::arg("message") = "", "Ends the recording.")
      .def_prop_ro("simulator", &SessionFilm::simulator)
      .def_prop_ro("frame_count", [](SessionFilm& it) { return it.film().frame_count(); })
      .def_prop_ro("file", [](SessionFilm& it) { return it.film().file(); })
      .def(
          "page",
          [](SessionFilm& it) {
            RecordingReader reader = it.film().reader();
            return page_of(reader, nullptr);
          },
          "One self-contained page (HTML) that shows what was taken so far.")
      .def(
          "export",
          [](SessionFilm& it, const std::string& html, const std::string& gltf, const std::string& plot,
             const std::string& csv, const std::string& vtk_folder) {
            RecordingReader reader = it.film().reader();
            export_to(reader, html, gltf, plot, csv, vtk_folder);
          },
          kHtml, kGltf, kPlot, kCsv, kVtk, kExportDoc);
}

}  // namespace

void bind_recording(nb::module_& m) {
  bind_film(m);
  bind_recorded_joints(m);
  nb::class_<RecordingReader>(m, "Recording",
                              "Reads a recording file, also one that was cut short or damaged.")
      .def(
          "__init__",
          [](RecordingReader* it, const std::filesystem::path& file) { new (it) RecordingReader(file); },
          nb::arg("file"))
      .def_prop_ro("scene", [](const RecordingReader& it) { return it.header().scene; })
      .def_prop_ro("body_names",
                   [](const RecordingReader& it) {
                     std::vector<std::string> names;
                     for (const RecordedBody& body : it.header().bodies) names.push_back(body.name);
                     return names;
                   })
      .def_prop_ro("joint_names",
                   [](const RecordingReader& it) {
                     std::vector<std::string> names;
                     for (const RecordedJoint& joint : it.header().joints) names.push_back(joint.name);
                     return names;
                   })
      .def_prop_ro(
          "joints", [](const RecordingReader& it) { return it.header().joints; },
          "With their bodies, anchors and axes.")
      .def_prop_ro("scalar_names",
                   [](const RecordingReader& it) {
                     std::vector<std::string> names;
                     for (const RecordedScalar& scalar : it.header().scalars) names.push_back(scalar.name);
                     return names;
                   })
      .def_prop_ro("frame_count", &RecordingReader::frame_count)
      .def("__len__", &RecordingReader::frame_count)
      .def_prop_ro(
          "times",
          [](const RecordingReader& it) {
            std::vector<double> times;
            for (int i = 0; i < it.frame_count(); ++i) times.push_back(it.time(i));
            return owning(std::move(times));
          },
          kOwned, "Of all frames [s].")
      .def(
          "frame", [](RecordingReader& it, int index) { return frame_columns(it.frame(index)); },
          nb::arg("index"),
          "time [s], poses n×7 (quaternion w, x, y, z, position x, y, z [m]), twists n×6 (angular velocity, "
          "velocity), reactions of "
          "joints n×6 (torque, force on B), tensions of springs [N], scalars.",
          nb::sig("def frame(self, index: int) -> dict[str, typing.Any]"))
      .def("positions", &all_positions, "Of all bodies in all frames: frames × n × 3 [m].")
      .def_prop_ro(
          "status",
          [](const RecordingReader& it) { return it.end() ? it.end()->status : std::string("no end"); },
          "How the run ended.")
      .def_prop_ro("damage", &RecordingReader::damage, "What is wrong with the file; \"\" if it is whole.")
      .def("page", &page_of, nb::arg("beside").none() = nb::none(),
           "One self-contained page (HTML), with another recording beside this one if that is given.")
      .def("export", &export_to, kHtml, kGltf, kPlot, kCsv, kVtk, kExportDoc);
  m.def(
      "_set_three_folder", [](const std::filesystem::path& folder) { set_three_folder(folder); },
      nb::arg("folder"));
}

}  // namespace taut::python
