#include "scenes/import/joint_segments.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace taut::model {
namespace {

using Kind = LinkAxis::Kind;
constexpr double kSame = 1e-9;  // cosines, and distances [m]
constexpr const char* kAlong[] = {"x", "y", "z"};
constexpr const char* kAbout[] = {"angle_x", "angle_y", "angle_z"};

struct WorldAxis {
  Kind kind;
  Vec3 anchor, axis;
};

bool same(const Vec3& a, const Vec3& b) { return (a - b).norm() < kSame; }

/// The point of the first line that is next to the second; nothing if they do not meet.
std::optional<Vec3> meeting(const WorldAxis& a, const WorldAxis& b) {
  const Vec3 d = b.anchor - a.anchor, n = a.axis.cross(b.axis);
  if (n.norm() < kSame) return {};
  const Vec3 point = a.anchor + a.axis * d.cross(b.axis).dot(n) / n.squaredNorm();
  const Vec3 off = point - b.anchor;
  if ((off - off.dot(b.axis) * b.axis).norm() > kSame * (1 + d.norm())) return {};
  return point;
}

/// One axis of a kind by itself.
std::optional<JointSegment> single(const WorldAxis& a) {
  switch (a.kind) {
    case Kind::kHinge:
      return JointSegment{"hinge", 0, 1, {"angle"}, a.anchor, Quat::Identity()};
    case Kind::kSlide:
      return JointSegment{"slider", 0, 1, {"displacement"}, a.anchor, Quat::Identity()};
    case Kind::kScrew:
      return JointSegment{"screw", 0, 1, {"angle"}, a.anchor, Quat::Identity()};
    case Kind::kBall:
      return JointSegment{"ball", 0, 1, {}, a.anchor, Quat::Identity()};
  }
  return {};
}

/// Two axes that a joint of their own has.
std::optional<JointSegment> pair(const WorldAxis& a, const WorldAxis& b) {
  const bool hinges = a.kind == Kind::kHinge && b.kind == Kind::kHinge;
  const bool mixed = a.kind != b.kind && a.kind <= Kind::kSlide && b.kind <= Kind::kSlide;
  if (hinges && std::abs(a.axis.dot(b.axis)) < kSame)
    if (const auto point = meeting(a, b))
      return JointSegment{"universal", 0, 2, {"angle_1", "angle_2"}, *point, Quat::Identity()};
  if (!mixed || !same(a.axis, b.axis)) return {};
  const bool turns_first = a.kind == Kind::kHinge;
  return JointSegment{"cylindrical",
                      0,
                      2,
                      turns_first ? std::vector<std::string>{"angle", "displacement"}
                                  : std::vector<std::string>{"displacement", "angle"},
                      turns_first ? a.anchor : b.anchor,
                      Quat::Identity()};
}

/// The place of a direction among three; the first free place across what is there if it is new; −1: none.
int place_of(const Vec3& axis, std::array<std::optional<Vec3>, 3>& frame) {
  for (int i = 0; i < 3; ++i)
    if (frame[i] && same(*frame[i], axis)) return i;
  for (int i = 0; i < 3; ++i)
    if (frame[i] && std::abs(frame[i]->dot(axis)) > kSame) return -1;
  for (int i = 0; i < 3; ++i)
    if (!frame[i]) {
      frame[i] = axis;
      return i;
    }
  return -1;
}

/// Right-handed with what is missing filled in; nothing if the three directions are left-handed.
std::optional<Quat> frame_of(std::array<std::optional<Vec3>, 3> f) {
  if (!f[1]) {
    Vec3 u, v;
    complete_frame(*f[0], u, v);
    f[1] = u;
  }
  const Vec3 third = f[0]->cross(*f[1]);
  if (f[2] && !same(*f[2], third)) return {};
  Mat3 R;
  R << *f[0], *f[1], third;
  return Quat(R).normalized();
}

std::vector<const WorldAxis*> hinges_among(std::span<const WorldAxis> axes) {
  std::vector<const WorldAxis*> hinges;
  for (const WorldAxis& a : axes)
    if (a.kind == Kind::kHinge) hinges.push_back(&a);
  return hinges;
}

/// Names of the motions along and about the axes of one frame, which gets the directions that it lacks.
/// Nothing unless they are slides and then hinges, all different.
std::optional<std::vector<std::string>> motions_in_frame(std::span<const WorldAxis> axes,
                                                         std::array<std::optional<Vec3>, 3>& frame) {
  std::vector<std::string> keys;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const bool slides = axes[k].kind == Kind::kSlide;
    if (axes[k].kind > Kind::kSlide || (slides && k > 0 && axes[k - 1].kind == Kind::kHinge)) return {};
    const int place = place_of(axes[k].axis, frame);
    if (place < 0) return {};
    keys.emplace_back(slides ? kAlong[place] : kAbout[place]);
    if (std::count(keys.begin(), keys.end(), keys.back()) > 1) return {};
  }
  return keys;
}

/// Slides across each other, and then at most two hinges, along the axes of one frame.
std::optional<JointSegment> six_dof(std::span<const WorldAxis> axes) {
  JointSegment segment{"six_dof", 0, static_cast<int>(axes.size()), {}, Vec3::Zero(), Quat::Identity()};
  std::array<std::optional<Vec3>, 3> frame;
  const std::vector<const WorldAxis*> hinges = hinges_among(axes);
  if (hinges.size() > 2 || hinges.size() == axes.size()) return {};
  for (const WorldAxis* hinge : hinges)  // the two that a six_dof may have follow each other in its frame
    if (place_of(hinge->axis, frame) != (hinge == hinges[0] ? 0 : 1)) return {};
  auto keys = motions_in_frame(axes, frame);
  if (!keys) return {};
  const auto q = frame_of(frame);
  const auto point = hinges.size() == 2   ? meeting(*hinges[0], *hinges[1])
                     : hinges.size() == 1 ? std::optional(hinges[0]->anchor)
                                          : std::optional(axes[0].anchor);
  if (!q || !point) return {};
  segment.keys = std::move(*keys);
  segment.frame = *q;
  segment.anchor = *point;
  return segment;
}

/// Hinges, and then slides that turn with them: from the link to its parent these are slides and then hinges.
/// With both bodies and all directions the other way round, every motion is what it was.
std::optional<JointSegment> six_dof_from_link(std::span<const WorldAxis> axes) {
  if (axes.front().kind != Kind::kHinge || axes.back().kind != Kind::kSlide) return {};
  std::vector<WorldAxis> turned(axes.rbegin(), axes.rend());
  for (WorldAxis& axis : turned) axis.axis = -axis.axis;
  auto found = six_dof(turned);
  if (!found) return {};
  std::reverse(found->keys.begin(), found->keys.end());
  found->turned = true;
  return found;
}

/// As slides commute, two in the wrong order are tried the other way round by the caller's next try.
std::optional<JointSegment> segment_of(std::span<const WorldAxis> axes) {
  if (axes.size() == 1) return single(axes[0]);
  if (axes.size() == 2)
    if (auto found = pair(axes[0], axes[1])) return found;
  if (auto found = six_dof(axes)) return found;
  if (auto found = six_dof_from_link(axes)) return found;
  std::vector<WorldAxis> turned(axes.begin(), axes.end());
  if (turned[0].kind != Kind::kSlide || turned[1].kind != Kind::kSlide) return {};
  std::swap(turned[0], turned[1]);
  auto found = six_dof(turned);
  if (found) std::swap(found->keys[0], found->keys[1]);
  return found;
}

}  // namespace

std::vector<JointSegment> joint_segments(const Link& link) {
  std::vector<WorldAxis> axes;
  for (const LinkAxis& axis : link.axes)
    axes.push_back({axis.kind, link.X_WL.point(axis.anchor), (link.X_WL.q * axis.axis).normalized()});
  std::vector<JointSegment> segments;
  for (std::size_t first = 0; first < axes.size();) {
    std::optional<JointSegment> found;
    for (std::size_t count = std::min<std::size_t>(5, axes.size() - first); !found && count > 0; --count)
      found = segment_of(std::span(axes).subspan(first, count));
    found->first = static_cast<int>(first);
    first += static_cast<std::size_t>(found->count);
    segments.push_back(std::move(*found));
  }
  return segments;
}

std::vector<std::string> locked_by(const JointSegment& segment) {
  std::vector<std::string> locked;
  for (const auto& names : {kAlong, kAbout})
    for (int i = 0; i < 3; ++i)
      if (std::find(segment.keys.begin(), segment.keys.end(), names[i]) == segment.keys.end())
        locked.emplace_back(names[i]);
  return locked;
}

}  // namespace taut::model
