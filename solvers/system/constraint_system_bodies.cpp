#include <algorithm>
#include <cmath>

#include "core/base/interruption.h"
#include "solvers/common/stopwatch.h"
#include "solvers/system/constraint_system.h"

// The system through the bodies, P = 1 + Wᵀ Σ⁻¹ W in place of S, whole and in parts.
// (solvers/system, "Primal matrix")
namespace taut {
namespace {

/// Contact rows from which on the bodies may be the smaller system.
constexpr int kManyContactRows = 150;
/// Axes with Coulomb friction from which on the active set has to give way to solves through the bodies.
constexpr int kManyRubbingAxes = 150;

Rows rows_of(const Rows& whole, const SystemPart& part, std::vector<int>& new_body) {
  new_body.resize(whole.body_count());
  for (std::size_t b = 0; b < part.bodies.size(); ++b) new_body[part.bodies[b]] = static_cast<int>(b);
  return whole.part(part.joints, new_body, static_cast<int>(part.bodies.size()));
}

}  // namespace

ConstraintSystem::ConstraintSystem(const ConstraintSystem& whole, const SystemPart& part,
                                   std::vector<int>& new_body)
    : choice_(whole.choice_),
      axis_rows_(whole.axis_rows_),
      springs_(whole.springs_),
      rows_(rows_of(whole.rows_, part, new_body)),
      mass_(whole.mass_, part.bodies),
      tolerance_(whole.tolerance_) {
  analyze_bodies();
  through_bodies_ = rows_.row_count() - rows_.first_contact_row() >= kManyContactRows &&
                    flops_of_rows() >= body_ordering_->flops;
  inverse_compliance_.assign(rows_.row_count(), 0.0);
  make_room();
}

/// What the dense blocks of S alone cost in a factor: each body has one of all its rows, and each row is in
/// about two of them.
double ConstraintSystem::flops_of_rows() const {
  double flops = 0;
  for (int b = 0; b < rows_.body_count(); ++b) {
    if (mass_[b].fixed) continue;
    double rows = 0;
    for (int s : rows_.sides_of(b)) rows += rows_.sides()[s].row_count;
    flops += rows * rows * rows / 6;
  }
  return flops;
}

/// True if the bodies are the smaller system, or the one that many axes with friction ask for.
bool ConstraintSystem::bodies_pay() {
  const bool rubs = rubbing_axes_ >= kManyRubbingAxes;
  if (!rubs && rows_.row_count() - rows_.first_contact_row() < kManyContactRows) return false;
  body_ordering_ = order_blocks(body_graph(rows_, mass_, body_of_node_));
  if (!rubs && flops_of_rows() < body_ordering_->flops) return false;
  body_factor_ = make_factor(choice_, *body_ordering_);
  inverse_compliance_.assign(rows_.row_count(), 0.0);
  system_.reset();
  factor_.reset();
  dependent_rows_.clear();
  condition_ = 0;
  return true;
}

/// When it is wanted.
void ConstraintSystem::analyze_bodies() {
  if (bodies_) return;
  const Stopwatch watch(analysis_time_);
  if (!body_ordering_) body_ordering_ = order_blocks(body_graph(rows_, mass_, body_of_node_));
  body_factor_ = make_factor(choice_, *body_ordering_);
  bodies_ =
      std::make_unique<PrimalMatrix>(rows_, mass_, body_factor_->triangle(), *body_ordering_, body_of_node_);
  body_factor_->analyze(bodies_->matrix());
  ordered_bodies_.assign(bodies_->matrix().size(), 0.0);
  ++counters_.analyses;
}

void ConstraintSystem::take_values(ConstraintSystem& whole, const SystemPart& part) {
  const std::span<const double> W = whole.weighted();
  auto to = rows_.sides().begin();
  for (int j : part.joints) {
    const Rows::JointRows& joint = whole.rows_.joints()[j];
    for (const Rows::Side& from : whole.rows_.sides().subspan(joint.first_side, joint.side_count)) {
      std::copy_n(whole.jacobian_.begin() + from.offset, from.value_count(), jacobian_.begin() + to->offset);
      std::copy_n(W.begin() + from.whole, 6 * from.row_count, weighted_.begin() + to->whole);
      ++to;
    }
  }
  for (std::size_t b = 0; b < part.bodies.size(); ++b) roots_[b] = whole.roots_[part.bodies[b]];
  weighted_current_ = true;
  inertias_current_ = false;
  ++weight_version_;
}

void ConstraintSystem::take_counters(ConstraintSystem& part) {
  counters_.analyses += part.counters_.analyses;
  counters_.factorizations += part.counters_.factorizations;
  counters_.backsolves += part.counters_.backsolves;
  analysis_time_ += part.analysis_time_;
  part.counters_ = {};
  part.analysis_time_ = 0;
}

/// Σ_r + ε (S_rr + Σ_r) on all rows, or without the shift if none of them is free.
void ConstraintSystem::compliance_of_bodies() {
  effective_masses(inverse_compliance_);
  shifted_ = states_.empty() || std::find(states_.begin(), states_.end(), 0.0) != states_.end();
  for (int r = 0; r < rows_.row_count(); ++r) {
    double& d = inverse_compliance_[r];
    const double own = d > 0 ? 1 / d : 1, state = states_.empty() ? 0 : states_[r];
    d = state == kMasked ? 0 : 1 / (state + factored_shift() * (own + state));
  }
}

bool ConstraintSystem::factorize_bodies(std::span<const double> weighted, std::span<const double> D,
                                        StageTimes& times) {
  detail::poll_interrupt();
  analyze_bodies();
  {
    const Stopwatch watch(times.assembly);
    bodies_->assemble(weighted, D);
  }
  const Stopwatch watch(times.factorization);
  if (through_bodies_) factored_ = false;
  ++counters_.factorizations;
  ++body_factor_version_;
  return body_factor_->factorize(bodies_->matrix()) < 0;
}

void ConstraintSystem::solve_bodies(std::span<double> v) {
  const std::span<const int> position = bodies_->position_of_body();
  for (std::size_t b = 0; b < position.size(); ++b)
    if (position[b] >= 0) std::copy_n(v.begin() + 6 * b, 6, ordered_bodies_.begin() + position[b]);
  body_factor_->solve(ordered_bodies_);
  for (std::size_t b = 0; b < position.size(); ++b)
    if (position[b] >= 0) std::copy_n(ordered_bodies_.begin() + position[b], 6, v.begin() + 6 * b);
  ++counters_.backsolves;
}

/// v = P⁻¹ Wᵀ Σ⁻¹ x, then λ = Σ⁻¹ (x − W v).
void ConstraintSystem::solve_primal(std::span<double> x) {
  for (std::size_t r = 0; r < x.size(); ++r) x[r] *= inverse_compliance_[r];
  to_bodies(x, body_values_);
  solve_bodies(body_values_);
  to_rows(body_values_, scratch_);
  for (std::size_t r = 0; r < x.size(); ++r) x[r] -= inverse_compliance_[r] * scratch_[r];
}

void ConstraintSystem::to_bodies(std::span<const double> lambda, std::span<double> v) {
  using Six = Eigen::Matrix<double, 6, 1>;
  weight();
  for (int b = 0; b < mass_.size(); ++b) {
    Six sum = Six::Zero();
    if (!mass_[b].fixed)
      for (int s : rows_.sides_of(b)) {
        const Rows::Side& side = rows_.sides()[s];
        const double *W = weighted_.data() + side.whole, *force = lambda.data() + side.first_row;
        for (int i = 0; i < side.row_count; ++i, W += 6) sum += force[i] * Six::Map(W);
      }
    Six::Map(v.data() + 6 * b) = sum;
  }
}

void ConstraintSystem::to_rows(std::span<const double> v, std::span<double> out) const {
  for (const Rows::JointRows& joint : rows_.joints()) {
    for (int i = 0; i < joint.row_count; ++i) out[joint.first_row + i] = 0;
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const Rows::Side& side = rows_.sides()[s];
      const double* own = v.data() + 6 * side.body;
      const SixVector f(Vec3::Map(own), Vec3::Map(own + 3));
      const double* W = weighted_.data() + side.whole;
      for (int i = 0; i < side.row_count; ++i, W += 6) out[joint.first_row + i] += f.dot(W);
    }
  }
}

}  // namespace taut
