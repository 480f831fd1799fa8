#include "solvers/complementarity/stage_solver.h"

#include <cmath>
#include <limits>
#include <utility>

#include "solvers/common/move_rows.h"

// The order in which a stage is tried, and what its laws depend on.  (solvers/complementarity, "Ladder")
namespace taut {
namespace {

/// More solves of a stage, because friction let go or velocities were not yet exact.
constexpr int kMaxAxisSolves = 40;
/// With contacts, their friction is looked at every so many solves: if it has not come nearer to Coulomb's
/// law by this factor, Newton's method takes over, for as many stages.
constexpr int kFrictionPatience = 4, kPrimalStagesInARow = 60;
constexpr double kFrictionProgress = 0.2;
/// Rounds of an active set with contacts, which has a fall-back of its own.
constexpr int kContactRounds = 30;
/// Bounded rows from which on an active set that stalls is not descended from: the bodies are faster.
constexpr int kManyRows = 60;

bool has_many_bounded_rows(const ConstraintSystem& system) {
  return std::ssize(system.rows().axis_rows()) >= kManyRows;
}

/// From a warm start, with the bodies as fall-back where there are contacts or many bounded rows.
ActiveSetSettings active_set_settings(const ConstraintSystem& system, bool contacts, double rate_tolerance) {
  ActiveSetSettings settings{.rate_tolerance = rate_tolerance};
  if (contacts) settings.max_rounds = kContactRounds;
  if (contacts || has_many_bounded_rows(system)) settings.max_descent_rounds = 0;
  return settings;
}

}  // namespace

StageSolver::StageSolver(const World& world, ConstraintSystem& system, AxisForces& axes,
                         ContactForces& contacts, const Settings& settings)
    : named_(&world),
      system_(system),
      axes_(axes),
      contacts_(contacts),
      settings_(settings),
      contact_solver_(system, contacts),
      islands_(system, contacts, contact_solver_, settings.threads),
      interior_(system),
      primal_dual_(system) {
  active_.emplace(system);
  const int rows = system.row_count();
  b_.assign(rows, 0.0);
  for (auto* values : {&effective_mass_, &w_}) values->assign(bounded() ? rows : 0, 0.0);
  laws_.assign(bounded() ? rows : 0, RowLaw::equality());
}

void StageSolver::move_rows(std::span<const int> from) {
  for (auto* values : {&b_, &effective_mass_, &w_}) taut::move_rows(from, 0.0, *values);
  taut::move_rows(from, RowLaw::none(), laws_);
  std::vector<int> segments(active_->segments().begin(), active_->segments().end());
  taut::move_rows(from, -1, segments);
  active_.emplace(system_);
  contact_solver_.reset();
  islands_.forget_pattern();
  active_->set_segments(segments, laws_);
}

/// b of w = S λ + b, such that the stage's λ gives its rates.
void StageSolver::rates_without(const Stage& stage) {
  system_.multiply(stage.lambda, b_);
  for (int r = 0; r < system_.row_count(); ++r) b_[r] = stage.rates[r] - b_[r];
}

/// What laws depend on beside the rates has changed with this solution: friction lets go, its load or the
/// tangents of tables are others.
bool StageSolver::laws_move(std::span<const double> lambda, double rate_tolerance) {
  const bool broke = axes_.break_away(w_, rate_tolerance),
             bent = axes_.relinearize_tables(w_, rate_tolerance);
  const bool turned = axes_.turn_swings(lambda, w_);
  return axes_.update_loads(system_.rows(), system_.jacobian(), lambda) || broke || bent || turned;
}

bool StageSolver::solve(const Stage& stage, double rate_tolerance, StepReport& report) {
  stage_residual_ = 0;
  good_guess_ = stage.near;
  rates_without(stage);
  const bool rested = std::exchange(rested_, false) || !friction_dominated();
  const double resting = warm_start_tolerance(rate_tolerance, rested);
  laws_moved_ = false;
  if (may_rest() && (accept_warm_start(stage, resting, report) ||
                     (!laws_moved_ && solve_all_sticking(stage, resting, report))))
    return true;
  if (laws_moved_) stage.renew();
  const bool primal = system_.uses_primal_system() || contacts_.soft() ||
                      (primal_stages_left_ > 0 && primal_stages_left_-- > 0);
  const Pivoting pivoting = primal ? Pivoting::kGivenUp : solve_by_active_set(stage, rate_tolerance, report);
  return pivoting == Pivoting::kMet ||
         (pivoting == Pivoting::kGivenUp && solve_primal(stage, rate_tolerance, resting, report));
}

/// Again where static friction lets go, and until the friction of contacts agrees with their slip and normal
/// impulse.
StageSolver::Pivoting StageSolver::solve_by_active_set(const Stage& stage, double rate_tolerance,
                                                       StepReport& report) {
  ActiveSetSettings settings = active_set_settings(system_, !contacts_.empty(), rate_tolerance);
  guess_.assign(stage.lambda.begin(), stage.lambda.end());
  double earlier = std::numeric_limits<double>::infinity();  // contacts_.residual() some solves ago
  for (int solve = 0;; ++solve) {
    settings.keep_null_space = solve > 0;
    outcome_ = active_->solve(laws_, b_, stage.lambda, w_, report.times, settings);
    report.pivots += outcome_.pivots;
    if (!outcome_.ok() && contacts_.empty()) return after_stalled_pivoting(stage, settings);
    const bool moved = laws_move(stage.lambda, rate_tolerance);
    const bool slid = contacts_.adapt(stage.lambda, w_, rate_tolerance);
    const bool met = outcome_.ok() && !moved && !slid;
    if (met && !exact(stage.lambda)) {  // the tolerance of rates has let it pass
      if (settings.rate_tolerance == 0) return Pivoting::kGivenUp;
      settings.rate_tolerance = 0;
      continue;
    }
    if (met) {
      const Sticking sticking = search_sticking(stage, rate_tolerance, report);
      if (sticking == Sticking::kFound) return Pivoting::kMet;
      if (sticking == Sticking::kNoneNeeded) break;
    }
    if (contacts_.empty()) {
      if (solve < kMaxAxisSolves) {
        stage.renew();
        continue;
      }
      note_jam(stage.lambda);
      return Pivoting::kFailed;
    }
    const bool check = solve % kFrictionPatience == kFrictionPatience - 1;
    if (!outcome_.ok() || solve >= kMaxAxisSolves ||
        (check && !met && contacts_.residual() > kFrictionProgress * earlier))
      return give_up_pivoting(stage, true);
    if (check) earlier = contacts_.residual();
    if (!contacts_.turns().empty()) turn_contacts(stage, report);
    stage.renew();
  }
  report.complementarity_residual =
      std::max({report.complementarity_residual, outcome_.residual, contacts_.residual()});
  return Pivoting::kMet;
}

/// From the guess through the bodies, and the next stages at once if that is wanted.
StageSolver::Pivoting StageSolver::give_up_pivoting(const Stage& stage, bool next_too) {
  if (next_too) primal_stages_left_ = kPrimalStagesInARow;
  std::copy(guess_.begin(), guess_.end(), stage.lambda.begin());
  return Pivoting::kGivenUp;
}

/// Without contacts: a failure, unless what is asked for are the last digits, or the rows are so many that
/// the bodies are the fall-back.
StageSolver::Pivoting StageSolver::after_stalled_pivoting(const Stage& stage,
                                                          const ActiveSetSettings& settings) {
  const bool polishes = settings.rate_tolerance == 0, many = has_many_bounded_rows(system_);
  if (!polishes && (!many || outcome_.status != ActiveSetStatus::kNotConverged)) return Pivoting::kFailed;
  return give_up_pivoting(stage, many);
}

/// Contacts that stuck and slip in this solution: whether there is one in which they hold.
StageSolver::Sticking StageSolver::search_sticking(const Stage& stage, double rate_tolerance,
                                                   StepReport& report) {
  if (!contacts_.slips_where_it_held()) return Sticking::kNoneNeeded;
  StageRecord record;
  const bool holds = contact_solver_.search_sticking_solution(problem(stage.lambda), rate_tolerance, record);
  add(record, report);
  if (!holds) return contacts_.weakened() ? Sticking::kLetGo : Sticking::kNoneNeeded;
  take_segments(stage.lambda);
  return laws_move(stage.lambda, rate_tolerance) ? Sticking::kLetGo : Sticking::kFound;
}

bool StageSolver::solve_velocities(const Stage& stage, StepReport& report) {
  double tolerance = 0.1 * settings_.velocity_tolerance;
  for (int exact = 0;; ++exact) {
    if (!solve(stage, tolerance, report)) break;
    const double off = contacts_.empty() ? 0 : laws_off(stage.lambda, w_);
    if (off <= 1 || (exact == kExactSolves && take_inexact(off))) return true;
    if (exact == kExactSolves) break;
    tolerance = exact_tolerance();
    std::copy(w_.begin(), w_.end(), stage.rates.begin());
  }
  note_culprits(stage.lambda, w_);
  return false;
}

/// Turned tangents: in all that has a row, then in J and its factor.
void StageSolver::turn_contacts(const Stage& stage, StepReport& report) {
  for (const ContactLaws::Turn& turn : contacts_.turns()) {
    const int first = contacts_.first_row(turn.place);
    const int count = contacts_.row_count(turn.place);
    for (std::span<double> values :
         {stage.lambda, stage.rates, std::span<double>(b_), std::span<double>(guess_)})
      for (int r = first + 1; r < first + count; r += 3) {
        const double a = values[r], b = values[r + 1];
        values[r] = turn.cos * a + turn.sin * b;
        values[r + 1] = turn.cos * b - turn.sin * a;
      }
  }
  contacts_.turned(system_);
  const std::span<const double> J = system_.jacobian().last(stage.contact_jacobian.size());
  std::copy(J.begin(), J.end(), stage.contact_jacobian.begin());
  system_.factorize(report.times);
}

bool StageSolver::iterate(const Stage& stage, int sweeps, double rate_tolerance, std::span<Wrench> absorbed,
                          StepReport& report) {
  rates_without(stage);
  double least = 0;  // √ of the least effective mass: a tolerance for impulses
  for (int r = 0; r < system_.row_count(); ++r) {
    const double root = std::sqrt(effective_mass_[r]);
    if (effective_mass_[r] > 0) least = least > 0 ? std::min(least, root) : root;
  }
  const IterationLimits limits{settings_.solver, sweeps, settings_.relaxation, rate_tolerance * least};
  const IterationOutcome outcome =
      contact_solver_.iteration().solve(contacts_, laws_, b_, stage.lambda, w_, limits, absorbed);
  report.sweeps += outcome.sweeps;
  if (!std::isfinite(outcome.residual)) return false;
  (void)laws_move(stage.lambda, 0);
  contacts_.take_over(stage.lambda, w_, rate_tolerance);
  return true;
}

}  // namespace taut
