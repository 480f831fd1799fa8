#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "collision/contact_finder.h"
#include "tests/core/random_state.h"

namespace taut::testing {

/// Farthest point of a shape along d, written down once more, for oracles.
inline Vec3 support_point(const Shape& shape, const Vec3& d) {
  const double across = std::hypot(d.x(), d.y());
  const auto rim = [&](double r, double z) {  // any point of it where all are as far
    return across > 0 ? Vec3(r * d.x() / across, r * d.y() / across, z) : Vec3(r, 0, z);
  };
  const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->radius * d.normalized();
  if (const auto* s = std::get_if<Box>(&shape))
    return {sign(d.x()) * s->size.x() / 2, sign(d.y()) * s->size.y() / 2, sign(d.z()) * s->size.z() / 2};
  if (const auto* s = std::get_if<Capsule>(&shape))
    return Vec3(0, 0, sign(d.z()) * s->length / 2) + s->radius * d.normalized();
  if (const auto* s = std::get_if<Cylinder>(&shape)) return rim(s->radius, sign(d.z()) * s->length / 2);
  if (const auto* s = std::get_if<Ellipsoid>(&shape)) {
    const Vec3 scaled = s->radii.cwiseProduct(d);
    return s->radii.cwiseProduct(scaled.normalized());
  }
  if (const auto* s = std::get_if<Cone>(&shape)) {
    const Vec3 apex(0, 0, 0.75 * s->height), base = rim(s->radius, -0.25 * s->height);
    return d.dot(apex) > d.dot(base) ? apex : base;
  }
  const auto& points = std::get<ConvexHull>(shape).points;
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vec3& x, const Vec3& y) { return d.dot(x) < d.dot(y); });
}

/// A hull that is nowhere regular.
inline Shape odd_hull() {
  Random random(77);
  ConvexHull hull;
  for (int i = 0; i < 20; ++i) hull.points.push_back(0.3 * random.unit());
  return hull;
}

/// One of each convex shape, about a metre across or less.
inline std::vector<Shape> convex_shapes() {
  return {Sphere{0.3},         Box{Vec3(0.5, 0.7, 0.4)},        Capsule{0.15, 0.6},
          Cylinder{0.25, 0.5}, Ellipsoid{Vec3(0.2, 0.35, 0.5)}, Cone{0.3, 0.7},
          odd_hull()};
}

/// Two moving bodies with one shape each.
struct ShapePair {
  World world;
  BodyId A, B;
  ShapePair(const Shape& a, const Pose& X_A, const Shape& b, const Pose& X_B) {
    A = world.add_body({.name = "A", .pose = X_A});
    B = world.add_body({.name = "B", .pose = X_B});
    world.add_shape(A, a);
    world.add_shape(B, b);
  }
  std::vector<Contact> contacts(double margin = 0.01) const {
    ContactFinder finder({.margin = margin, .threads = 1});
    return finder.find(world);
  }
};

inline double least_gap(const std::vector<Contact>& contacts) {
  double least = 1e300;
  for (const Contact& c : contacts) least = std::min(least, c.gap);
  return least;
}

/// What must hold of every contact: p_WQ − p_WP = gap n, |n| = 1, features all different.
inline void expect_sound(const World& world, const std::vector<Contact>& contacts) {
  for (const Contact& c : contacts) {
    const Vec3 P = world.pose(c.A).point(c.p_AP), Q = world.pose(c.B).point(c.p_BQ);
    EXPECT_NEAR(c.normal.norm(), 1, 1e-14);
    // Points of round-off of a scene some metres across.
    EXPECT_LT((Q - P - c.gap * c.normal).norm(), 1e-13 * (1 + P.norm()));
    EXPECT_LT(c.a, c.b);
  }
  for (std::size_t i = 1; i < contacts.size(); ++i)
    if (contacts[i].a == contacts[i - 1].a && contacts[i].b == contacts[i - 1].b) {
      EXPECT_LT(contacts[i - 1].feature, contacts[i].feature);
    }
}

}  // namespace taut::testing
