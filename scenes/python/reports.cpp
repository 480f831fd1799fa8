#include <nanobind/operators.h>

#include <sstream>

#include "scenes/python/parts.h"
#include "solvers/simulator/simulator.h"

namespace taut::python {
namespace {

void bind_status(nb::module_& m) {
  nb::enum_<Status>(m, "Status", "How a step ended.")
      .value("SUCCESS", Status::kSuccess)
      .value("INEXACT", Status::kInexact,
             "The step is done and its joints are closed, but laws of contacts, friction and limits are met "
             "only to "
             "complementarity_residual.")
      .value("NOT_CONVERGED", Status::kNotConverged,
             "Positions could not be closed; the state is that before the step.")
      .value("CONTRADICTION", Status::kContradiction,
             "Some joints, limits, motors or contacts cannot hold together: StepReport.contradiction; state "
             "as before.")
      .value("NOT_FINITE", Status::kNotFinite,
             "A force or a state is not finite, or beyond 1e30; state as before the step.")
      .value("INTERRUPTED", Status::kInterrupted, "State as before the step.")
      .value("CROWDED", Status::kCrowded,
             "More contacts than Settings.max_contacts; state as before the step.");
  nb::class_<Gap>(m, "Gap", "How far a joint is open.")
      .def_ro("metres", &Gap::metres, "Largest ‖φ‖ of its translation rows.")
      .def_ro("radians", &Gap::radians, "Largest ‖φ‖ of its rotation rows.")
      .def("__repr__", [](const Gap& gap) {
        std::ostringstream text;
        text << "Gap(metres=" << gap.metres << ", radians=" << gap.radians << ")";
        return text.str();
      });
}

void bind_costs(nb::module_& m) {
  nb::class_<StageTimes>(m, "StageTimes", "Wall time of the stages of a step [s].")
      .def_ro("forces", &StageTimes::forces)
      .def_ro("positions", &StageTimes::positions)
      .def_ro("assembly", &StageTimes::assembly)
      .def_ro("factorization", &StageTimes::factorization)
      .def_ro("velocities", &StageTimes::velocities)
      .def_ro("analysis", &StageTimes::analysis)
      .def_ro("total", &StageTimes::total);
  nb::class_<SolverCounts>(m, "SolverCounts", "How often the solvers of a step did what costs time.")
      .def_ro("analyses", &SolverCounts::analyses)
      .def_ro("factorizations", &SolverCounts::factorizations)
      .def_ro("backsolves", &SolverCounts::backsolves)
      .def_ro("refactorizations", &SolverCounts::refactorizations)
      .def_ro("pivots", &SolverCounts::pivots)
      .def_ro("contact_iterations", &SolverCounts::contact_iterations)
      .def_ro("sweeps", &SolverCounts::sweeps);
}

void bind_energies(nb::module_& m) {
  nb::class_<AxisImpulse> impulse(m, "AxisImpulse",
                                  "A quantity along one axis by what gave it, positive towards larger θ.");
  impulse.def_ro("motor", &AxisImpulse::motor)
      .def_ro("friction", &AxisImpulse::friction)
      .def_ro("limit", &AxisImpulse::limit)
      .def_ro("spring", &AxisImpulse::spring)
      .def_ro("damping", &AxisImpulse::damping)
      .def_ro("elastic_limit", &AxisImpulse::elastic_limit)
      .def("total", &AxisImpulse::total);
  for_axis_types([&]<typename Property>() {
    if constexpr (PlainAxisProperty<Property>) impulse.def_ro(Property::kFacts.key, kAxisPartOf<Property>);
  });
  nb::class_<ContactWork>(m, "ContactWork", "Work of all contacts in a step [J].")
      .def_ro("normal", &ContactWork::normal)
      .def_ro("friction", &ContactWork::friction);
  nb::class_<StepWorks>(m, "StepWorks", "Works of a step [J].")
      .def_ro("constraint", &StepWorks::constraint)
      .def_ro("axes", &StepWorks::axes)
      .def_ro("contacts", &StepWorks::contacts)
      .def_ro("stiffness", &StepWorks::stiffness)
      .def_ro("drivers", &StepWorks::drivers)
      .def_ro("forces", &StepWorks::forces)
      .def_ro("dissipative", &StepWorks::dissipative)
      .def_ro("flow", &StepWorks::flow);
  nb::class_<EnergyLedger> ledger(
      m, "EnergyLedger", "Where the energy of a step went [J]; change() and total() agree to round-off.");
  ledger.def_ro("start", &EnergyLedger::start)
      .def("change", &EnergyLedger::change)
      .def("total", &EnergyLedger::total);
  for (const LedgerTerm& term : kLedgerTerms) ledger.def_ro(term.name.data(), term.amount);
}

void bind_causes(nb::module_& m) {
  nb::class_<Contradiction> contradiction(m, "Contradiction",
                                          "What cannot hold together, and the gap that is left [m or rad].");
  nb::class_<Contradiction::Bound> bound(contradiction, "Bound", "What else than its joint holds an axis.");
  nb::enum_<Contradiction::Bound::Kind>(bound, "Kind", "What holds the axis.")
      .value("LOWER_LIMIT", Contradiction::Bound::Kind::kLowerLimit)
      .value("UPPER_LIMIT", Contradiction::Bound::Kind::kUpperLimit)
      .value("MOTOR", Contradiction::Bound::Kind::kMotor);
  bound.def_ro("axis", &Contradiction::Bound::axis).def_ro("kind", &Contradiction::Bound::kind);
  contradiction.def_ro("joints", &Contradiction::joints, "By their equality rows.")
      .def_ro("bounds", &Contradiction::bounds, "Limits and motors of axes.")
      .def_prop_ro(
          "contacts",
          [](const Contradiction& it) {
            std::vector<std::pair<BodyId, BodyId>> pairs;
            for (const auto& [a, b] : it.contacts) pairs.emplace_back(a, b);
            return pairs;
          },
          "Pairs of bodies that touch.")
      .def_ro("residual", &Contradiction::residual, "[m or rad].")
      .def(
          "names", [](const Contradiction& it, const World& world) { return names_of(it, world); },
          nb::arg("world"), "Of its members, such as \"hinge elbow\".")
      .def("__bool__", [](const Contradiction& it) { return !it.empty(); });
  nb::class_<Culprit> culprit(m, "Culprit",
                              "Who has a large share in what a step could not do, or did inexactly.");
  nb::enum_<Culprit::Kind>(culprit, "Kind", "What it is, and which members name it.")
      .value("JOINT", Culprit::Kind::kJoint)
      .value("AXIS", Culprit::Kind::kAxis)
      .value("SPRING", Culprit::Kind::kSpring)
      .value("CONTACT", Culprit::Kind::kContact)
      .value("FORCE", Culprit::Kind::kForce)
      .value("BODY", Culprit::Kind::kBody);
  culprit.def_ro("kind", &Culprit::kind)
      .def_ro("axis", &Culprit::axis)
      .def_ro("force", &Culprit::force)
      .def_ro("a", &Culprit::a)
      .def_ro("b", &Culprit::b)
      .def_ro("share", &Culprit::share)
      .def(
          "name", [](const Culprit& it, const World& world) { return name_of(it, world); }, nb::arg("world"));
  nb::class_<BreakEvent>(m, "BreakEvent", "A joint that broke in a step, or left with one that did.")
      .def_ro("joint", &BreakEvent::joint)
      .def_ro("time", &BreakEvent::time, "[s].")
      .def_ro("force", &BreakEvent::force, "That it did not bear [N].")
      .def_ro("torque", &BreakEvent::torque, "[N·m].")
      .def_ro("energy", &BreakEvent::energy, "That was in its springs and is lost [J].");
  nb::class_<EventRecord>(m, "EventRecord", "An event that has happened.")
      .def_ro("event", &EventRecord::event, "Its place in the list.")
      .def_ro("name", &EventRecord::name)
      .def_ro("what", &EventRecord::what, "What it did: \"detach hook\".")
      .def_ro("time", &EventRecord::time, "[s].")
      .def_ro("value", &EventRecord::value, "Of what it watches; None for a time.")
      .def_ro("ends_run", &EventRecord::ends_run);
}

void bind_rank(nb::module_& m) {
  nb::class_<DependentRow>(m, "DependentRow", "A row of a joint that other rows hold already.")
      .def_ro("joint", &DependentRow::joint)
      .def_ro("row", &DependentRow::row, "Within the joint.");
  nb::class_<RedundantRow>(m, "RedundantRow",
                           "A row that other rows already hold, and the joints that hold it.")
      .def_ro("joint", &RedundantRow::joint)
      .def_ro("row", &RedundantRow::row, "Within the joint.")
      .def_ro("name", &RedundantRow::name, "The motion that it would hold.")
      .def_ro("held_by", &RedundantRow::held_by);
  nb::class_<RankReport>(m, "RankReport", "Freedoms and redundancy of a world in its present pose.")
      .def_ro("rows", &RankReport::rows)
      .def_ro("rank", &RankReport::rank, "Number of independent rows.")
      .def_ro("freedoms", &RankReport::freedoms, "6 × moving bodies − rank.")
      .def_ro("redundant", &RankReport::redundant)
      .def_ro("not_unique", &RankReport::not_unique, "Joints whose reactions are not unique.");
}

void bind_axis_and_contact(nb::module_& m) {
  nb::class_<Reaction>(m, "Reaction", "What a joint does to its body B, world axes; A receives the opposite.")
      .def_ro("force", &Reaction::force, "[N].")
      .def_ro("torque", &Reaction::torque, "About the joint's anchor on B [N·m].");
  nb::class_<AxisReport>(m, "AxisReport", "What acted along an axis over a step.")
      .def_ro("force", &AxisReport::force, "Mean over the step [N·m or N].")
      .def_ro("work", &AxisReport::work, "On the bodies [J].")
      .def_ro("power", &AxisReport::power, "Mean over the step [W].")
      .def_ro("stuck", &AxisReport::stuck)
      .def_ro("saturated", &AxisReport::saturated)
      .def_ro("at_limit", &AxisReport::at_limit)
      .def_ro("impact_time", &AxisReport::impact_time,
              "Of the last impact at a limit in the step [s], or None.");
  nb::class_<Contact>(m, "Contact",
                      "Point P of body A faces point Q of body B:  p_WQ − p_WP = gap · normal.  The normal "
                      "points from A to B.")
      .def_ro("a", &Contact::a, "Shape of A.")
      .def_ro("b", &Contact::b, "Shape of B.")
      .def_ro("A", &Contact::A)
      .def_ro("B", &Contact::B)
      .def_ro("p_AP", &Contact::p_AP, "In the frame of A, from its centre of mass [m].")
      .def_ro("p_BQ", &Contact::p_BQ, "In the frame of B [m].")
      .def_ro("normal", &Contact::normal, "Unit, world axes.")
      .def_ro("gap", &Contact::gap, "[m]; negative: penetration.");
  nb::class_<ContactReport>(m, "ContactReport", "What a contact gave over a step.")
      .def_ro("contact", &ContactReport::contact)
      .def_ro("force", &ContactReport::force, "Mean on B, world axes [N]; A gets the opposite.")
      .def_ro("torque", &ContactReport::torque, "On B, of rolling and spinning friction [N·m].")
      .def_ro("normal_force", &ContactReport::normal_force, "[N], ≥ 0.")
      .def_ro("sliding", &ContactReport::sliding, "At the end of the step.")
      .def_ro("impact_time", &ContactReport::impact_time, "[s] of the last impact in the step, or None.");
}

void bind_step_report(nb::module_& m) {
  nb::class_<Crowd>(
      m, "Crowd",
      "So many pairs of shapes near each other, or contacts, that what they would cost has no bound.")
      .def_ro("most", &Crowd::most, "So many are taken on; there are more.")
      .def_ro("shapes", &Crowd::shapes, "Those with most of them, at most four.");
  nb::class_<StepReport> report(m, "StepReport",
                                "The proof of quality of one step; a copy that stays as it is.");
  report
      .def("ok", &StepReport::ok,
           "The step was taken and the world has moved on, for loops: Status.SUCCESS or INEXACT.")
      .def("exact", &StepReport::exact,
           "The step was taken and all laws are met to their tolerances: Status.SUCCESS.")
      .def("energy", &StepReport::energy, "Kinetic, potential and springs' [J].")
      .def_ro("status", &StepReport::status)
      .def_ro("message", &StepReport::message, "Empty on success.")
      .def_ro("time", &StepReport::time, "At the end of the step [s].")
      .def_ro("dt", &StepReport::dt, "As given [s].")
      .def_ro("gap", &StepReport::gap,
              "Largest error at the end of joints and of axes beyond their rigid limits.")
      .def_ro("velocity_residual", &StepReport::velocity_residual, "Largest |J V| [m/s or rad/s].")
      .def_ro("natural_residual", &StepReport::natural_residual,
              "Of the laws of axes and contacts, relative.")
      .def_ro("complementarity_residual", &StepReport::complementarity_residual,
              "Of the active sets, relative.")
      .def_ro("newton_iterations", &StepReport::newton_iterations)
      .def_ro("substeps", &StepReport::substeps)
      .def_ro("counts", &StepReport::counts)
      .def_ro("tension_number", &StepReport::tension_number)
      .def_ro("times", &StepReport::times)
      .def_ro("works", &StepReport::works)
      .def_ro("culprits", &StepReport::culprits)
      .def_ro("rank_deficiency", &StepReport::rank_deficiency, "Dependent rows at the end of the step.")
      .def_ro("condition_estimate", &StepReport::condition_estimate, "Of S, a lower bound.")
      .def_ro("contacts", &StepReport::contacts, "Points at the end of the step, touching or near.")
      .def_ro("penetration", &StepReport::penetration, "Deepest of them, ≥ 0 [m].")
      .def_ro("asleep", &StepReport::asleep, "Bodies that sleep.");
  report.def_ro("kinetic_energy", &StepReport::kinetic_energy, "[J].")
      .def_ro("potential_energy", &StepReport::potential_energy, "Without that of springs [J].")
      .def_ro("spring_energy", &StepReport::spring_energy, "[J].")
      .def_ro("linear_momentum", &StepReport::linear_momentum, "[N·s].")
      .def_ro("angular_momentum", &StepReport::angular_momentum, "About the world origin [N·m·s].")
      .def_ro("ledger", &StepReport::ledger)
      .def_ro("dependent_rows", &StepReport::dependent_rows)
      .def_ro("rank", &StepReport::rank, "With Settings.report_rank, else None.")
      .def_ro("breaks", &StepReport::breaks, "Joints that broke, in the order in which they did.")
      .def_ro("events", &StepReport::events, "That happened in the step.")
      .def_ro("contradiction", &StepReport::contradiction)
      .def_ro("crowd", &StepReport::crowd, "With Status.CROWDED.")
      .def(
          "dependent_row_names",
          [](const StepReport& it, const World& world) { return names_of(it.dependent_rows, world); },
          nb::arg("world"), "Of dependent_rows, good while the world's topology is that of the step.")
      .def_ro("unsupported", &StepReport::unsupported, "Pairs of shapes that pass through each other.")
      .def_ro("unsupported_pairs", &StepReport::unsupported_pairs)
      .def_ro("missing_threads", &StepReport::missing_threads)
      .def("__repr__", [](const StepReport& it) {
        std::ostringstream text;
        text << "<StepReport: " << to_string(it.status) << " at t = " << it.time << " s";
        if (!it.message.empty()) text << ": " << it.message;
        text << '>';
        return text.str();
      });
}

void bind_run_report(nb::module_& m) {
  nb::class_<RunReport>(m, "RunReport", "What many steps came to.")
      .def("ok", &RunReport::ok, "The end was reached.")
      .def("exact", &RunReport::exact, "The end was reached by steps that all met their laws.")
      .def_ro("last", &RunReport::last, "Of the last step, or the one that failed.")
      .def_ro("steps", &RunReport::steps, "That were taken.")
      .def_ro("inexact_steps", &RunReport::inexact_steps, "With Status.INEXACT, among them.")
      .def_ro("gap", &RunReport::gap, "Largest of the steps taken.")
      .def_ro("penetration", &RunReport::penetration, "Largest of the steps taken [m].")
      .def_ro("natural_residual", &RunReport::natural_residual, "Largest of the steps taken, relative.")
      .def("__repr__", [](const RunReport& it) {
        std::ostringstream text;
        text << "<RunReport: " << it.steps << " steps, " << it.inexact_steps << " inexact, "
             << to_string(it.last.status) << " at t = " << it.last.time << " s";
        if (!it.last.message.empty()) text << ": " << it.last.message;
        text << '>';
        return text.str();
      });
}

}  // namespace

void bind_reports(nb::module_& m) {
  bind_status(m);
  bind_costs(m);
  bind_energies(m);
  bind_causes(m);
  bind_rank(m);
  bind_axis_and_contact(m);
  bind_step_report(m);
  bind_run_report(m);
}

}  // namespace taut::python
