#include "solvers/system/linearized_rows.h"

#include <algorithm>
#include <cmath>

#include "core/base/shared_loop.h"
#include "core/constraints/six_vector.h"
#include "solvers/system/delassus_matrix.h"

namespace taut {
namespace {

Rows rows_of(const Rows& whole, const SystemPart& part, std::vector<int>& new_body) {
  new_body.resize(whole.body_count());
  for (std::size_t b = 0; b < part.bodies.size(); ++b) new_body[part.bodies[b]] = static_cast<int>(b);
  return whole.part(part.joints, new_body, static_cast<int>(part.bodies.size()));
}

Rows rows_of(const World& world, Rows::AxisRows axis_rows, std::span<const Rows::ContactSlot> slots,
             Springs springs) {
  return Rows(world, axis_rows, slots, Rows::Joints::kMoving, springs, Rows::Blocks::kLeverArms);
}

}  // namespace

LinearizedRows::LinearizedRows(const World& world, Rows::AxisRows axis_rows, Springs springs,
                               detail::LazyPool* threads)
    : axis_rows_(axis_rows),
      springs_(springs),
      threads_(threads),
      rows_(rows_of(world, axis_rows, {}, springs)),
      mass_(world) {
  make_room();
}

LinearizedRows::LinearizedRows(const LinearizedRows& whole, const SystemPart& part,
                               std::vector<int>& new_body)
    : axis_rows_(whole.axis_rows_),
      springs_(whole.springs_),
      rows_(rows_of(whole.rows_, part, new_body)),
      mass_(whole.mass_, part.bodies) {
  make_room();
}

void LinearizedRows::remake_rows(const World& world, std::span<const Rows::ContactSlot> slots) {
  rows_ = rows_of(world, axis_rows_, slots, springs_);
  make_room();
}

void LinearizedRows::make_room() {
  int moving = 0;
  for (int b = 0; b < mass_.size(); ++b) moving += mass_[b].fixed ? 0 : 1;
  loop_threads_ = detail::loop_threads(threads_, moving);
  jacobian_.assign(rows_.jacobian_size(), 0.0);
  weighted_.assign(rows_.whole_size(), 0.0);
  effective_masses_.assign(rows_.row_count(), 0.0);
  roots_.resize(rows_.body_count());
  body_values_.assign(6 * static_cast<std::size_t>(rows_.body_count()), 0.0);
  ++version_;
}

void LinearizedRows::take_values(LinearizedRows& whole, const SystemPart& part) {
  const std::span<const double> W = whole.weighted();
  auto to = rows_.sides().begin();
  for (int j : part.joints) {
    const Rows::JointRows& joint = whole.rows_.joints()[j];
    for (const Rows::Side& from :
         std::span(whole.rows_.sides()).subspan(joint.first_side, joint.side_count)) {
      std::copy_n(whole.jacobian_.begin() + from.offset, from.value_count(), jacobian_.begin() + to->offset);
      std::copy_n(W.begin() + from.whole, 6 * from.row_count, weighted_.begin() + to->whole);
      ++to;
    }
  }
  for (std::size_t b = 0; b < part.bodies.size(); ++b) roots_[b] = whole.roots_[part.bodies[b]];
  weighted_version_ = ++version_;
}

void LinearizedRows::clear_bounded_rows(std::span<double> values) const {
  for (const Rows::AxisRow& axis : rows_.axis_rows()) values[axis.row] = 0;
  std::fill(values.begin() + rows_.first_contact_row(), values.end(), 0.0);
}

bool LinearizedRows::lasts() const {
  const auto& blocks = rows_.joints();
  return rows_.contact_count() == 0 &&
         std::none_of(blocks.begin(), blocks.end(), [](const auto& block) { return block.row_count == 0; });
}

void LinearizedRows::linearize(const Configuration& at) {
  rows_.jacobian(at, jacobian_);
  ++linearization_, ++version_;
}

void LinearizedRows::rates_of(const State& state, std::span<double> out) const {
  rows_.apply(jacobian_, state.twists, out);
  rows_.add_rate(state, out);
}

void LinearizedRows::set_mass(std::span<const Pose> poses) {
  full_roots_.clear();
  ++version_;
  set_mass(poses, 0, mass_.size());
}

void LinearizedRows::set_mass(std::span<const Pose> poses, int begin, int end) {
  for (int b = begin; b < end; ++b) {
    const MassMatrix::Body& body = mass_[b];
    if (body.fixed) continue;
    roots_[b] = {mass_.principal_axes(b, poses[b]) * body.root_inverse_moments.asDiagonal(),
                 std::sqrt(body.inverse_mass)};
  }
}

std::span<FullMassRoot> LinearizedRows::use_full_roots() {
  ++version_;
  full_roots_.resize(roots_.size());
  return full_roots_;
}

void LinearizedRows::mass_weight() {
  if (full_roots_.empty())
    DelassusMatrix::mass_weight<InverseMassRoot>(rows_, jacobian_, roots_, weighted_);
  else
    DelassusMatrix::mass_weight<FullMassRoot>(rows_, jacobian_, full_roots_, weighted_);
  weighted_version_ = version_;
}

void LinearizedRows::effective_masses(std::span<double> out) {
  (void)weighted();
  if (masses_version_ != version_) sum_effective_masses();
  std::copy(effective_masses_.begin(), effective_masses_.end(), out.begin());
}

void LinearizedRows::sum_effective_masses() {
  for (const Rows::Side& side : rows_.sides()) {
    const bool first = &side == &rows_.sides()[rows_.joints()[side.block].first_side];
    for (int i = 0; i < side.row_count; ++i) {
      const double part =
          mass_[side.body].fixed
              ? 0
              : Eigen::Map<const Eigen::Matrix<double, 6, 1>>(weighted_.data() + side.whole + 6 * i)
                    .squaredNorm();
      double& sum = effective_masses_[side.first_row + i];
      sum = first ? part : sum + part;
    }
  }
  for (double& s : effective_masses_) s = s > 0 ? 1 / s : 0;
  masses_version_ = version_;
}

void LinearizedRows::apply_Wt(std::span<const double> lambda, std::span<double> v) {
  using Six = Eigen::Matrix<double, 6, 1>;
  const double* const weighted = this->weighted().data();
  for (int b = 0; b < mass_.size(); ++b) {
    Six sum = Six::Zero();
    if (!mass_[b].fixed)
      for (int s : rows_.sides_of(b)) {
        const Rows::Side& side = rows_.sides()[s];
        const double *W = weighted + side.whole, *force = lambda.data() + side.first_row;
        for (int i = 0; i < side.row_count; ++i, W += 6) sum += force[i] * Six::Map(W);
      }
    Six::Map(v.data() + 6 * b) = sum;
  }
}

void LinearizedRows::apply_W(std::span<const double> v, std::span<double> out) const {
  for (const Rows::JointRows& joint : rows_.joints()) {
    for (int i = 0; i < joint.row_count; ++i) out[joint.first_row + i] = 0;
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const Rows::Side& side = rows_.sides()[s];
      const double* twist = v.data() + 6 * side.body;
      const SixVector f(Vec3::Map(twist), Vec3::Map(twist + 3));
      const double* W = weighted_.data() + side.whole;
      for (int i = 0; i < side.row_count; ++i, W += 6) out[joint.first_row + i] += f.dot(W);
    }
  }
}

void LinearizedRows::multiply(std::span<const double> x, std::span<double> out) {
  apply_Wt(x, body_values_);
  apply_W(body_values_, out);
}

void LinearizedRows::rates(std::span<const double> lambda, std::span<const double> b, std::span<double> w) {
  multiply(lambda, w);
  for (std::size_t r = 0; r < w.size(); ++r) w[r] += b[r];
}

}  // namespace taut
