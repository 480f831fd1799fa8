#include "solvers/complementarity/interior_point.h"

#include <algorithm>
#include <cmath>

namespace taut {

InteriorOutcome InteriorPoint::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                     std::span<double> lambda, std::span<double> w,
                                     const InteriorLimits& limits, StageTimes& times) {
  const Problem problem{laws, b, lambda, w};
  InteriorOutcome outcome;
  begin(problem);
  for (;; ++outcome.iterations) {
    outcome.residual = relative_residual(problem);
    outcome.converged = outcome.residual <= limits.tolerance;
    if (outcome.converged || !std::isfinite(outcome.residual) || outcome.iterations >= limits.iterations)
      return outcome;
    const double kappa = mean_product(0);
    set_stiffness(problem, 0, false);
    if (!system_.factorize_bodies(system_.weighted(), stiffness_, times)) return outcome;
    direction(problem);
    const double left = kappa > 0 ? mean_product(longest(1)) / kappa : 0;
    set_stiffness(problem, left * left * left * kappa, true);
    direction(problem);
    move(problem, longest(Tuning::kInside));
  }
}

/// The elements, centred about the rates of the guess.
void InteriorPoint::begin(const Problem& problem) {
  const std::size_t n = problem.laws.size();
  for (auto* values : {&diagonal_, &base_, &stiffness_, &off_, &change_, &rates_}) values->assign(n, 0.0);
  for (auto* values : {&v_, &step_}) values->assign(6 * system_.rows().body_count(), 0.0);
  elements_.clear();
  system_.effective_masses(diagonal_);
  for (std::size_t r = 0; r < n; ++r) {
    diagonal_[r] = delassus_diagonal(diagonal_[r]);
    if (problem.laws[r].bounded()) add_elements(problem.laws[r], static_cast<int>(r));
  }
  const double scale = impulse_scale([&](std::size_t r) { return diagonal_[r]; }, problem.lambda, problem.b);
  system_.apply_Wt(problem.lambda, v_);
  system_.apply_W(v_, rates_);
  for (std::size_t r = 0; r < n; ++r) rates_[r] += problem.b[r];
  double power = 0, energy = 0;
  for (const Element& element : elements_) {
    const double rate = std::abs(rates_[element.row] - element.at), s = diagonal_[element.row];
    const double whole = element.hi - element.lo;
    const double range = std::isfinite(whole) ? whole : rate / s;  // one-sided: what would stop it
    power += range * rate;
    energy = std::max(energy, range * range * s);
  }
  const double kappa =
      std::max({Tuning::kFirstMu * power / std::max<double>(1, elements_.size()), Tuning::kLeastMu * energy,
                Tuning::kLeastMu * Tuning::kLeastMu * scale * scale});
  for (Element& element : elements_) center(element, rates_[element.row], kappa);
  update_impulses(problem);
}

/// The steps of a law; base_ is where it is with all e = 0.
void InteriorPoint::add_elements(const RowLaw& law, int row) {
  base_[row] = std::isinf(law.level[0]) ? law.level[1] : law.level[0];
  for (int k = 1; k <= law.steps; ++k) {
    const bool first = std::isinf(law.level[k - 1]);
    elements_.push_back({.row = row,
                         .at = law.at[k - 1],
                         .lo = first ? 0 : law.level[k] - law.level[k - 1],
                         .hi = first ? RowLaw::kInfinity : 0});
  }
}

/// p, q, z and z' on the central path at w; of one-sided steps that w is beyond, at a point of that κ.
void InteriorPoint::center(Element& element, double w, double kappa) const {
  const double rate = w - element.at, range = element.hi - element.lo;
  const double least = std::sqrt(kappa * diagonal_[element.row]);
  element.p = element.q = RowLaw::kInfinity;
  if (std::isfinite(range)) {
    const double turn = std::hypot(rate * range, 2 * kappa), forward = std::abs(rate) * range;
    const double near = 2 * kappa * range / (forward + 2 * kappa + turn);
    element.p = rate > 0 ? near : range - near;
    element.q = rate > 0 ? range - near : near;
  } else if (std::isinf(element.hi)) {
    element.p = kappa / std::max(rate, least);
  } else {
    element.q = kappa / std::max(-rate, least);
  }
  element.z = kappa / element.p;
  element.z2 = kappa / element.q;
}

/// λ of bounded rows from their elements.
void InteriorPoint::update_impulses(const Problem& problem) {
  for (std::size_t r = 0; r < problem.laws.size(); ++r)
    if (problem.laws[r].bounded()) problem.lambda[r] = base_[r] - problem.laws[r].slope * rates_[r];
  for (const Element& element : elements_)
    problem.lambda[element.row] += element.p < element.q ? element.lo + element.p : element.hi - element.q;
}

/// δλ = −D (δw + …) of each row, for products that are to become κ; with the second order of the last
/// direction.
void InteriorPoint::set_stiffness(const Problem& problem, double kappa, bool correct) {
  for (std::size_t r = 0; r < problem.laws.size(); ++r) {
    const RowLaw& law = problem.laws[r];
    stiffness_[r] = law.bounded() ? law.slope : 1 / (Tuning::kEqualityRho * diagonal_[r]);
    off_[r] = law.bounded() ? 0 : stiffness_[r] * (rates_[r] - law.rate(1));
  }
  for (Element& element : elements_) {
    const double p = element.p, q = element.q;
    element.target_z = kappa - (correct ? element.de * element.dz : 0);
    element.target_z2 = kappa + (correct ? element.de * element.dz2 : 0);
    element.stiffness = 1 / (element.z / p + element.z2 / q);
    element.off = rates_[element.row] - element.at - element.target_z / p + element.target_z2 / q;
    stiffness_[element.row] += element.stiffness;
    off_[element.row] += element.stiffness * element.off;
  }
}

/// P δv = Wᵀ (λ − D off) − v, and what follows for the elements.
void InteriorPoint::direction(const Problem& problem) {
  for (std::size_t r = 0; r < change_.size(); ++r) change_[r] = problem.lambda[r] - off_[r];
  system_.apply_Wt(change_, step_);
  for (std::size_t i = 0; i < v_.size(); ++i) step_[i] -= v_[i];
  system_.solve_bodies(step_);
  system_.apply_W(step_, change_);
  for (Element& element : elements_) {
    const double p = element.p, q = element.q;
    element.de = -element.stiffness * (change_[element.row] + element.off);
    element.dz = std::isinf(p) ? 0 : (element.target_z - element.z * (p + element.de)) / p;
    element.dz2 = std::isinf(q) ? 0 : (element.target_z2 - element.z2 * (q - element.de)) / q;
  }
}

/// The longest step up to 1 that stays inside, and goes only this part of the way to the boundary.
double InteriorPoint::longest(double part) const {
  double length = 1 / part;
  for (const Element& element : elements_) {
    const auto stop = [&](double value, double change) {
      if (change < 0 && length * change < -value) length = -value / change;
    };
    stop(element.p, element.de);
    stop(element.q, -element.de);
    stop(element.z, element.dz);
    stop(element.z2, element.dz2);
  }
  return std::min(1.0, part * length);
}

/// Mean of the products after a step of this length.
double InteriorPoint::mean_product(double length) const {
  double sum = 0;
  int count = 0;
  for (const Element& element : elements_) {
    const double change = length * element.de;
    if (std::isfinite(element.lo)) sum += (element.p + change) * (element.z + length * element.dz), ++count;
    if (std::isfinite(element.hi)) sum += (element.q - change) * (element.z2 + length * element.dz2), ++count;
  }
  return count > 0 ? sum / count : 0;
}

void InteriorPoint::move(const Problem& problem, double length) {
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += length * step_[i];
  for (std::size_t r = 0; r < change_.size(); ++r)
    if (!problem.laws[r].bounded()) problem.lambda[r] -= length * (stiffness_[r] * change_[r] + off_[r]);
  for (Element& element : elements_) {
    element.p += length * element.de;
    element.q -= length * element.de;
    element.z += length * element.dz;
    element.z2 += length * element.dz2;
    element.de = element.dz = element.dz2 = 0;
  }
  system_.apply_W(v_, rates_);
  for (std::size_t r = 0; r < change_.size(); ++r) rates_[r] += problem.b[r];
  update_impulses(problem);
}

/// w of the impulses themselves, which v is only on the way to, and the natural residual over the size of
/// impulses.
double InteriorPoint::relative_residual(const Problem& problem) {
  system_.rates(problem.lambda, problem.b, problem.w);
  const auto s = [&](std::size_t r) { return diagonal_[r]; };
  LargestResidual largest;
  largest.add_rows(problem.laws, s, problem.lambda, problem.w, 0);
  if (!largest.finite()) return largest.strict_size();
  const double scale = impulse_scale(s, problem.lambda, problem.b);
  return scale > 0 ? largest.over(scale) : 0;
}

}  // namespace taut
