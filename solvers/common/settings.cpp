#include "solvers/common/settings.h"

#include "core/base/check.h"
#include "core/base/thread_pool.h"
#include "solvers/common/setting_checks.h"

namespace taut {

void check_settings(const Settings& s) {
  require_positive("settings position_tolerance", s.position_tolerance);
  require_positive("settings velocity_tolerance", s.velocity_tolerance);
  if (s.max_newton_iterations < 1)
    fail("settings max_newton_iterations", "must be at least 1", s.max_newton_iterations);
  if (s.max_substeps < 1) fail("settings max_substeps", "must be at least 1", s.max_substeps);
  require_positive("settings max_tension_number", s.max_tension_number);
  require_positive("settings max_rotation", s.max_rotation);
  require_not_negative("settings contact_margin", s.contact_margin);
  require_not_negative("settings resting_speed", s.resting_speed);
  require_not_negative("settings inexact_tolerance", s.inexact_tolerance);
  require_positive("settings sleep_speed", s.sleep_speed);
  require_not_negative("settings sleep_time", s.sleep_time);
  require_not_negative("settings erp", s.erp);
  require_not_negative("settings cfm", s.cfm);
  detail::check_threads("settings threads", s.threads);
  if (s.max_contacts < 0) fail("settings max_contacts", "must not be negative", s.max_contacts);
  if (s.iterations < 1) fail("settings iterations", "must be at least 1", s.iterations);
  if (!(s.relaxation > 0 && s.relaxation < 2))
    fail("settings relaxation", "must be between 0 and 2", s.relaxation);
  require_positive("settings penalty_frequency", s.penalty_frequency);
  require_not_negative("settings penalty_damping_ratio", s.penalty_damping_ratio);
  if (!(s.theta >= 0.5 && s.theta <= 1)) fail("settings theta", "must be between 0.5 and 1", s.theta);
  require_none(setting_conflicts(s));
}

}  // namespace taut
