#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tests/fuzz/world.h"
#include "tests/fuzz/world_draft.h"

namespace taut::fuzz {
namespace {

/// The rotation that takes z to a direction.
Quat z_to(const Vec3& direction) { return Quat::FromTwoVectors(Vec3::UnitZ(), direction); }

/// One of the chains: links along a line, tied to the ground at its beginning or not.
void add_chain(WorldDraft& draft, int links, const Vec3& from, const Vec3& along) {
  Random& random = draft.random;
  const double length = draft.size * random.of<double>({0.1, 0.2, 0.2, 0.4}),
               radius = length * random.uniform(0.1, 0.25);
  const std::string type = random.of<std::string>({"ball", "ball", "ball", "universal", "hinge"});
  const bool boxes = random.chance(0.25), beads = !boxes && random.chance(0.15);
  const bool rubs = random.chance(0.25), limited = type == "ball" && random.chance(0.25);
  const double heavy_end = random.chance(0.2) ? random.decades(1, 2) : 1;
  Vec3 u, v;
  complete_frame(along, u, v);
  const Quat q = z_to(along);
  std::string last = random.chance(0.4) ? "ground" : "";
  const double torque =
      0.1 * draft.density * length * length * length * length * 9.81 * random.decades(-2, 1);
  for (int k = 0; k < links; ++k) {
    const Pose pose{q, from + (k + 0.5) * length * along};
    const Json shape = boxes   ? draft.box(Vec3(2 * radius, 2 * radius, 0.9 * length))
                       : beads ? draft.ball(0.45 * length)
                               : draft.capsule(radius, length - 2 * radius);
    const std::string link = draft.add_body(shape, pose, draft.density * (k == links - 1 ? heavy_end : 1));
    const Vec3 anchor = from + k * length * along;
    if (!last.empty()) {
      Json& joint = draft.add_joint(type, last, link, anchor);
      if (type == "universal")
        joint.update({{"frame", "world"}, {"axis_a", json_of(u)}, {"axis_b", json_of(v)}});
      if (type == "hinge") joint["axis"] = json_of(k % 2 ? u : v);
      if (type == "ball" && (rubs || limited)) joint["frame_orientation"] = json_of(q);
      const Json friction = {{"static", torque}, {"dynamic", 0.8 * torque}};
      Json axes = Json::object();
      if (rubs && type == "ball")
        for (const char* turn : {"turn_x", "turn_y", "turn_z"}) axes[turn] = {{"friction", friction}};
      if (rubs && type == "hinge") axes["angle"] = {{"friction", friction}};
      if (rubs && type == "universal")
        for (const char* angle : {"angle_1", "angle_2"}) axes[angle] = {{"friction", friction}};
      if (limited) axes["swing"] = {{"limits", {{"upper", random.uniform(0.3, 1.2)}}}};
      if (!axes.empty()) joint["axes"] = axes;
    }
    last = link;
  }
}

/// A part of a doll from one point to another, and the joint with the part before it.
struct Limb {
  const char* part;
  const char* on;
  std::array<double, 3> from, to, joint;
  double radius, mass;
  double cone, twist;  ///< limits of a ball joint, or
  double bend;         ///< of a hinge about `axis`
  std::array<double, 3> axis;
};
constexpr double kNone = 0;
constexpr Limb kLimbs[] = {
    {"pelvis", "", {-0.15, 0, 0.05}, {0.15, 0, 0.05}, {0, 0, 0}, 0.1, 12, kNone, kNone, kNone, {0, 0, 1}},
    {"chest", "pelvis", {0, 0, 0.15}, {0, 0, 0.55}, {0, 0, 0.15}, 0.15, 20, 0.5, 0.5, kNone, {0, 0, 1}},
    {"head", "chest", {0, 0, 0.6}, {0, 0, 0.85}, {0, 0, 0.58}, 0.1, 5, 0.6, 0.9, kNone, {0, 0, 1}},
    {"arm_l", "chest", {0.2, 0, 0.5}, {0.5, 0, 0.5}, {0.2, 0, 0.5}, 0.05, 2.5, 1.5, 0.8, kNone, {1, 0, 0}},
    {"hand_l", "arm_l", {0.5, 0, 0.5}, {0.85, 0, 0.5}, {0.5, 0, 0.5}, 0.04, 2, kNone, kNone, 2.4, {0, 0, -1}},
    {"arm_r",
     "chest",
     {-0.2, 0, 0.5},
     {-0.5, 0, 0.5},
     {-0.2, 0, 0.5},
     0.05,
     2.5,
     1.5,
     0.8,
     kNone,
     {-1, 0, 0}},
    {"hand_r",
     "arm_r",
     {-0.5, 0, 0.5},
     {-0.85, 0, 0.5},
     {-0.5, 0, 0.5},
     0.04,
     2,
     kNone,
     kNone,
     2.4,
     {0, 0, 1}},
    {"leg_l", "pelvis", {0.1, 0, 0}, {0.1, 0, -0.45}, {0.1, 0, 0}, 0.08, 8, 0.9, 0.5, kNone, {0, 0, -1}},
    {"foot_l",
     "leg_l",
     {0.1, 0, -0.45},
     {0.1, 0, -0.9},
     {0.1, 0, -0.45},
     0.05,
     4,
     kNone,
     kNone,
     2.2,
     {1, 0, 0}},
    {"leg_r", "pelvis", {-0.1, 0, 0}, {-0.1, 0, -0.45}, {-0.1, 0, 0}, 0.08, 8, 0.9, 0.5, kNone, {0, 0, -1}},
    {"foot_r",
     "leg_r",
     {-0.1, 0, -0.45},
     {-0.1, 0, -0.9},
     {-0.1, 0, -0.45},
     0.05,
     4,
     kNone,
     kNone,
     2.2,
     {1, 0, 0}},
};

/// It touches the ground, other bodies and other dolls, not itself.
void add_doll(WorldDraft& draft, int number, const Pose& pose, double scale) {
  Random& random = draft.random;
  const double viscous = random.chance(0.7) ? 0.5 : 0, dry = random.chance(0.4) ? random.decades(-1, 1.3) : 0;
  const double powers = std::pow(scale, 4);
  const Vec3 v = random.in_cube(2), w = random.in_cube(2);
  const auto vec = [](const std::array<double, 3>& a) { return Vec3(a[0], a[1], a[2]); };
  const auto at = [&](const Vec3& p) -> Vec3 { return pose.p + scale * (pose.q * p); };
  Json friction = Json::object();
  if (dry > 0) friction["static"] = dry * powers;
  friction["viscous"] = viscous * powers;
  std::map<std::string, std::string> names;
  Json others = Json::array();
  for (int group = 0; group < 8; ++group)
    if (group != number + 1) others.push_back(group);
  for (const Limb& limb : kLimbs) {
    const Vec3 from = at(vec(limb.from)), to = at(vec(limb.to)), middle = (from + to) / 2;
    const double radius = scale * limb.radius, length = std::max(0.0, (to - from).norm() - 2 * radius);
    const double volume = std::numbers::pi * radius * radius * (length + 4.0 / 3 * radius);
    const std::string body =
        draft.add_body(draft.capsule(radius, length), {z_to((to - from).normalized()), middle},
                       limb.mass * scale * scale * scale / volume);
    draft.set_groups({number + 1}, others);
    draft.set_velocity(v + w.cross(middle - pose.p), w);
    names[limb.part] = body;
    if (*limb.on == 0) continue;
    const Vec3 axis = pose.q * vec(limb.axis);
    const bool hinge = limb.bend > 0;
    Json& joint = draft.add_joint(hinge ? "hinge" : "ball", names[limb.on], body, at(vec(limb.joint)));
    if (hinge) {
      joint["axis"] = json_of(axis);
      joint["axes"] = {{"angle", {{"limits", {{"lower", 0}, {"upper", limb.bend}}}, {"friction", friction}}}};
      continue;
    }
    joint["frame_orientation"] = json_of(z_to(axis));
    joint["axes"] = {{"swing", {{"limits", {{"upper", limb.cone}}}}},
                     {"twist", {{"limits", {{"lower", -limb.twist}, {"upper", limb.twist}}}}}};
    for (const char* turn : {"turn_x", "turn_y", "turn_z"}) joint["axes"][turn] = {{"friction", friction}};
  }
}

/// Cells of a lattice with a body in each, hinged, slid or otherwise tied to the one before it.
class Linkage {
 public:
  Linkage(WorldDraft& draft, const Vec3& origin, double cell) : draft_(draft), origin_(origin), cell_(cell) {}

  void add(int count, bool on_ground) {
    place("", {0, 0, 0});
    if (on_ground) tie("ground", {0, 0, 0}, {0, 0, -1}, {0, 0, 0});
    for (int tries = 0; static_cast<int>(cells_.size()) < count && tries < 200; ++tries) {
      const Cell from = cells_[draft_.random.below(static_cast<int>(cells_.size()))];
      const std::array<int, 3> step = kSteps[draft_.random.below(5)];  // never down
      const std::array<int, 3> to{from.at[0] + step[0], from.at[1] + step[1], from.at[2] + step[2]};
      if (taken_.contains(to)) continue;
      place("", to);
      tie(from.body, from.at, step, to);
    }
    // Loops, of hinges that are parallel: four-bars in the plane of the lattice.
    if (draft_.random.chance(0.3)) close_loop();
  }

 private:
  struct Cell {
    std::string body;
    std::array<int, 3> at;
  };
  static constexpr std::array<std::array<int, 3>, 5> kSteps{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}};

  Vec3 centre(const std::array<int, 3>& at) const { return origin_ + cell_ * Vec3(at[0], at[1], at[2]); }

  void place(const std::string&, const std::array<int, 3>& at) {
    const double edge = 0.85 * cell_;
    const auto part = [&] { return edge * draft_.random.uniform(0.4, 1); };
    const int type = draft_.random.below(4);
    const Json shape = type == 0   ? draft_.ball(0.4 * part())
                       : type == 1 ? draft_.capsule(0.2 * edge, 0.5 * part())
                                   : draft_.box(Vec3(part(), part(), part()));
    const double heavy = draft_.random.chance(0.2) ? draft_.random.decades(-1.5, 1.5) : 1;
    cells_.push_back({draft_.add_body(shape, {Quat::Identity(), centre(at)}, draft_.density * heavy), at});
    taken_.insert(at);
  }

  void tie(const std::string& a, const std::array<int, 3>& from, const std::array<int, 3>& step,
           const std::array<int, 3>& to) {
    (void)from;
    Random& random = draft_.random;
    const Vec3 along(step[0], step[1], step[2]),
        anchor = centre(to) - 0.5 * cell_ * (a == "ground" ? -along : along);
    const std::string type = random.of<std::string>(
        {"hinge", "hinge", "hinge", "slider", "universal", "ball", "cylindrical", "fixed"});
    Vec3 u, v;
    complete_frame(along, u, v);
    Json& joint = draft_.add_joint(type, a, cells_.back().body, anchor);
    Json axes = Json::object();
    const double cells = cell_ * cell_ * cell_, weight = 0.3 * draft_.density * cells * 9.81;
    if (type == "hinge") joint["axis"] = json_of(random.chance(0.3) ? along : random.chance(0.5) ? u : v);
    if (type == "slider" || type == "cylindrical") joint["axis"] = json_of(along);
    if (type == "universal")
      joint.update({{"frame", "world"}, {"axis_a", json_of(u)}, {"axis_b", json_of(v)}});
    if (type == "hinge" || type == "cylindrical") act(axes["angle"], 1, weight * cell_);
    if (type == "slider" || type == "cylindrical") act(axes["displacement"], cell_, weight);
    if (type == "universal") act(axes["angle_1"], 1, weight * cell_), act(axes["angle_2"], 1, weight * cell_);
    if (type == "ball" && random.chance(0.6)) {
      joint["frame_orientation"] = json_of(z_to(along));
      axes["swing"] = {{"limits", {{"upper", random.uniform(0.3, 1.5)}}}};
      if (random.chance(0.5)) axes["twist"] = {{"limits", {{"lower", -0.5}, {"upper", 0.5}}}};
    }
    for (auto it = axes.begin(); it != axes.end();) it = it->empty() ? axes.erase(it) : std::next(it);
    if (!axes.empty()) joint["axes"] = axes;
  }

  /// Limits, motors, friction and springs of an axis.
  void act(Json& axis, double length, double push) {
    Random& random = draft_.random;
    axis = Json::object();
    const double rate = length / std::sqrt(cell_ / 9.81);
    if (random.chance(0.6)) {
      axis["limits"] = {{"lower", -length * random.uniform(0.05, 1)},
                        {"upper", length * random.uniform(0.05, 1)}};
      if (random.chance(0.25)) axis["limits"]["restitution"] = random.uniform(0, 0.9);
    }
    if (random.chance(0.5)) {
      Json& motor = axis["motor"] = Json::object();
      if (random.chance(0.5))
        motor["velocity"] = 2 * rate * random.uniform(-1, 1);
      else
        motor["position"] = length * random.uniform(-0.8, 0.8),
        motor["max_speed"] = rate * random.decades(-1, 0.5);
      motor["max_force"] = push * random.decades(-1, 1.5);
    }
    if (random.chance(0.5)) {
      axis["friction"] = {{"static", push * random.decades(-2, 0.5)}};
      if (random.chance(0.3)) axis["friction"]["viscous"] = push / rate * random.decades(-2, 0);
    }
    if (random.chance(0.15)) axis["spring"] = {{"stiffness", push / length * random.decades(-1, 1.5)}};
  }

  void close_loop() {
    for (const Cell& one : cells_)
      for (const Cell& other : cells_) {
        const bool beside =
            one.at[0] + 1 == other.at[0] && one.at[1] == other.at[1] && one.at[2] == other.at[2];
        if (!beside || joined(one.body, other.body)) continue;
        Json& joint =
            draft_.add_joint("hinge", one.body, other.body, centre(other.at) - Vec3(0.5 * cell_, 0, 0));
        joint["axis"] = json_of(Vec3(0, 1, 0));
        return;
      }
  }
  bool joined(const std::string& a, const std::string& b) const {
    for (const Json& joint : draft_.scene["joints"])
      if ((joint["a"] == a && joint["b"] == b) || (joint["a"] == b && joint["b"] == a)) return true;
    return false;
  }

  WorldDraft& draft_;
  Vec3 origin_;
  double cell_;
  std::vector<Cell> cells_;
  std::set<std::array<int, 3>> taken_;
};

/// Of bars with the hub of each node the first bar that ends there; bars do not touch each other.
void add_bars(WorldDraft& draft, int n, int m, const Pose& pose, double length, double radius) {
  std::map<std::pair<int, int>, std::string> hubs;
  const auto node = [&](int i, int j) -> Vec3 {
    return pose.p + pose.q * Vec3((i - 0.5 * (n - 1)) * length, (j - 0.5 * (m - 1)) * length, 0);
  };
  const auto add = [&](int i, int j, int k, int l) {
    const Vec3 from = node(i, j), to = node(k, l);
    const std::string bar = draft.add_body(draft.capsule(radius, length - 2 * radius),
                                           {z_to((to - from).normalized()), (from + to) / 2});
    draft.set_groups({1}, {0, 2});
    for (const auto& [end, p] : {std::pair{std::pair{i, j}, from}, std::pair{std::pair{k, l}, to}})
      if (const auto [hub, is_new] = hubs.try_emplace(end, bar); !is_new)
        draft.add_joint("ball", hub->second, bar, p);
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      if (i + 1 < n) add(i, j, i + 1, j);
      if (j + 1 < m) add(i, j, i, j + 1);
    }
  if (draft.random.chance(0.3)) {
    const std::string held = hubs[{0, 0}];
    draft.add_joint("ball", "ground", held, node(0, 0));
  }
}

/// Of balls that ropes or bars without mass connect.
void add_knots(WorldDraft& draft, int n, int m, const Pose& pose, double length, double radius) {
  const bool ropes = draft.random.chance(0.5);
  std::vector<std::string> names;
  const auto node = [&](int i, int j) -> Vec3 {
    return pose.p + pose.q * Vec3((i - 0.5 * (n - 1)) * length, (j - 0.5 * (m - 1)) * length, 0);
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i)
      names.push_back(draft.add_body(draft.ball(radius), {Quat::Identity(), node(i, j)}));
  const auto connect = [&](int i, int j, int k, int l) {
    Json& joint =
        draft.add_joint(ropes ? "rope" : "distance", names[i + n * j], names[k + n * l], Vec3(0, 0, 0));
    joint.erase("anchor");
    joint.update({{"frame", "world"}, {"anchor_a", json_of(node(i, j))}, {"anchor_b", json_of(node(k, l))}});
    if (ropes) joint["length"] = length * (1 + 1e-12);
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      if (i + 1 < n) connect(i, j, i + 1, j);
      if (j + 1 < m) connect(i, j, i, j + 1);
    }
}

}  // namespace

void add_chains(WorldDraft& draft) {
  Random& random = draft.random;
  draft.add_floor(1.5 * draft.size);
  const int chains = random.chance(0.25) ? 2 : 1;
  for (int c = 0; c < chains; ++c) {
    const int links = 3 + random.below(random.chance(0.3) ? 28 : 10);
    const double angle = random.uniform(-0.3, 0.3) + c * random.uniform(0.5, 1.5),
                 lean = random.uniform(-0.3, 1.3);
    const Vec3 along(std::cos(lean) * std::cos(angle), std::cos(lean) * std::sin(angle), std::sin(lean));
    const Vec3 from(-draft.size * random.uniform(0, 1), 0,
                    draft.size * (0.9 + 0.9 * c + random.uniform(0, 0.5)) +
                        (lean < 0 ? 0.4 * draft.size * links * -std::sin(lean) : 0));
    add_chain(draft, links, from, along);
  }
}

void add_net(WorldDraft& draft) {
  Random& random = draft.random;
  draft.add_floor(1.2 * draft.size);
  const int n = 2 + random.below(3), m = 2 + random.below(3);
  const double length = draft.size * random.uniform(0.15, 0.3);
  const Pose pose{exp_so3(random.in_cube(0.7)), Vec3(0, 0, draft.size * random.uniform(0.8, 1.1))};
  if (random.chance(0.6))
    add_bars(draft, n, m, pose, length, length * random.uniform(0.06, 0.15));
  else
    add_knots(draft, n + 1, m + 1, pose, length, length * random.uniform(0.15, 0.4));
  const int loose = random.below(4);
  for (int k = 0; k < loose; ++k)  // above and below it
    draft.add_body(draft.solid(draft.size * random.uniform(0.05, 0.12)),
                   {random.rotation(),
                    Vec3(0.3 * draft.size * random.uniform(-1, 1), 0.3 * draft.size * random.uniform(-1, 1),
                         pose.p.z() + draft.size * (k % 2 == 0 ? 1.0 + 0.2 * k : -0.6))});
}

void add_ragdolls(WorldDraft& draft) {
  Random& random = draft.random;
  draft.add_floor(1.2 * draft.size);
  const int dolls = random.chance(0.25) ? 2 : 1;
  const double scale = draft.size * random.uniform(0.6, 1);
  for (int d = 0; d < dolls; ++d)
    add_doll(draft, d, {random.rotation(), Vec3(0.3 * d * scale, 0.2 * d * scale, scale * (1.4 + 1.9 * d))},
             scale);
}

void add_heap(WorldDraft& draft) {
  Random& random = draft.random;
  const int count = 3 + random.below(random.chance(0.3) ? 22 : 10);
  const double radius = 0.15 * draft.size, pitch = 2.8 * radius;
  draft.add_floor(radius * random.uniform(4, 7));
  const int side = count > 12 ? 3 : 2;
  const double mass_decades = random.chance(0.7) ? 0 : random.uniform(0, 3);
  const bool only_balls = random.chance(0.1), only_boxes = !only_balls && random.chance(0.2);
  for (int k = 0; k < count; ++k) {
    const Vec3 cell(k % side - 0.5 * (side - 1), k / side % side - 0.5 * (side - 1), k / (side * side));
    const Vec3 at = pitch * cell + Vec3(0, 0, 2.5 * radius + draft.size * 0.3) + random.in_cube(0.1 * radius);
    const Json shape = only_balls   ? draft.ball(radius)
                       : only_boxes ? draft.box(Vec3(1.2, 1.2, 1.2) * radius)
                                    : draft.solid(radius * random.uniform(0.5, 1));
    const Quat turn = only_boxes && random.chance(0.5) ? Quat(Quat::Identity()) : random.rotation();
    draft.add_body(shape, {turn, at},
                   draft.density * std::pow(10.0, random.uniform(-mass_decades / 2, mass_decades / 2)));
    if (random.chance(0.5)) draft.set_velocity(random.in_cube(1.5), random.in_cube(6));
  }
}

void add_linkages(WorldDraft& draft) {
  Random& random = draft.random;
  draft.add_floor(1.5 * draft.size);
  const int linkages = 1 + random.below(2);
  const double cell = draft.size * random.uniform(0.15, 0.3);
  for (int l = 0; l < linkages; ++l) {
    const bool on_ground = random.chance(0.3);
    const Vec3 origin(l == 0 ? 0 : 0.3 * cell, 0,
                      draft.size * (0.6 + random.uniform(0, 0.3)) + 8.5 * cell * l);
    Linkage(draft, origin, cell).add(2 + random.below(6), on_ground);
  }
  const int loose = random.below(4);
  for (int k = 0; k < loose; ++k)
    draft.add_body(draft.solid(0.5 * cell),
                   {random.rotation(), Vec3(cell * random.uniform(-1, 1), cell * random.uniform(-1, 1),
                                            0.6 * draft.size + (8.5 * linkages + 2 * k) * cell)});
}

nlohmann::json make_world(std::uint64_t seed) {
  constexpr int kKinds = static_cast<int>(std::size(kWorldKinds));
  static constexpr void (*kAdd[])(WorldDraft&) = {add_chains, add_net, add_ragdolls, add_heap, add_linkages};
  WorldDraft draft(seed);
  kAdd[seed % kKinds](draft);
  return std::move(draft.scene);
}

}  // namespace taut::fuzz
