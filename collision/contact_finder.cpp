#include "collision/contact_finder.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>

#include "collision/broad/broad_phase.h"
#include "collision/narrow/feature_matching.h"
#include "collision/narrow/narrow_phase.h"
#include "core/base/check.h"
#include "core/base/clock.h"
#include "core/base/thread_pool.h"
#include "core/state/reach.h"

namespace taut {
namespace {

using detail::Bounds;
using detail::Geometry;
using Role = detail::BroadPhase::Role;

/// Pairs of one task; enough to be worth a task, few enough to share the work.
constexpr int kPairsPerTask = 32;
constexpr int kShapesPerTask = 256;
/// Contacts this near, in parts of the smaller shape, are the same one in a new guise.
constexpr double kSameContact = 0.02;
/// ContactSettings::max_contacts by default.  Convex bodies that are not in each other have no more than some
/// ten neighbours each, unless they are long and lie crosswise.
constexpr std::size_t kFreeContacts = 10000, kFreeContactsPerShape = 50;
/// So many more pairs of boxes: those on their way overlap with more than they meet.
constexpr std::size_t kPairsPerContact = 4;
/// Shapes that a crowd is named by.
constexpr std::size_t kNamed = 4;

/// A shape as the finder keeps it.
struct Item {
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Geometry> geometry;
  int body;
  Pose X_BS;
  double reach;  ///< farthest point from the centre of mass of the body [m]
};

/// What one task has found.
struct TaskResult {
  std::vector<Contact> contacts;
  std::vector<detail::ManifoldPoint> points;
  std::vector<std::pair<ShapeId, ShapeId>> unsupported;
  int touching = 0;
};

}  // namespace

struct ContactFinder::Impl {
  explicit Impl(ContactSettings s)
      : settings(s), pool(detail::thread_count(s.threads)), scratch(pool.size()) {}

  ContactSettings settings;
  detail::ThreadPool pool;
  std::vector<detail::NarrowScratch> scratch;  // one per worker
  detail::BroadPhase broad;
  std::vector<Item> items;
  std::vector<Role> roles;
  std::map<const Shape*, std::shared_ptr<const Geometry>> geometries;
  std::vector<Pose> poses;  // X_WS
  std::vector<Bounds> bounds;
  std::vector<std::pair<int, int>> pairs;
  std::vector<TaskResult> results;
  std::vector<Contact> contacts, before;
  std::atomic<std::size_t> found = 0;  // contacts, by tasks that are done
  bool in_tree = false;                // all that items has
  DetectionReport report;

  bool knows(const World& world) const;
  void learn(const World& world);
  void place(const State& state, double horizon);
  ShapeId out_of_reach() const;
  std::size_t most() const;
  Crowd crowd(std::size_t bound) const;
  bool find_pairs(const World& world, const State& state, double horizon);
  bool look_at_pairs(const State& state, double horizon);
  void begin_report();
  void find_in_task(int task, int worker, const State& state, double horizon);
  void find_pair(int a, int b, const State& state, double horizon, detail::NarrowScratch& work,
                 TaskResult& result) const;
  double speed(const Item& item, const State& state) const {
    const Twist& V = state.twists[item.body];
    const double turn = V.w.norm();
    return V.v.norm() + (turn > 0 ? turn * item.reach : 0);
  }
};

/// The same shapes on the same bodies as the last time?
bool ContactFinder::Impl::knows(const World& world) const {
  if (static_cast<int>(items.size()) != world.shape_count()) return false;
  for (int i = 0; i < world.shape_count(); ++i) {
    const ShapeRecord& record = world.shape({i});
    const Item& item = items[i];
    const Role role = item.geometry->kind == Geometry::Kind::kHalfSpace ? Role::kNone
                      : world.moves(record.body)                        ? Role::kMoving
                                                                        : Role::kFixed;
    if (item.shape != record.shape || item.body != record.body.index || item.X_BS.p != record.pose.p ||
        item.X_BS.q.coeffs() != record.pose.q.coeffs() || roles[i] != role)
      return false;
  }
  return true;
}

void ContactFinder::Impl::learn(const World& world) {
  items.clear(), roles.clear();
  std::map<const Shape*, std::shared_ptr<const Geometry>> needed;
  for (int i = 0; i < world.shape_count(); ++i) {
    const ShapeRecord& record = world.shape({i});
    std::shared_ptr<const Geometry>& geometry = needed[record.shape.get()];
    if (!geometry) {
      const auto old = geometries.find(record.shape.get());
      geometry = old != geometries.end() ? old->second : detail::make_geometry(*record.shape);
    }
    items.push_back(
        {record.shape, geometry, record.body.index, record.pose, record.pose.p.norm() + geometry->extent});
    roles.push_back(geometry->kind == Geometry::Kind::kHalfSpace ? Role::kNone
                    : world.moves(record.body)                   ? Role::kMoving
                                                                 : Role::kFixed);
  }
  geometries = std::move(needed);
}

/// Poses of all shapes, and boxes that hold them during the horizon.
void ContactFinder::Impl::place(const State& state, double horizon) {
  const int count = static_cast<int>(items.size());
  poses.resize(items.size());
  bounds.resize(items.size());
  const auto place_some = [&](int task, int) {
    const int end = std::min(count, (task + 1) * kShapesPerTask);
    for (int i = task * kShapesPerTask; i < end; ++i) {
      const Item& item = items[i];
      const Pose& X_WB = state.poses[item.body];
      poses[i] = {X_WB.q * item.X_BS.q, X_WB.point(item.X_BS.p)};
      if (roles[i] == Role::kNone) continue;
      item.geometry->bounds(poses[i], bounds[i].low, bounds[i].high);
      const Vec3 pad = Vec3::Constant(0.5 * settings.margin + speed(item, state) * horizon);
      bounds[i].low -= pad, bounds[i].high += pad;
    }
  };
  pool.run((count + kShapesPerTask - 1) / kShapesPerTask, std::cref(place_some));
}

/// Squares and volumes of boxes are what FCL's tree is built by.
ShapeId ContactFinder::Impl::out_of_reach() const {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!within(poses[i].p, kFarthestBox) || !poses[i].q.coeffs().allFinite() ||
        (roles[i] != Role::kNone &&
         !(within(bounds[i].low, kFarthestBox) && within(bounds[i].high, kFarthestBox))))
      return {static_cast<int>(i)};
  return {};
}

std::size_t ContactFinder::Impl::most() const {
  return settings.max_contacts > 0 ? static_cast<std::size_t>(settings.max_contacts)
                                   : kFreeContacts + kFreeContactsPerShape * items.size();
}

/// The shapes that most pairs have.
Crowd ContactFinder::Impl::crowd(std::size_t bound) const {
  std::vector<std::pair<int, int>> shapes;  // −pairs, shape
  for (int i = 0; i < std::ssize(items); ++i) shapes.emplace_back(0, i);
  for (const auto& [a, b] : pairs) --shapes[a].first, --shapes[b].first;
  Crowd crowd{.most = static_cast<std::int64_t>(bound), .shapes = {}};
  const std::size_t named = std::min(kNamed, shapes.size());
  std::partial_sort(shapes.begin(), shapes.begin() + static_cast<std::ptrdiff_t>(named), shapes.end());
  for (std::size_t k = 0; k < named; ++k) crowd.shapes.push_back({shapes[k].second});
  return crowd;
}

/// False if there are too many.
bool ContactFinder::Impl::find_pairs(const World& world, const State& state, double horizon) {
  if (!broad.find_pairs(world, bounds, kPairsPerContact * most(), pairs)) return false;
  const int count = static_cast<int>(items.size());
  for (int h = 0; h < count; ++h) {
    if (roles[h] != Role::kNone) continue;
    const Vec3 up = poses[h].q * Vec3::UnitZ();
    for (int i = 0; i < count; ++i) {
      if (i == h || (roles[i] == Role::kNone && i < h)) continue;
      if (!world.moves({items[i].body}) && !world.moves({items[h].body})) continue;
      const double reach = items[i].geometry->extent + settings.margin +
                           (speed(items[i], state) + state.twists[items[h].body].v.norm()) * horizon;
      // A half-space that turns sweeps everything; its pairs are judged one by one.
      const bool turns = !state.twists[items[h].body].w.isZero(0);
      if (!turns && up.dot(poses[i].p - poses[h].p) > reach) continue;
      if (world.may_collide(ShapeId{i}, ShapeId{h})) pairs.emplace_back(std::min(i, h), std::max(i, h));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return true;
}

void ContactFinder::Impl::find_in_task(int task, int worker, const State& state, double horizon) {
  TaskResult& result = results[task];
  result.contacts.clear(), result.unsupported.clear();
  result.touching = 0;
  if (found > most()) return;
  const std::size_t end = std::min(pairs.size(), static_cast<std::size_t>(task + 1) * kPairsPerTask);
  for (std::size_t i = static_cast<std::size_t>(task) * kPairsPerTask; i < end; ++i)
    find_pair(pairs[i].first, pairs[i].second, state, horizon, scratch[worker], result);
  found += result.contacts.size();
}

void ContactFinder::Impl::find_pair(int a, int b, const State& state, double horizon,
                                    detail::NarrowScratch& work, TaskResult& result) const {
  const Item &item_a = items[a], &item_b = items[b];
  if (!have_contacts(*item_a.shape, *item_b.shape)) {
    result.unsupported.push_back({ShapeId{a}, ShapeId{b}});
    return;
  }
  const Twist &V_A = state.twists[item_a.body], &V_B = state.twists[item_b.body];
  // No two points of the pair approach faster than this.
  const double finite_reach = std::min(item_a.reach, item_b.reach);
  double closing = (V_A.v - V_B.v).norm();
  const bool endless = !std::isfinite(std::max(item_a.reach, item_b.reach));
  if (endless) {
    // Points of a half-space matter only where the other shape is.
    const double distance = (state.poses[item_a.body].p - state.poses[item_b.body].p).norm();
    closing += (V_A.w.norm() + V_B.w.norm()) * (finite_reach + distance);
  } else {
    closing += V_A.w.norm() * item_a.reach + V_B.w.norm() * item_b.reach;
  }
  const double cutoff = settings.margin + closing * horizon;
  const Mat3 R_WA = poses[a].q.toRotationMatrix();
  const detail::Relative X_ab{R_WA.transpose() * poses[b].q.toRotationMatrix(),
                              R_WA.transpose() * (poses[b].p - poses[a].p)};
  result.points.clear();
  detail::find_contacts(*item_a.geometry, *item_b.geometry, X_ab, cutoff,
                        static_cast<std::size_t>(settings.max_points), work, result.points);
  const std::size_t first = result.contacts.size();
  const Pose &X_A = state.poses[item_a.body], &X_B = state.poses[item_b.body];
  for (const detail::ManifoldPoint& point : result.points) {
    Contact contact;
    contact.a = {a}, contact.b = {b};
    contact.A = {item_a.body}, contact.B = {item_b.body};
    contact.normal = R_WA * point.n;
    contact.gap = point.gap;
    contact.feature = point.id;
    contact.surface_A = point.surface_A.turned(R_WA);
    contact.surface_B = point.surface_B.turned(R_WA);
    contact.p_AP = item_a.X_BS.point(point.p);
    // Q in the frame of shape b first: world coordinates would lose digits far from the origin.
    contact.p_BQ = item_b.X_BS.point(X_ab.R.transpose() * (point.q - X_ab.p));
    const Vec3 v_P = V_A.at(X_A.q * contact.p_AP), v_Q = V_B.at(X_B.q * contact.p_BQ);
    // Written so that nothing comes of poses that are not finite.
    const double reach = settings.margin + horizon * std::max(0.0, -contact.normal.dot(v_Q - v_P));
    if (!(contact.gap <= reach)) continue;
    result.contacts.push_back(contact);
  }
  result.touching += result.contacts.size() > first;
}

/// False, with no contacts, if there are too many; the tasks that have not begun then have nothing to do.
bool ContactFinder::Impl::look_at_pairs(const State& state, double horizon) {
  const int tasks = static_cast<int>((pairs.size() + kPairsPerTask - 1) / kPairsPerTask);
  if (results.size() < static_cast<std::size_t>(tasks)) results.resize(tasks);
  const auto find_some = [&](int task, int worker) { find_in_task(task, worker, state, horizon); };
  found = 0;
  pool.run(tasks, std::cref(find_some));  // by reference: a function object of this size would be allocated
  if (found > most()) return false;
  for (int task = 0; task < tasks; ++task) {
    const TaskResult& result = results[task];
    contacts.insert(contacts.end(), result.contacts.begin(), result.contacts.end());
    report.unsupported.insert(report.unsupported.end(), result.unsupported.begin(), result.unsupported.end());
    report.touching_pairs += result.touching;
  }
  return true;
}

/// Its lists keep their memory.
void ContactFinder::Impl::begin_report() {
  report.shapes = static_cast<int>(items.size());
  report.candidate_pairs = report.touching_pairs = 0;
  report.unsupported.clear();
  report.crowd.shapes.clear();
  report.out_of_reach = {};
  report.broad_seconds = report.narrow_seconds = 0;
  report.missing_threads = pool.missing();
}

bool have_contacts(const Shape& a, const Shape& b) {
  const auto is_surface = [](const Shape& s) {
    return std::holds_alternative<TriangleMesh>(s) || std::holds_alternative<HeightField>(s);
  };
  const auto is_ground = [](const Shape& s) {
    return std::holds_alternative<HalfSpace>(s) || std::holds_alternative<HeightField>(s);
  };
  return !(is_surface(a) && is_surface(b)) && !(is_ground(a) && is_ground(b));
}

ContactFinder::ContactFinder(ContactSettings settings) {
  require_not_negative("contact margin", settings.margin);
  detail::check_threads("contact threads", settings.threads);
  if (settings.max_contacts < 0) fail("contact max_contacts", "must not be negative", settings.max_contacts);
  if (settings.max_points < 4 || settings.max_points > 64)
    fail("contact max_points", "must be from 4 to 64", settings.max_points);
  impl_ = std::make_unique<Impl>(settings);
}
ContactFinder::~ContactFinder() = default;
ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder& ContactFinder::operator=(ContactFinder&&) noexcept = default;

const std::vector<Contact>& ContactFinder::contacts() const { return impl_->contacts; }
const DetectionReport& ContactFinder::report() const { return impl_->report; }
const ContactSettings& ContactFinder::settings() const { return impl_->settings; }
void ContactFinder::forget() { impl_->contacts.clear(); }
void ContactFinder::recall(std::vector<Contact> contacts) { impl_->contacts = std::move(contacts); }

const std::vector<Contact>& ContactFinder::find(const World& world, const State& state, double horizon) {
  require_not_negative("contact horizon", horizon);
  const std::size_t bodies = static_cast<std::size_t>(world.body_count());
  if (state.poses.size() != bodies) fail("state", "must have one pose per body", state.poses.size());
  if (state.twists.size() != bodies) fail("state", "must have one twist per body", state.twists.size());
  Impl& own = *impl_;
  auto start = Clock::now();
  if (!own.knows(world)) {
    own.in_tree = false;
    own.learn(world);
  }
  own.place(state, horizon);
  own.begin_report();
  own.before.swap(own.contacts);
  own.contacts.clear();
  if (own.report.out_of_reach = own.out_of_reach(); own.report.blind()) return own.contacts;
  if (own.in_tree)
    own.broad.update(own.bounds);
  else
    own.broad.reset(own.roles, own.bounds);
  own.in_tree = true;
  own.pairs.clear();
  const bool few = own.find_pairs(world, state, horizon);
  own.report.candidate_pairs = static_cast<int>(own.pairs.size());
  own.report.broad_seconds = seconds_since(start);
  if (!few) {
    own.report.crowd = own.crowd(kPairsPerContact * own.most());
    return own.contacts;
  }

  start = Clock::now();
  if (!own.look_at_pairs(state, horizon)) {
    own.report.crowd = own.crowd(own.most());
    return own.contacts;
  }
  detail::match_features(own.before, own.contacts, [&](const Contact& contact) {
    return kSameContact *
           std::min(own.items[contact.a.index].geometry->extent, own.items[contact.b.index].geometry->extent);
  });
  own.report.narrow_seconds = seconds_since(start);
  return own.contacts;
}

}  // namespace taut
