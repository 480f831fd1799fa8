#include "core/constraints/rows.h"

#include <algorithm>

#include "core/base/counting_sort.h"
#include "core/constraints/row_products.h"

namespace taut {
namespace {

/// Items 0 … n − 1 by their bodies, in order; −1: of none.
void sort_by(const std::vector<int>& body_of, int bodies, std::vector<int>& start, std::vector<int>& items) {
  counting_sort(
      body_of.size(), bodies, [&](std::size_t i) { return body_of[i]; },
      [](std::size_t i) { return static_cast<int>(i); }, start, items);
}

}  // namespace

/// Called for each part that may leave a block unwritten; a joint counts once.
void Rows::clear_blocks(int joint) {
  const JointRows& rows = joints_[joint];
  const std::pair<int, int> blocks(sides_[rows.first_side].offset, 6 * rows.row_count * rows.side_count);
  if (cleared_.empty() || cleared_.back() != blocks) cleared_.push_back(blocks);
}

void Rows::note_axes(const detail::PartStoreBase* store) {
  if (std::find(stores_with_axes_.begin(), stores_with_axes_.end(), store) == stores_with_axes_.end())
    stores_with_axes_.push_back(store);
}

std::optional<JointId> Rows::AxisRow::joint() const {
  if (const AxisId* of_axis = axis()) return of_axis->joint;
  const auto* softened = std::get_if<SoftenedRow>(&what);
  return softened ? std::optional(softened->joint) : std::nullopt;
}

void Rows::append_side(int body, int joint, int row_count, int arm) {
  sides_.push_back({body, joint, this->row_count(), row_count, jacobian_size_, whole_size_, arm});
  jacobian_size_ += sides_.back().value_count();
  whole_size_ += 6 * row_count;
}

void Rows::append_contact(const ContactSlot& slot) {
  const int j = static_cast<int>(joints_.size()), count = slot.row_count();
  joints_.push_back({row_count(), count, static_cast<int>(sides_.size()), 2, 0,
                     ContactIndex{static_cast<int>(contacts_.size())}});
  for (int body : {slot.a, slot.b}) append_side(body, j, count);
  using namespace row_parts;
  append(ContactPoint{}, j, 0, {}, RowKind::kContact);
  contact_points_ = static_cast<detail::PartStore<ContactPoint>*>(store_of_type_.at(typeid(ContactPoint)));
  contacts_.push_back({rows_.back().item, -1});
  if (!slot.twist) return;
  append(ContactTwist{}, j, 3, {}, RowKind::kContact);
  contact_twists_ = static_cast<detail::PartStore<ContactTwist>*>(store_of_type_.at(typeid(ContactTwist)));
  contacts_.back().twist = rows_.back().item;
}

void Rows::set_contact(int k, const row_parts::ContactPoint& point) {
  contact_points_->items[contacts_[k].point].part = point;
  if (contacts_[k].twist >= 0) contact_twists_->items[contacts_[k].twist].part.frame = point.frame;
}

Rows Rows::part(std::span<const int> joints, std::span<const int> new_body, int bodies) const {
  Rows part;
  const int first_contact = static_cast<int>(joints_.size()) - contact_count();
  for (int j : joints) {
    if (j >= first_contact) {
      if (part.contacts_.empty()) part.first_contact_row_ = part.row_count();
      part.contacts_.emplace_back();
    }
    const JointRows& joint = joints_[j];
    const int index = static_cast<int>(part.joints_.size());
    part.joints_.push_back({part.row_count(), joint.row_count, static_cast<int>(part.sides_.size()),
                            joint.side_count, joint.equality_count, joint.owner});
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      part.append_side(new_body[sides_[s].body], index, joint.row_count, sides_[s].arm);
    for (int r = joint.first_row; r < joint.first_row + joint.row_count; ++r) {
      part.rows_.push_back({index, rows_[r].angular, nullptr, 0, 0, rows_[r].kind});
      part.unit_.push_back(unit_[r]);
    }
  }
  if (part.contacts_.empty()) part.first_contact_row_ = part.row_count();
  part.sort_by_body(bodies);
  return part;
}

/// Sides of each body, and joints that are due at it.
void Rows::sort_by_body(int bodies) {
  std::vector<int> body_of;
  for (const Side& side : sides_) body_of.push_back(side.body);
  sort_by(body_of, bodies, body_start_, body_sides_);
  body_of.assign(joints_.size(), -1);
  for (const Side& side : sides_) body_of[side.block] = std::max(body_of[side.block], side.body);
  sort_by(body_of, bodies, due_start_, due_joints_);
}

/// Items keep their order, so one that waits for a later body keeps those behind it waiting.
void Rows::cut_into_chunks() {
  std::vector<int> last(joints_.size(), 0);  // body of each joint
  for (const Side& side : sides_) last[side.block] = std::max(last[side.block], side.body);
  const int count = (body_count() + kChunkSize - 1) / kChunkSize;
  const auto stores = static_cast<std::ptrdiff_t>(stores_.size());
  std::unordered_map<const detail::PartStoreBase*, std::ptrdiff_t> index;
  for (std::ptrdiff_t s = 0; s < stores; ++s) index[stores_[s].get()] = s;
  chunk_items_.assign((count + 1) * stores, 0);
  std::vector<int> reached(stores_.size(), 0);  // chunk
  std::vector<int> settled(body_count(), 0);    // chunk that has a body's last part
  for (int b = 0; b < body_count(); ++b) settled[b] = b / kChunkSize;
  for (const Row& row : rows_) {
    if (row.row_in_part != 0) continue;
    const std::ptrdiff_t s = index[row.store];
    reached[s] = std::max(reached[s], last[row.block] / kChunkSize);
    ++chunk_items_[(reached[s] + 1) * stores + s];
    const JointRows& joint = joints_[row.block];
    for (int side = joint.first_side; side < joint.first_side + joint.side_count; ++side)
      settled[sides_[side].body] = std::max(settled[sides_[side].body], reached[s]);
  }
  for (std::size_t i = stores; i < chunk_items_.size(); ++i) chunk_items_[i] += chunk_items_[i - stores];
  for (int k = 0, b = 0; k < count; ++k) {
    chunks_.push_back({k * kChunkSize, std::min((k + 1) * kChunkSize, body_count()), b, b});
    while (b < body_count() && settled[b] <= k) ++b;
    chunks_.back().settled_end = b;
  }
}

/// Calls visit(store, range) for the items of a chunk.
template <typename Visit>
void Rows::for_each_range(const BodyChunk& chunk, Visit visit) const {
  const std::size_t* first = chunk_items_.data() + chunk.begin / kChunkSize * stores_.size();
  for (const auto& store : stores_) {
    visit(*store, detail::ItemRange{*first, first[stores_.size()]});
    ++first;
  }
}

void Rows::residual(const Configuration& at, std::span<double> phi) const {
  for (const auto& store : stores_) store->residual(at, phi.data());
}

void Rows::jacobian(const Configuration& at, std::span<double> values) const {
  for (const auto& [first, count] : cleared_) std::fill_n(values.begin() + first, count, 0.0);
  for (const auto& store : stores_) store->jacobian(at, values.data());
}

void Rows::residual(const Configuration& at, std::span<double> phi, const BodyChunk& chunk) const {
  for_each_range(chunk, [&](const auto& store, auto range) { store.residual(at, phi.data(), range); });
}

void Rows::jacobian(const Configuration& at, std::span<double> values, const BodyChunk& chunk) const {
  if (chunk.begin == 0)
    for (const auto& [first, count] : cleared_) std::fill_n(values.begin() + first, count, 0.0);
  for_each_range(chunk, [&](const auto& store, auto range) { store.jacobian(at, values.data(), range); });
}

void Rows::residual(const JointRows& block, const Configuration& at, std::span<double> phi) const {
  for (int r = block.first_row; r < block.first_row + block.row_count; ++r) {
    const Row& row = rows_[r];
    const auto item = static_cast<std::size_t>(row.item);
    if (row.row_in_part == 0) row.store->residual(at, phi.data(), {item, item + 1});
  }
}

void Rows::jacobian(const JointRows& block, const Configuration& at, std::span<double> values) const {
  for (int s = block.first_side; s < block.first_side + block.side_count; ++s)
    std::fill_n(values.begin() + sides_[s].offset, sides_[s].value_count(), 0.0);
  for (int r = block.first_row; r < block.first_row + block.row_count; ++r) {
    const Row& row = rows_[r];
    const auto item = static_cast<std::size_t>(row.item);
    if (row.row_in_part == 0) row.store->jacobian(at, values.data(), {item, item + 1});
  }
}

void Rows::bias(const Configuration& at, std::span<const Twist> twists, std::span<double> gamma) const {
  for (const auto& store : stores_) store->bias(at, twists, gamma.data());
}

void Rows::stiffness(const Configuration& at, std::span<const double> lambda,
                     std::span<StiffnessBlocks> bodies) const {
  for (const auto& store : stores_) store->stiffness(at, lambda.data(), bodies);
}

void Rows::stiffness(const Configuration& at, std::span<const double> lambda,
                     std::span<StiffnessBlocks> bodies, const BodyChunk& chunk) const {
  for_each_range(chunk,
                 [&](const auto& store, auto range) { store.stiffness(at, lambda.data(), bodies, range); });
}

void Rows::add_rate(const Configuration& at, std::span<double> out) const {
  for (const auto& store : stores_) store->add_rate(at, out.data());
}

bool Rows::depends_on_time() const {
  return std::any_of(stores_.begin(), stores_.end(), [](const auto& s) { return s->depends_on_time(); });
}

void Rows::update_axes(const Configuration& at, std::span<double> axes) const {
  for (const auto* store : stores_with_axes_) store->update_axes(at, axes);
}

void Rows::apply(std::span<const double> jacobian, std::span<const Twist> twists,
                 std::span<double> out) const {
  for (const JointRows& joint : joints_) detail::rates_of(*this, joint, jacobian, twists, out);
}

void Rows::apply_transpose(std::span<const double> jacobian, std::span<const double> lambda,
                           std::span<Wrench> out) const {
  for (int body = 0; body < body_count(); ++body)
    out[body] = detail::wrench_on(*this, body, jacobian, lambda);
}

Eigen::Matrix<double, 6, 1> Rows::block_row(const Side& side, std::span<const double> jacobian, int i) {
  using Six = Eigen::Matrix<double, 6, 1>;
  const double* J = jacobian.data() + side.offset;
  if (side.arm == 0) return Eigen::Map<const Six>(J + 6 * i);
  Six row = Six::Zero();
  detail::add_force_at(J, side.arm * Vec3::Unit(i), row);
  return row;
}

}  // namespace taut
