#include "scenes/python/arrays.h"
#include "scenes/python/parts.h"
#include "scenes/python/session.h"

namespace taut::python {
namespace {

/// Columns of arrays, one row a contact.
nb::dict contact_columns(const Simulator& simulator) {
  const World& world = simulator.world();
  std::vector<int> bodies;
  std::vector<double> points, normals, forces, gaps;
  const auto add = [](std::vector<double>& rows, const Vec3& v) {
    rows.insert(rows.end(), v.begin(), v.end());
  };
  for (const ContactReport& report : simulator.contacts()) {
    const Contact& c = report.contact;
    bodies.insert(bodies.end(), {c.A.index, c.B.index});
    add(points, (world.pose(c.A).point(c.p_AP) + world.pose(c.B).point(c.p_BQ)) / 2);
    add(normals, c.normal);
    add(forces, report.force);
    gaps.push_back(c.gap);
  }
  nb::dict columns;
  columns["bodies"] = owning(std::move(bodies), 2);
  columns["points"] = owning(std::move(points), 3);
  columns["normals"] = owning(std::move(normals), 3);
  columns["forces"] = owning(std::move(forces), 3);
  columns["gaps"] = owning(std::move(gaps));
  return columns;
}

void bind_steps(nb::class_<Session>& c) {
  c.def(nb::init<World&, const Settings&>(), nb::arg("world"), nb::arg("settings") = Settings(),
        nb::keep_alive<1, 2>())
      .def("step", &Session::step, nb::arg("dt"),
           "One step of dt [s], without the GIL.  The world moves to its end if the report is ok(), "
           "or stays where it "
           "was.  What a force law raises comes through, and so does Ctrl-C as KeyboardInterrupt; world, "
           "report and what comes "
           "next are then as before the call.")
      .def("run", &Session::run, nb::arg("steps"), nb::arg("dt"),
           "Up to so many steps of dt [s] without the GIL, in one call; ends behind the first that has not "
           "advanced.  Returns "
           "the report of the last.")
      .def("run_until", &Session::run_until, nb::arg("t"), nb::arg("h"),
           "Steps of h until the time is t [s], to the last bit, without the GIL: the last step is shorter, "
           "or "
           "longer by up to a millionth of h where that saves a tiny one.  Ends with the first step that is "
           "not "
           "ok().  Returns a RunReport.")
      .def(
          "apply_force",
          [](Session& s, BodyId body, const Wrench& wrench) {
            s.change([&](Simulator& sim) { sim.apply_force(body, wrench); });
          },
          nb::arg("body"), nb::arg("wrench"),
          "World.apply_force() of its world: a wrench during the next step alone.")
      .def(
          "apply_force",
          [](Session& s, BodyId body, const Vec3& p_BP, const Vec3& force) {
            s.change([&](Simulator& sim) { sim.apply_force(body, p_BP, force); });
          },
          nb::arg("body"), nb::arg("p_BP"), nb::arg("force"),
          "The same of a force [N], world axes, at a point of the body, by how the body is turned now.")
      .def("assemble", &Session::assemble,
           "Closes all joints from the present pose by the smallest mass-weighted move; velocities are made "
           "tangent.")
      .def_prop_ro(
          "report", [](Session& s) { return s.ask([](Simulator& sim) { return StepReport(sim.report()); }); },
          "Of the last step or assemble().")
      .def_prop_ro(
          "world", [](Session& s) -> World& { return s.world(); }, nb::rv_policy::reference_internal)
      .def_prop_ro(
          "settings",
          [](Session& s) { return s.ask([](Simulator& sim) { return Settings(sim.settings()); }); },
          "As given; a copy.")
      .def_prop_ro("solver_description",
                   [](Session& s) { return s.ask([](Simulator& sim) { return sim.solver_description(); }); });
}

void bind_answers(nb::class_<Session>& c) {
  c.def(
       "mean_reaction",
       [](Session& s, JointId joint) {
         return s.ask([&](Simulator& sim) { return sim.mean_reaction(joint); });
       },
       nb::arg("joint"), "Of a joint over the last step: the impulse that it gave, divided by dt.")
      .def(
          "reaction",
          [](Session& s, JointId joint) {
            return s.ask([&](Simulator& sim) { return sim.reaction(joint); });
          },
          nb::arg("joint"),
          "At the present instant, from S λ = −(γ + J M⁻¹ f); with laws on axes, the multipliers at the end "
          "of the last step.  The first call after a step costs what that of reactions() does.")
      .def(
          "mean_reactions", [](Session& s) { return s.reactions(Session::When::kMean); }, kOwned,
          "Of all joints over the last step, n×6, row j the joint of id j: torque about the anchor on B "
          "[N·m], "
          "then force [N] on B, world axes.  Read-only, filled once a step and from then on without a copy; "
          "it goes on showing this step when the world moves on.")
      .def(
          "reactions", [](Session& s) { return s.reactions(Session::When::kPresent); }, kOwned,
          "Of all joints at the present instant, n×6, read-only and without a copy as mean_reactions().  The "
          "first call after a step assembles and factors the system at that instant, which takes as long as "
          "three or four steps of one to five rods and less than one of a large scene; further calls only "
          "show it.")
      .def(
          "axis_report",
          [](Session& s, AxisId axis) {
            return s.ask([&](Simulator& sim) { return sim.axis_report(axis); });
          },
          nb::arg("axis"), "What acted along a free axis over the last step.")
      .def(
          "contacts", [](Session& s) { return s.ask([](Simulator& sim) { return sim.contacts(); }); },
          "The contacts of the last step with their mean forces.")
      .def(
          "contact_arrays",
          [](Session& s) { return s.ask([](Simulator& sim) { return contact_columns(sim); }); },
          "The same as arrays, one row a contact: bodies n×2 (indices of A and B), points n×3 [m] half-way "
          "between P and Q, "
          "normals n×3 from A to B, forces n×3 on B [N], world axes, and gaps n [m].",
          nb::sig("def contact_arrays(self) -> dict[str, numpy.typing.NDArray]"))
      .def(
          "analyze_rank", [](Session& s) { return s.ask([](Simulator& sim) { return sim.analyze_rank(); }); },
          "Rank, freedoms and redundant rows by name in the present pose.  Nothing moves.")
      .def(
          "contradiction",
          [](Session& s, double horizon) {
            return s.ask([&](Simulator& sim) { return sim.contradiction(horizon); });
          },
          nb::arg("horizon") = 0, "What cannot hold together `horizon` [s] from now.  Nothing moves.")
      .def(
          "merged_joints",
          [](Session& s) { return s.ask([](Simulator& sim) { return sim.merged_joints(); }); },
          "The fixed joints that are not solved, because their bodies move as one.");
}

void bind_events_of(nb::class_<Session>& c) {
  c.def(
       "set_events",
       [](Session& s, std::vector<Event> events) {
         s.change([&](Simulator& sim) { sim.set_events(std::move(events)); });
       },
       nb::arg("events"),
       "What happens from now on, in place of what was given before.  step() divides its step where events "
       "happen.  What has happened, and what it has set, is in checkpoints.")
      .def_prop_ro(
          "events_happened",
          [](Session& s) {
            return s.ask([](Simulator& sim) { return std::vector<EventRecord>(sim.events_happened()); });
          },
          "All that has happened, in its order.")
      .def_prop_ro(
          "ended_by", [](Session& s) { return s.ask([](Simulator& sim) { return sim.ended_by(); }); },
          "The last event that has ended the run, by name; empty if none has.");
}

void bind_stretches(nb::module_& m, nb::class_<Session>& c) {
  nb::class_<ContactStretch>(m, "ContactStretch",
                             "The spring of a compliant contact across its normal, which no pose shows.")
      .def(
          "__init__",
          [](ContactStretch* it, ShapeId a, ShapeId b, const Vec3& p_AP, const Vec3& stretch, bool holds) {
            new (it) ContactStretch{a, b, p_AP, stretch, holds};
          },
          nb::arg("a"), nb::arg("b"), nb::arg("p_AP"), nb::arg("stretch"), nb::arg("holds") = true)
      .def_ro("a", &ContactStretch::a)
      .def_ro("b", &ContactStretch::b)
      .def_ro("p_AP", &ContactStretch::p_AP, "Where the contact is, in the frame of a's body [m].")
      .def_ro("stretch", &ContactStretch::stretch, "Of B along A, world axes [m].")
      .def_ro("holds", &ContactStretch::holds, "By static friction.");
  c.def(
       "contact_stretches",
       [](Session& s) { return s.ask([](Simulator& sim) { return sim.contact_stretches(); }); },
       "What a state needs besides World.state, so that a heap of compliant contacts which is put back goes "
       "on standing.")
      .def(
          "set_contact_stretches",
          [](Session& s, std::vector<ContactStretch> stretches) {
            s.change([&](Simulator& sim) { sim.set_contact_stretches(std::move(stretches)); });
          },
          nb::arg("stretches"),
          "The next step starts with contacts stretched so, and with all bodies awake.");
}

void bind_checkpoints(nb::module_& m, nb::class_<Session>& c) {
  nb::class_<Checkpoint>(m, "Checkpoint",
                         "All that a simulation needs to go on, to the last bit, as if it had never stopped. "
                         " It can be pickled.")
      .def_static(
          "from_bytes",
          [](const nb::bytes& bytes) {
            return Checkpoint::from_bytes(std::string(bytes.c_str(), bytes.size()));
          },
          nb::arg("bytes"))
      .def("to_bytes", [](const Checkpoint& it) { return nb::bytes(it.bytes().data(), it.bytes().size()); })
      .def("__getstate__",
           [](const Checkpoint& it) { return nb::bytes(it.bytes().data(), it.bytes().size()); })
      .def("__setstate__",
           [](Checkpoint& it, const nb::bytes& bytes) {
             new (&it) Checkpoint(Checkpoint::from_bytes(std::string(bytes.c_str(), bytes.size())));
           })
      .def(
          "__eq__", [](const Checkpoint& a, const Checkpoint& b) { return a == b; }, nb::is_operator(),
          nb::sig("def __eq__(self, arg: object, /) -> bool"))
      .def("__hash__", [](const Checkpoint& it) { return std::hash<std::string>()(it.bytes()); });
  c.def(
       "checkpoint", [](Session& s) { return s.ask([](Simulator& sim) { return sim.checkpoint(); }); },
       "A simulator of an equal world with equal settings that restores it takes the same steps as this one, "
       "to the last bit.")
      .def(
          "restore",
          [](Session& s, const Checkpoint& checkpoint) {
            s.change([&](Simulator& sim) { sim.restore(checkpoint); });
          },
          nb::arg("checkpoint"), "Sets the world to the state of a checkpoint and goes on from there.");
}

}  // namespace

void bind_simulator(nb::module_& m) {
  nb::class_<Session> simulator(
      m, "Simulator", nb::is_weak_referenceable(),
      "Advances a World in time.  It keeps its world alive; one world, one simulator, one thread at a "
      "time.");
  bind_steps(simulator);
  bind_answers(simulator);
  bind_events_of(simulator);
  bind_stretches(m, simulator);
  bind_checkpoints(m, simulator);
}

}  // namespace taut::python
