#include "solvers/friction/friction_solver.h"

#include <array>
#include <cmath>
#include <span>

#include "core/base/check.h"
#include "core/base/clock.h"
#include "solvers/friction/friction_interior_point.h"
#include "solvers/friction/friction_newton.h"
#include "solvers/friction/friction_sweeps.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// Counts of sweeps and of rounds of sweeps with a Newton, and parts.  Chosen, where nothing else is said.
struct FrictionLadderTuning {
  /// Sweeps between looks at where they are; half takes up to twice as many.
  static constexpr int kBetweenLooks = 10;
  /// Twice: up to 4 times the sweeps of easy problems, 0.4 of the factorisations of a rock pile.
  static constexpr int kSweepsBeforeNewton = 100;
  /// Rounds of sweeps and Newton of the two rungs that take turns.  kManyRounds: half fails at a pile of
  /// rocks.
  static constexpr int kRounds = 3, kManyRounds = 60;
  /// γ of many rounds in turn: no single one ends with all problems, and where one goes in a circle the next
  /// one leaves it.
  static constexpr std::array kGammas{100.0, 10.0, 1.0};
  /// ε of into_null_cone(), as a part of the mean diagonal of a block.
  static constexpr double kProbeCompliance = 1e-10;
  /// Part of the direction that is left where all moves, to O(ε).
  static constexpr double kNothingLeft = 1e-8;
  /// To what into_null_cone() solves, of FrictionErrors.
  static constexpr double kProbeAccuracy = 1e-8;
};
using LadderTuning = FrictionLadderTuning;

/// What a rung does from `r` on, which it may leave elsewhere for those after it; it offers what it finds to
/// `best`.
struct Rung {
  FrictionRung name;
  void (*climb)(const ScaledFriction& problem, Vector& r, BestImpulses& best);
};

void newton_from_guess(const ScaledFriction& problem, Vector& r, BestImpulses& best) {
  kNewtonOnTheWay.solve(problem, r, best);
}

/// So many sweeps at most, fewer where they are right by themselves, which is looked at now and then: it
/// costs as much as one.
Vector sweep_until_right(const ScaledFriction& problem, Vector r, int times, BestImpulses& best) {
  for (int done = 0; done < times; done += LadderTuning::kBetweenLooks) {
    r = sweep(problem, r, LadderTuning::kBetweenLooks);
    best.sweeps += LadderTuning::kBetweenLooks;
    if (best.offer(r) <= best.fully()) break;
  }
  return r;
}

/// Sweeps, so many at most, find what sticks and slides, Newton finishes; where it does not, its last iterate
/// is swept.
void alternate(const ScaledFriction& problem, Vector& r, std::span<const double> gammas, int rounds,
               BestImpulses& best) {
  for (int i = 0; i < rounds && !best.met(); ++i) {
    r = sweep_until_right(problem, r, LadderTuning::kSweepsBeforeNewton, best);
    FrictionNewton newton = kNewtonOfRounds;
    newton.gamma = gammas[i % gammas.size()];
    r = newton.solve(problem, r, best);
  }
}

void sweeps_and_newton(const ScaledFriction& problem, Vector& r, BestImpulses& best) {
  alternate(problem, r, std::array{kNewtonOfRounds.gamma}, LadderTuning::kRounds, best);
}

void interior_point_and_newton(const ScaledFriction& problem, Vector&, BestImpulses& best) {
  const Vector r = interior_point(problem, best);
  kNewtonAtEnd.solve(problem, r, best);
}

void path_and_newton(const ScaledFriction& problem, Vector&, BestImpulses& best) {
  const Vector r = follow_path(problem, best);
  kNewtonAtEnd.solve(problem, r, best);
}

void many_sweeps_and_newton(const ScaledFriction& problem, Vector& r, BestImpulses& best) {
  alternate(problem, r, LadderTuning::kGammas, LadderTuning::kManyRounds, best);
}

constexpr Rung kRungs[] = {
    {FrictionRung::kGuess, newton_from_guess},
    {FrictionRung::kSweeps, sweeps_and_newton},
    {FrictionRung::kInteriorPoint, interior_point_and_newton},
    {FrictionRung::kManySweeps, many_sweeps_and_newton},
    {FrictionRung::kPath, path_and_newton},
};

/// The nearest d with W d = 0, d_N ≥ 0, d_T = 0 to `direction`, to O(ε²) of what moves: ε r → d as ε → 0 for
/// the impulses r of (W + ε) r − direction without friction, in scaled rows; twice, since the second time
/// there is only O(ε) left to take away.
Vector into_null_cone(const FrictionProblem& problem, const Vector& units, Vector direction,
                      BestImpulses& spent) {
  FrictionProblem soft = problem;
  soft.mu.setZero();
  for (int i = 0; i < problem.rows(); ++i) soft.W.coeffRef(i, i) += LadderTuning::kProbeCompliance * units[i];
  for (int pass = 0; pass < 2; ++pass) {
    soft.q = -direction;
    const ScaledFriction scaled(soft);
    BestImpulses best(scaled, LadderTuning::kProbeAccuracy);
    Vector r = best.r();
    sweeps_and_newton(scaled, r, best);
    if (!best.met()) interior_point_and_newton(scaled, r, best);
    spent.factorisations += best.factorisations;
    spent.sweeps += best.sweeps;
    const double size = direction.norm();
    direction = LadderTuning::kProbeCompliance * scaled.unscale(best.r()).cwiseProduct(units);
    if (direction.norm() <= LadderTuning::kNothingLeft * size) return Vector::Zero(problem.rows());
  }
  return direction.cwiseQuotient(units);
}

/// d of FrictionResult::certificate, if there is one: what is nearest to −q of all that moves nothing.
std::optional<Vector> contradiction(const FrictionProblem& problem, const ScaledFriction& scaled,
                                    BestImpulses& spent) {
  Vector d = into_null_cone(problem, scaled.units(), -problem.q, spent);
  const double largest = d.size() > 0 ? d.cwiseAbs().maxCoeff() : 0;
  if (!(largest > 0)) return std::nullopt;
  d /= largest;
  return scaled.excludes(d) ? std::optional(d) : std::nullopt;
}

}  // namespace

FrictionResult solve_friction(const FrictionProblem& problem, const FrictionSettings& settings,
                              const Vector* guess) {
  require_positive("accuracy", settings.accuracy);
  const Clock::time_point begin = Clock::now();
  const ScaledFriction scaled(problem);
  FrictionResult result;
  BestImpulses best(scaled, settings.accuracy);
  Vector start = Vector::Zero(scaled.rows());
  if (guess) {
    if (guess->size() != problem.rows()) fail("guess", "must have an entry for each row", guess->size());
    require_all_finite("guess", *guess);
    start = scaled.scale(*guess);
    best.offer(start);
  }
  for (const Rung& rung : kRungs) {
    if (best.met()) break;
    if (rung.name == FrictionRung::kGuess && !guess) continue;
    // Before what takes long, and would be in vain.
    if (rung.name == FrictionRung::kManySweeps && (result.certificate = contradiction(problem, scaled, best)))
      break;
    const double before = best.off();
    ++result.tried[static_cast<int>(rung.name)];
    rung.climb(scaled, start, best);
    if (best.off() < before) result.rung = rung.name;
  }
  if (best.met())
    result.status = FrictionStatus::kSolved;
  else if (result.certificate)
    result.status = FrictionStatus::kNoSolution;
  result.r = scaled.unscale(best.r());
  result.errors = best.errors();
  result.factorisations = best.factorisations;
  result.sweeps = best.sweeps;
  result.seconds = seconds_since(begin);
  return result;
}

}  // namespace taut
