#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/state/state.h"
#include "core/world/shape.h"
#include "scenes/import/notice.h"

/// What URDF, SDF and MJCF have in common: links in a tree, axes between them, loops and relations.
/// Frames: L of a link, W of the world.  SI units, angles in rad.
namespace taut::model {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();
inline constexpr int kWorld = -1;  ///< in place of the index of a link

inline Pose inverse(const Pose& X) { return {X.q.conjugate(), X.q.conjugate() * Vec3(-X.p)}; }

/// Mass [kg], its centre [m] and the inertia about the centre [kg m²], in the axes of a link.
struct LinkInertia {
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
};

/// Coulomb's coefficient and lever arms [m].  Two surfaces have those of the one with priority, or the larger
/// of each, as far as the larger number of directions goes: 1 none, 3 sliding, 4 spinning as well, 6 rolling
/// as well.
struct Surface {
  int directions = 3;
  double sliding = 0.5, spinning = 0, rolling = 0;
  int priority = 0;
  int number = 0;  ///< of one that a pair names, which has coefficients of its own with another; 0: none
  auto operator<=>(const Surface&) const = default;
};
inline Surface larger_of(const Surface& a, const Surface& b) {
  if (a.priority != b.priority) return a.priority > b.priority ? a : b;
  return {std::max(a.directions, b.directions), std::max(a.sliding, b.sliding),
          std::max(a.spinning, b.spinning), std::max(a.rolling, b.rolling), a.priority};
}

/// A collision shape.
/// Two shapes touch if one's type shares a bit with the other's affinity, or if one is the first, and the
/// other the second, of a pair that is named.
struct TouchKind {
  int type = 1, affinity = 1;         ///< bits
  std::set<int> first_of, second_of;  ///< numbers of pairs
  /// A second condition of the same form on types and affinities, which has to be met as well.
  int category = ~0, collide = ~0;

  auto as_tuple() const { return std::tie(type, affinity, first_of, second_of, category, collide); }
  bool operator<(const TouchKind& other) const { return as_tuple() < other.as_tuple(); }
};

inline bool touch(const TouchKind& a, const TouchKind& b) {
  const auto share = [](const std::set<int>& firsts, const std::set<int>& seconds) {
    return std::any_of(firsts.begin(), firsts.end(), [&](int pair) { return seconds.contains(pair); });
  };
  const bool by_type = (a.type & b.affinity) || (b.type & a.affinity);
  const bool by_category = (a.category & b.collide) || (b.category & a.collide);
  return (by_type && by_category) || share(a.first_of, b.second_of) || share(b.first_of, a.second_of);
}

struct LinkShape {
  Shape shape;
  Pose X_LS;
  Surface surface;
  TouchKind touches;
  std::string name;
};

/// What acts along an axis at rest; forces [N or N·m].
struct AxisLaw {
  double lower = -kNoLimit, upper = kNoLimit;
  double stiffness = 0, rest = 0, damping = 0;
  double friction = 0;
};

/// Actuators of an axis: force = constant − stiffness q − damping q̇ in the terms of the file, together at
/// most `most`.
struct AxisDrive {
  double constant = 0, stiffness = 0, damping = 0;
  double most = kNoLimit;
  bool any() const { return constant != 0 || stiffness > 0 || damping > 0; }
};

/// One motion of a link against its parent.  Several follow each other, the first next to the parent.
struct LinkAxis {
  enum class Kind { kHinge, kSlide, kBall, kScrew };
  Kind kind = Kind::kHinge;
  std::string name;
  Vec3 anchor = Vec3::Zero();  ///< at the start, in the link's frame
  Vec3 axis = Vec3::UnitZ();   ///< of unit length, likewise
  double start = 0;            ///< value at the start, in the terms of the file; the scene's is 0 there
  double rate = 0;             ///< at the start [rad/s or m/s]
  Vec3 spin = Vec3::Zero();    ///< of a ball, in place of the rate: in the axes of the link [rad/s]
  double pitch = 0;            ///< of a screw [m per turn]
  double armature = 0;         ///< inertia of the motion by itself [kg m² or kg]
  AxisLaw law;
  AxisDrive drive;
  double most_drive = kNoLimit;  ///< that all drives together give [N·m or N]
  ModelPlace place;
};

struct Link {
  std::string name;
  int parent = kWorld;
  bool free = false;  ///< not joined to the parent
  Pose X_WL;          ///< at the start
  Twist free_twist;   ///< of a link that is free, at the start: of its origin, world axes
  LinkInertia inertia;
  std::string unknown_mass;  ///< why its mass cannot be computed, with file and line; empty: it is known
  std::vector<LinkShape> shapes;
  std::vector<LinkAxis> axes;  ///< none: fixed to the parent
  std::string joint_name;      ///< of what holds it fixed
  ModelPlace place;
};

/// A frame of a link, or of the world.
struct LinkFrame {
  int link = kWorld;
  Pose X_LF;
};

/// Closes a loop: origins of both frames meet; `fixed`: axes as well; `hinge`: one axis.  With axes it is the
/// joint that has them, where both links are.
struct Loop {
  std::string name;
  LinkFrame a, b;
  bool fixed = false;
  std::vector<LinkAxis> axes;  ///< in the frame of the link of b
  bool active = true;
  ModelPlace place;
  std::optional<Vec3> hinge{};  ///< the axis that both frames have in common, in either of them
};

/// Names an axis by the link that has it.
struct AxisName {
  int link = kWorld, axis = 0;
  auto operator<=>(const AxisName&) const = default;
};

/// driven = ratio · driving + constant; no driving axis: driven stays at `value`.  Three axes are those of a
/// differential: driven = ½ driving + ½ other + constant.
struct AxisRelation {
  std::string name;
  AxisName driven;
  std::optional<AxisName> driving, other;
  double ratio = 1, value = 0;
  bool active = true;
  ModelPlace place;
};

/// A wire through points of links: at most `longest` long, or with a spring; or a bar of its length.  That
/// of a pulley has four: the way from the second to the third, of one link, does not count, and what is
/// behind them counts `ratio` times.
struct Wire {
  std::string name;
  std::vector<LinkFrame> points;
  bool pulley = false;
  double ratio = 1;
  double longest = kNoLimit;
  std::optional<double> bar;  ///< length that two points, or a pulley, keep [m]
  bool bar_active = true;
  double stiffness = 0, damping = 0;
  double rest = 0, slack = 0;  ///< the spring is at rest from this length on, over this much more
  ModelPlace place;
};

/// Something to record: of an axis, or of a point or the joint of a link.
struct ModelProbe {
  std::string name, quantity;  ///< as in a scene file
  LinkFrame at;
  std::optional<AxisName> axis;
  ModelPlace place;
};

/// Two links that may, or may not, touch.
struct LinkPair {
  int a = kWorld, b = kWorld;
  bool collide = false;
};

struct RobotModel {
  std::string name;
  Vec3 gravity = Vec3(0, 0, -9.81);
  double dt = 1.0 / 240;
  bool contacts = true;
  bool actuation = true;          ///< false: actuators do nothing
  bool clamps_controls = true;    ///< controls keep to their range
  std::set<int> groups_disabled;  ///< of actuators, which do nothing
  /// What is joined to the ground, or by a loop, touches it all the same.
  bool joined_touch = false;
  /// An inertia that no body has is an error, as the format's own compiler has it; it has a word against
  /// that.
  bool refuses_wrong_inertia = false;
  std::vector<LinkShape> ground_shapes;
  std::vector<Link> links;  ///< parents first
  std::vector<Loop> loops;
  std::vector<AxisRelation> relations;
  std::vector<Wire> wires;
  std::vector<ModelProbe> probes;
  std::vector<LinkPair> pairs;
  int numbered_surfaces = 0;
  std::map<std::pair<int, int>, Surface> pair_surfaces;  ///< by numbers, the smaller first
  std::vector<ImportNotice> notices;
  std::size_t models = 0;  ///< of the file that are read already
  int elements = 0;        ///< of the file that were read, with their copies

  /// One is the parent of the other.
  bool are_next(int a, int b) const {
    return (a != kWorld && links[a].parent == b) || (b != kWorld && links[b].parent == a);
  }
  std::vector<LinkShape>& shapes_of(int link) { return link == kWorld ? ground_shapes : links[link].shapes; }
};

}  // namespace taut::model
