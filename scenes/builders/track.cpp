#include "scenes/builders/track.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace taut {
namespace {

using Vec2 = Eigen::Vector2d;

/// The first number in (low, high] that is not too low, by bisection to the last bit.
template <typename TooLow>
double least(double low, double high, TooLow&& too_low) {
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) return high;
    (too_low(middle) ? low : high) = middle;
  }
}

/// Arcs round circles and the straight lines between them, by arc length from the start of the first arc.
class Belt {
 public:
  Belt(const std::vector<TrackWheel>& wheels, double offset, double pitch) {
    const std::size_t count = wheels.size();
    for (const TrackWheel& wheel : wheels)
      arcs_.push_back({Vec2(wheel.x, wheel.z), std::hypot(wheel.radius + offset, pitch / 2), 0, 0, 0, 0});
    for (std::size_t i = 0; i < count; ++i) {
      Arc &from = arcs_[i], &to = arcs_[(i + 1) % count];
      const Vec2 d = to.centre - from.centre;
      // The outward normal n of the tangent: n·c + r is the same for both circles.
      from.last = std::atan2(d.y(), d.x()) - std::acos((from.radius - to.radius) / d.norm());
      to.first = from.last;
    }
    for (std::size_t i = 0; i < count; ++i) {
      Arc& arc = arcs_[i];
      while (arc.last < arc.first) arc.last += 2 * std::numbers::pi;
      arc.start = length_;
      length_ += arc.radius * (arc.last - arc.first);
      arc.end = length_;
      length_ += (arcs_[(i + 1) % count].at(arcs_[(i + 1) % count].first) - arc.at(arc.last)).norm();
    }
  }
  double length() const { return length_; }
  Vec2 at(double s) const {
    s = std::fmod(s, length_);
    std::size_t i = arcs_.size() - 1;
    while (i > 0 && s < arcs_[i].start) --i;
    const Arc& arc = arcs_[i];
    if (s <= arc.end) return arc.at(arc.first + (s - arc.start) / arc.radius);
    return arc.at(arc.last) + (s - arc.end) * Vec2(-std::sin(arc.last), std::cos(arc.last));
  }
  /// The next place at this distance in a straight line.
  double step(double s, double distance) const {
    const Vec2 here = at(s);
    return least(s + distance * (1 - 1e-12), s + 2 * distance,
                 [&](double end) { return (at(end) - here).norm() < distance; });
  }

 private:
  struct Arc {
    Vec2 centre;
    double radius, first, last;  ///< angles of the outward normal
    double start, end;           ///< arc lengths
    Vec2 at(double angle) const { return centre + radius * Vec2(std::cos(angle), std::sin(angle)); }
  };
  std::vector<Arc> arcs_;
  double length_ = 0;
};

/// Arc length that n chords of this pitch take, less the whole length.
double overlap(const std::vector<TrackWheel>& wheels, int links, double offset, double pitch) {
  const Belt belt(wheels, offset, pitch);
  double s = 0;
  for (int k = 0; k < links; ++k) s = belt.step(s, pitch);
  return s - belt.length();
}

}  // namespace

TrackPins lay_track(const std::vector<TrackWheel>& wheels, int links, double offset) {
  if (wheels.size() < 2) fail("track", "needs at least two wheels", wheels.size());
  if (links < 8) fail("track", "needs at least eight links", links);
  TrackPins track;
  track.pitch = least(0, 2 * Belt(wheels, offset, 0).length() / links,
                      [&](double pitch) { return overlap(wheels, links, offset, pitch) < 0; });
  const Belt belt(wheels, offset, track.pitch);
  double s = 0;
  for (int k = 0; k < links; ++k) {
    track.pin.push_back(belt.at(s));
    s = belt.step(s, track.pitch);
  }
  return track;
}

}  // namespace taut
