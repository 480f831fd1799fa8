#include "solvers/friction/friction_solver.h"

#include <cmath>
#include <initializer_list>

#include "core/base/check.h"
#include "core/base/clock.h"
#include "solvers/friction/friction_interior_point.h"
#include "solvers/friction/friction_newton.h"
#include "solvers/friction/friction_sweeps.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// What a rung does with a start; it offers what it finds to `best`.
struct Rung {
  FrictionRung name;
  void (*climb)(const ScaledFriction& problem, const Vector& start, BestImpulses& best);
};

void newton_from_guess(const ScaledFriction& problem, const Vector& start, BestImpulses& best) {
  FrictionNewton{.steps = 8, .patience = 4}.solve(problem, start, best);
}

/// Sweeps find what sticks and slides, Newton finishes; where it does not, its last iterate is swept.
void alternate(const ScaledFriction& problem, Vector r, std::initializer_list<double> gammas, int times,
               BestImpulses& best) {
  constexpr int kSweeps = 100;
  for (int i = 0; i < times && !best.met(); ++i) {
    best.sweeps += kSweeps;
    r = sweep(problem, r, kSweeps);
    const double gamma = gammas.begin()[i % gammas.size()];
    r = FrictionNewton{.gamma = gamma, .rho = 1e-4, .steps = 6, .memory = 10, .patience = 5}.solve(problem, r,
                                                                                                   best);
  }
}

void sweeps_and_newton(const ScaledFriction& problem, const Vector& start, BestImpulses& best) {
  alternate(problem, start, {30}, 3, best);
}

void interior_point_and_newton(const ScaledFriction& problem, const Vector&, BestImpulses& best) {
  const Vector r = interior_point(problem, best);
  FrictionNewton{.gamma = 30, .memory = 10}.solve(problem, r, best);
}

void path_and_newton(const ScaledFriction& problem, const Vector&, BestImpulses& best) {
  const Vector r = follow_path(problem, best);
  FrictionNewton{.gamma = 30, .memory = 10}.solve(problem, r, best);
}

/// γ in turn: no single one ends with all problems, and where one goes in a circle the next one leaves it.
void many_sweeps_and_newton(const ScaledFriction& problem, const Vector& start, BestImpulses& best) {
  alternate(problem, start, {100, 10, 1}, 60, best);
}

constexpr Rung kRungs[] = {
    {FrictionRung::kGuess, newton_from_guess},
    {FrictionRung::kSweeps, sweeps_and_newton},
    {FrictionRung::kInteriorPoint, interior_point_and_newton},
    {FrictionRung::kManySweeps, many_sweeps_and_newton},
    {FrictionRung::kPath, path_and_newton},
};

/// d of FrictionResult::certificate, if there is one: where normals close whatever the impulses, those of
/// W + ε 1 without friction grow as 1/ε along it.
std::optional<Vector> contradiction(const FrictionProblem& problem) {
  constexpr double kCompliance = 1e-10;
  FrictionProblem smooth = problem;
  smooth.mu.setZero();
  const double size = problem.W.diagonal().maxCoeff();
  FrictionProblem::Matrix softness(problem.rows(), problem.rows());
  softness.setIdentity();
  smooth.W += kCompliance * size * softness;
  const ScaledFriction scaled(smooth);
  BestImpulses best(scaled, 1e-8);
  for (const Rung& rung : kRungs)
    if (!best.met()) rung.climb(scaled, best.r(), best);
  const Vector r = scaled.given(best.r());
  const double largest = r.size() > 0 ? r.cwiseAbs().maxCoeff() : 0;
  if (!(largest > 0)) return std::nullopt;
  const Vector d = r / largest;
  return ScaledFriction(problem).excludes(d) ? std::optional(d) : std::nullopt;
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
    start = scaled.own(*guess);
    best.offer(start);
  }
  for (const Rung& rung : kRungs) {
    if (best.met()) break;
    if (rung.name == FrictionRung::kGuess && !guess) continue;
    const double before = best.off();
    ++result.tried[static_cast<int>(rung.name)];
    rung.climb(scaled, start, best);
    if (best.off() < before) result.rung = rung.name;
  }
  if (best.met())
    result.status = FrictionStatus::kSolved;
  else if ((result.certificate = contradiction(problem)))
    result.status = FrictionStatus::kNoSolution;
  result.r = scaled.given(best.r());
  result.errors = best.errors();
  result.factorisations = best.factorisations;
  result.sweeps = best.sweeps;
  result.seconds = seconds_since(begin);
  return result;
}

}  // namespace taut
