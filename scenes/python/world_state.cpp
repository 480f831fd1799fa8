#include "scenes/python/world_state.h"

#include "core/world/diagnostics.h"
#include "scenes/python/access.h"
#include "scenes/python/arrays.h"

namespace taut::python {
namespace {

void bind_state_of_world(nb::class_<World>& c) {
  c.def(
       "pose",
       [](const World& world, BodyId id) {
         require_askable(world);
         return Pose(world.pose(id));
       },
       nb::arg("body"), "X_WB; a copy.")
      .def(
          "twist",
          [](const World& world, BodyId id) {
            require_askable(world);
            return Twist(world.twist(id));
          },
          nb::arg("body"), "V_WB; a copy.")
      .def("set_pose", changing(&World::set_pose), nb::arg("body"), nb::arg("pose"),
           "Moves a body, also a fixed one, between steps.")
      .def("set_twist", changing(&World::set_twist), nb::arg("body"), nb::arg("twist"))
      .def_prop_ro(
          "state",
          [](const World& world) {
            require_askable(world);
            return State(world.state());
          },
          "The whole state; a copy, whose arrays can be written to.")
      .def("set_state", changing(&World::set_state), nb::arg("state"),
           "The whole state at once, bit for bit.")
      .def_prop_rw("time", asking(&World::time), changing(&World::set_time), "[s].")
      .def_prop_rw(
          "gravity", [](const World& world) { return Vec3(world.gravity()); }, changing(&World::set_gravity),
          "Gravitational acceleration [m/s²], (0, 0, −9.81) at first.")
      .def("is_asleep", asking(&World::is_asleep), nb::arg("body"))
      .def("wake", changing(&World::wake), nb::arg("body"),
           "The body moves again, and with the next step all that fell asleep with it.")
      .def("wake_all", changing(&World::wake_all));
}

/// An answer for which force laws or motions may be called, which must not change the world meanwhile.
template <typename Answer>
auto held(Answer answer) {
  return [answer](const World& world) {
    const StepScope scope(const_cast<World&>(world));
    return answer(world);
  };
}

/// A read-only array of the present state that shows it for good.
template <typename Item>
ReadOnlyArray shown(const World& world, const std::vector<Item>& items, std::size_t columns,
                    std::size_t first) {
  require_askable(world);
  return view(std::span(items), columns, first, keep(share_state(world)));
}

void bind_arrays(nb::class_<World>& c) {
  c.def_prop_ro(
       "positions", [](const World& w) { return shown(w, w.state().poses, 3, 4); }, kOwned,
       "Positions of the centres of mass of all bodies, n×3 [m], row 0 the ground.  Read-only, without a "
       "copy; it goes "
       "on showing this instant when the world moves on.")
      .def_prop_ro(
          "twists", [](const World& w) { return shown(w, w.state().twists, 6, 0); }, kOwned,
          "n×6: angular velocity x, y, z [rad/s], then velocity of the centre of mass x, y, z [m/s], world "
          "axes.  "
          "Read-only, without a copy, of this instant.")
      .def_prop_ro(
          "poses_xyzw", [](const World& w) { return shown(w, w.state().poses, 7, 0); }, kOwned,
          "n×7 as they are stored: quaternion x, y, z, w (scalar last, as SciPy has it), then position x, y, "
          "z [m].  "
          "Read-only, without a copy, of this instant.")
      .def_prop_ro(
          "poses",
          [](const World& w) {
            require_askable(w);
            return owning(pose_rows(w.state().poses, true), 7);
          },
          kOwned, "n×7: quaternion w, x, y, z, then position x, y, z [m]; a copy, since w is stored last.")
      .def_prop_ro(
          "quaternions",
          [](const World& w) {
            require_askable(w);
            return owning(pose_rows(w.state().poses, false), 4);
          },
          kOwned, "n×4, w, x, y, z; a copy.")
      .def_prop_ro(
          "axis_values",
          [](const World& w) {
            require_askable(w);
            const auto& axes = w.state().axes;
            const std::size_t shape[] = {axes.size()};
            return ReadOnlyArray(axes.data(), 1, shape, keep(share_state(w)));
          },
          kOwned,
          "One value per free axis [rad or m] at axis_index(), as solvers keep them: those of axes with "
          "properties are up to "
          "date.  Read-only, without a copy, of this instant.");
}

void bind_energies_of_world(nb::class_<World>& c) {
  c.def("forces", held([](const World& world) {
          std::vector<double> rows(6 * world.body_count());
          world.forces(world.state(), {reinterpret_cast<Wrench*>(rows.data()),
                                       static_cast<std::size_t>(world.body_count())});
          return owning(std::move(rows), 6);
        }),
        "Sum of gravity and all force laws on each body, n×6: torque about its centre of mass [N·m], then "
        "force [N], world axes.")
      .def(
          "kinetic_energy",
          [](const World& world) {
            require_askable(world);
            return kinetic_energy(world, world.state());
          },
          "[J].")
      .def("potential_energy", held([](const World& world) { return world.potential_energy(world.state()); }),
           "Of gravity, force laws, springs, soft limits and soft joints [J].")
      .def("spring_energy", held([](const World& world) { return world.spring_energy(world.state()); }),
           "The part of it in springs [J].")
      .def(
          "linear_momentum",
          [](const World& world) {
            require_askable(world);
            return linear_momentum(world, world.state());
          },
          "Σ m v [N·s].")
      .def(
          "angular_momentum",
          [](const World& world, const Vec3& about) {
            require_askable(world);
            return angular_momentum(world, world.state(), about);
          },
          nb::arg("about") = Vec3(0, 0, 0), "Of all bodies about a world point [N·m·s].")
      .def(
          "validate",
          [](World& world, double gap_tolerance) {
            const StepScope scope(world);
            std::vector<std::pair<std::string, std::string>> problems;
            for (const Problem& p : world.validate(gap_tolerance))
              problems.emplace_back(p.subject, p.message);
            return problems;
          },
          nb::arg("gap_tolerance") = 1e-6,
          "What a simulation would trip over: pairs of a subject and a message.");
}

}  // namespace

void bind_world_state(nb::class_<World>& c) {
  bind_state_of_world(c);
  bind_arrays(c);
  bind_energies_of_world(c);
}

}  // namespace taut::python
