#include "core/state/state.h"

#include <sstream>
#include <stdexcept>

#include "core/math/so3.h"
#include "scenes/python/arrays.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

std::string text_of(const auto& name, const auto& first_name, const auto& first, const auto& second_name,
                    const Vec3& second) {
  std::ostringstream text;
  text << name << '(' << first_name << "=[" << first[0];
  for (int i = 1; i < first.size(); ++i) text << ", " << first[i];
  text << "], " << second_name << "=[" << second[0] << ", " << second[1] << ", " << second[2] << "])";
  return text.str();
}

std::string text_of_pose(const Pose& X) {
  return text_of("Pose", "q", Eigen::Vector4d(X.q.w(), X.q.x(), X.q.y(), X.q.z()), "p", X.p);
}

void bind_pose(nb::module_& m) {
  nb::class_<Pose>(
      m, "Pose",
      "X_WB: orientation of body B in the world, a unit quaternion w, x, y, z, and position of its centre "
      "of mass [m].")
      .def(
          "__init__",
          [](Pose* X, const Quat& q, const Vec3& p) {
            new (X) Pose{q, p};
          },
          nb::arg("q") = Quat(1, 0, 0, 0), nb::arg("p") = Vec3(0, 0, 0))
      .def_rw("q", &Pose::q, "R_WB as a unit quaternion w, x, y, z.")
      .def_rw("p", &Pose::p, "p_WB [m].")
      .def("point", &Pose::point, nb::arg("p_BP"),
           "p_WP of a point fixed in the body, measured from its centre of mass.")
      .def("local", &Pose::local, nb::arg("p_WP"), "p_BP of a world point.")
      .def(
          "rotation", [](const Pose& X) -> Mat3 { return X.q.toRotationMatrix(); }, "R_WB as a 3×3 matrix.")
      .def(
          "__mul__", [](const Pose& a, const Pose& b) { return a * b; }, "Composition, X_WB = X_WA X_AB.",
          nb::is_operator())
      .def("__repr__", text_of_pose);
}

void bind_twist_and_wrench(nb::module_& m) {
  nb::class_<Twist>(
      m, "Twist", "V_WB: angular velocity w [rad/s] and velocity v of the centre of mass [m/s], world axes.")
      .def(
          "__init__",
          [](Twist* V, const Vec3& w, const Vec3& v) {
            new (V) Twist{w, v};
          },
          nb::arg("w") = Vec3(0, 0, 0), nb::arg("v") = Vec3(0, 0, 0))
      .def_rw("w", &Twist::w, "ω [rad/s].")
      .def_rw("v", &Twist::v, "Velocity of the centre of mass [m/s].")
      .def("at", &Twist::at, nb::arg("r_W"),
           "Velocity of the body point at offset r (world axes, from the centre of mass).")
      .def("__repr__", [](const Twist& V) { return text_of("Twist", "w", V.w, "v", V.v); });
  nb::class_<Wrench>(m, "Wrench",
                     "Torque about the centre of mass [N·m] and force [N], world axes; dual to Twist.")
      .def(
          "__init__",
          [](Wrench* f, const Vec3& torque, const Vec3& force) {
            new (f) Wrench{torque, force};
          },
          nb::arg("torque") = Vec3(0, 0, 0), nb::arg("force") = Vec3(0, 0, 0))
      .def_rw("torque", &Wrench::torque, "[N·m].")
      .def_rw("force", &Wrench::force, "[N].")
      .def("__repr__",
           [](const Wrench& f) { return text_of("Wrench", "torque", f.torque, "force", f.force); });
}

/// Memory of a State that Python owns; it never gets another size, so that arrays of it cannot be stale.
Array state_view(nb::handle self, std::size_t columns, std::size_t first, auto State::*member) {
  return view(std::span(nb::cast<State&>(self).*member), columns, first, self);
}

void bind_whole_state(nb::module_& m) {
  nb::class_<State>(
      m, "State",
      "Everything that changes with time, of all bodies; row 0 is the ground.  A copy of its own: its arrays "
      "can be written to, and World.set_state() takes it.")
      .def(
          "__init__", [](State* copy, const State& other) { new (copy) State(other); }, nb::arg("other"),
          "A copy.")
      .def_rw("time", &State::time, "[s].")
      .def_prop_ro(
          "positions", [](nb::handle self) { return state_view(self, 3, 4, &State::poses); }, kOwned,
          "Positions of the centres of mass, n×3 [m]; a view that can be written to.")
      .def_prop_ro(
          "poses_xyzw", [](nb::handle self) { return state_view(self, 7, 0, &State::poses); }, kOwned,
          "Poses as they are stored, n×7: quaternion x, y, z, w (scalar last, as SciPy has it), then "
          "position x, y, "
          "z [m]; a view that can be written to.")
      .def_prop_ro(
          "twists", [](nb::handle self) { return state_view(self, 6, 0, &State::twists); }, kOwned,
          "n×6: angular velocity x, y, z [rad/s], then velocity of the centre of mass x, y, z [m/s], world "
          "axes; a "
          "view that can be written to.")
      .def_prop_ro(
          "axes",
          [](nb::handle self) {
            auto& axes = nb::cast<State&>(self).axes;
            const std::size_t shape[] = {axes.size()};
            return Array(axes.data(), 1, shape, self);
          },
          kOwned,
          "One value per free axis of the joints [rad or m], at World.axis_index(); angles count turns.  A "
          "view that can be "
          "written to.")
      .def_prop_rw(
          "quaternions", [](const State& s) { return owning(pose_rows(s.poses, false), 4); },
          [](State& s, const std::vector<Quat>& rows) {
            if (rows.size() != s.poses.size())
              throw std::invalid_argument("quaternions: must be one row per body");
            for (std::size_t i = 0; i < rows.size(); ++i) s.poses[i].q = rows[i];
          },
          kOwned, "n×4, w, x, y, z: a copy; assign to it to change them.")
      .def_prop_ro(
          "poses", [](const State& s) { return owning(pose_rows(s.poses, true), 7); }, kOwned,
          "n×7: quaternion w, x, y, z, then position x, y, z [m]; a copy, since w is stored last.");
}

}  // namespace

std::vector<double> pose_rows(std::span<const Pose> poses, bool positions) {
  const std::size_t columns = positions ? 7 : 4;
  std::vector<double> rows(columns * poses.size());
  double* row = rows.data();
  for (const Pose& X : poses) {
    row[0] = X.q.w(), row[1] = X.q.x(), row[2] = X.q.y(), row[3] = X.q.z();
    if (positions) row[4] = X.p.x(), row[5] = X.p.y(), row[6] = X.p.z();
    row += columns;
  }
  return rows;
}

void bind_state(nb::module_& m) {
  bind_pose(m);
  bind_twist_and_wrench(m);
  bind_whole_state(m);
  m.def("exp_so3", &exp_so3, nb::arg("theta"),
        "Rotation by |theta| [rad] about theta, as a unit quaternion w, x, y, z.");
  m.def("log_so3", &log_so3, nb::arg("q"),
        "Rotation vector [rad], |θ| ≤ π, of a unit quaternion w, x, y, z.");
  m.def("rotation_between", &rotation_between, nb::arg("from_"), nb::arg("to"),
        "The rotation by the least angle that takes one direction to another, as a unit quaternion w, x, y, "
        "z.");
}

}  // namespace taut::python
