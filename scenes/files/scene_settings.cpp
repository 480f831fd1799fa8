#include "core/base/thread_pool.h"
#include "scenes/files/scene_reader.h"
#include "solvers/common/setting_names.h"

namespace taut {

/// Every member of Settings under its own name; what is not given keeps its default.
Settings read_settings(const JsonNode& node, const Settings& defaults) {
  Settings s = defaults;
  JsonObject object(node);
  const auto number = [&](JsonKey key, double (JsonNode::*read)() const, double& value) {
    value = object.get(key, read, value);
  };
  const auto integer = [&](const char* key, int& value) {
    value = object.get(key, &JsonNode::positive_integer, value);
  };
  const auto choice = [&](const char* key, const auto& table, auto& value) {
    if (const auto member = object.find(key)) value = member->choice(table);
  };
  choice("integrator", kIntegratorNames, s.integrator);
  number("position_tolerance", &JsonNode::positive, s.position_tolerance);
  number("velocity_tolerance", &JsonNode::positive, s.velocity_tolerance);
  integer("max_newton_iterations", s.max_newton_iterations);
  integer("max_substeps", s.max_substeps);
  choice("tension", kTensionNames, s.tension);
  number("max_tension_number", &JsonNode::positive, s.max_tension_number);
  number(in_angles("max_rotation"), &JsonNode::positive, s.max_rotation);
  choice("drift_cure", kDriftCureNames, s.drift_cure);
  number("erp", &JsonNode::not_negative, s.erp);
  number("cfm", &JsonNode::not_negative, s.cfm);
  number("penalty_frequency", &JsonNode::positive, s.penalty_frequency);
  number("penalty_damping_ratio", &JsonNode::not_negative, s.penalty_damping_ratio);
  number("theta", &JsonNode::half_to_one, s.theta);
  choice("factor", kFactorNames, s.factor);
  choice("solver", kSolverNames, s.solver);
  integer("iterations", s.iterations);
  number("relaxation", &JsonNode::below_two, s.relaxation);
  if (const auto threads = object.find("threads"))
    threads->guard([&] { detail::check_threads("threads", s.threads = threads->positive_integer()); });
  s.contacts = object.get("contacts", &JsonNode::boolean, s.contacts);
  number("contact_margin", &JsonNode::not_negative, s.contact_margin);
  integer("max_contacts", s.max_contacts);
  number("resting_speed", &JsonNode::not_negative, s.resting_speed);
  s.locate_plastic_impacts =
      object.get("locate_plastic_impacts", &JsonNode::boolean, s.locate_plastic_impacts);
  number("inexact_tolerance", &JsonNode::not_negative, s.inexact_tolerance);
  s.sleep = object.get("sleep", &JsonNode::boolean, s.sleep);
  number("sleep_speed", &JsonNode::positive, s.sleep_speed);
  number("sleep_time", &JsonNode::not_negative, s.sleep_time);
  s.merge_fixed_joints = object.get("merge_fixed_joints", &JsonNode::boolean, s.merge_fixed_joints);
  s.report_energy = object.get("report_energy", &JsonNode::boolean, s.report_energy);
  s.report_rank = object.get("report_rank", &JsonNode::boolean, s.report_rank);
  object.reject_unknown_keys();
  return s;
}

}  // namespace taut
