#include "collision/broad/broad_phase.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <deque>

namespace taut::detail {
namespace {

/// Boxes in the tree are larger by this part of their diagonal on each side.
constexpr double kFat = 0.05;

/// FCL's object with a box of our own: FCL would compute that of a bounding sphere.
class Proxy final : public fcl::CollisionObjectd {
 public:
  Proxy(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, int index_in)
      : fcl::CollisionObjectd(geometry), index(index_in) {}
  /// True if the box did not fit any more.
  bool fit(const Bounds& bounds) {
    if ((bounds.low.array() >= aabb.min_.array()).all() && (bounds.high.array() <= aabb.max_.array()).all())
      return false;
    put(bounds);
    return true;
  }
  void put(const Bounds& bounds) {
    const Vec3 fat = Vec3::Constant(kFat * (bounds.high - bounds.low).norm());
    aabb.min_ = bounds.low - fat;
    aabb.max_ = bounds.high + fat;
  }
  const int index;
};

/// What FCL's call-back needs.
struct Query {
  const World& world;
  std::span<const Bounds> bounds;
  std::vector<std::pair<int, int>>& pairs;
  std::size_t most;
};

/// True: enough.
bool collect(fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data) {
  Query& query = *static_cast<Query*>(data);
  int a = static_cast<const Proxy*>(first)->index, b = static_cast<const Proxy*>(second)->index;
  if (a > b) std::swap(a, b);
  if (!query.bounds[a].overlaps(query.bounds[b]) || !query.world.may_collide(ShapeId{a}, ShapeId{b}))
    return false;
  query.pairs.emplace_back(a, b);
  return query.pairs.size() > query.most;
}

}  // namespace

struct BroadPhase::Impl {
  std::deque<Proxy> proxies;
  std::vector<Role> roles;
  std::vector<fcl::CollisionObjectd*> left_moving, left_fixed;
  using Tree = fcl::DynamicAABBTreeCollisionManagerd;
  std::unique_ptr<Tree> moving = std::make_unique<Tree>(), fixed = std::make_unique<Tree>();
};

BroadPhase::BroadPhase() : impl_(std::make_unique<Impl>()) {}
BroadPhase::~BroadPhase() = default;

void BroadPhase::reset(std::span<const Role> roles, std::span<const Bounds> bounds) {
  Impl& own = *impl_;
  own.moving = std::make_unique<Impl::Tree>();
  own.fixed = std::make_unique<Impl::Tree>();
  own.proxies.clear();
  own.roles.assign(roles.begin(), roles.end());
  const auto geometry = std::make_shared<fcl::Sphered>(1.0);  // never looked at
  std::vector<fcl::CollisionObjectd*> moving, fixed;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    own.proxies.emplace_back(geometry, static_cast<int>(i));
    own.proxies.back().put(bounds[i]);
    if (roles[i] == Role::kMoving) moving.push_back(&own.proxies.back());
    if (roles[i] == Role::kFixed) fixed.push_back(&own.proxies.back());
  }
  own.moving->registerObjects(moving);
  own.fixed->registerObjects(fixed);
  own.moving->setup();
  own.fixed->setup();
}

void BroadPhase::update(std::span<const Bounds> bounds) {
  Impl& own = *impl_;
  own.left_moving.clear(), own.left_fixed.clear();
  for (std::size_t i = 0; i < own.roles.size(); ++i)
    if (own.roles[i] != Role::kNone && own.proxies[i].fit(bounds[i]))
      (own.roles[i] == Role::kMoving ? own.left_moving : own.left_fixed).push_back(&own.proxies[i]);
  // Put anew one by one: FCL's update() of everything only stretches boxes, and the tree decays without
  // bound.
  if (!own.left_moving.empty()) own.moving->update(own.left_moving);
  if (!own.left_fixed.empty()) own.fixed->update(own.left_fixed);
}

bool BroadPhase::find_pairs(const World& world, std::span<const Bounds> bounds, std::size_t most,
                            std::vector<std::pair<int, int>>& pairs) {
  Impl& own = *impl_;
  Query query{world, bounds, pairs, most};
  if (own.moving->empty()) return true;
  own.moving->collide(&query, collect);
  if (pairs.size() <= most && !own.fixed->empty()) own.moving->collide(own.fixed.get(), &query, collect);
  return pairs.size() <= most;
}

}  // namespace taut::detail
