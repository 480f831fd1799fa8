#include <numbers>

#include "scenes/files/pair_keys.h"
#include "scenes/support/format.h"

// What is possible in a scene file, and more often a slip of the hand.
namespace taut {
namespace {

/// A limit of more than two turns [rad]: degrees begin with 13 of them, and few mechanisms wind up so far.
constexpr double kManyTurns = 4 * std::numbers::pi;

/// Radius of a ball about the origin of the shape that holds it [m].
struct ReachOfShape {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Box& s) const { return s.size.norm() / 2; }
  double operator()(const Capsule& s) const { return s.radius + s.length / 2; }
  double operator()(const Cylinder& s) const { return std::hypot(s.radius, s.length / 2); }
  double operator()(const Ellipsoid& s) const { return s.radii.maxCoeff(); }
  double operator()(const Cone& s) const { return std::hypot(s.radius, s.height); }
  double operator()(const ConvexHull& s) const { return farthest(s.points); }
  double operator()(const TriangleMesh& s) const { return farthest(s.vertices); }
  double operator()(const HalfSpace&) const { return kUnlimited; }
  double operator()(const HeightField&) const { return kUnlimited; }
  static double farthest(const std::vector<Vec3>& points) {
    double reach = 0;
    for (const Vec3& p : points) reach = std::max(reach, p.norm());
    return reach;
  }
};

/// The balls around the shapes of each body, in its axes; those that are drawn if none collides.
struct Ball3 {
  Vec3 centre;
  double radius;
};
std::vector<std::vector<Ball3>> balls_of_bodies(const Scene& scene) {
  std::vector<std::vector<Ball3>> balls(static_cast<std::size_t>(scene.world.body_count()));
  for (int s = 0; s < scene.world.shape_count(); ++s) {
    const ShapeRecord& shape = scene.world.shape(ShapeId{s});
    balls[shape.body.index].push_back({shape.pose.p, std::visit(ReachOfShape{}, *shape.shape)});
  }
  const std::vector<std::vector<Ball3>> colliding = balls;
  for (const Drawing& drawing : scene.drawings)
    if (colliding[drawing.body.index].empty())
      balls[drawing.body.index].push_back(
          {drawing.shape.pose.p, std::visit(ReachOfShape{}, drawing.shape.shape)});
  return balls;
}

/// Distance of a point from the nearest of the balls [m], if it is larger than all of them across; else 0.
double far_from(const std::vector<Ball3>& balls, const Vec3& p) {
  double distance = kUnlimited, size = 0;
  for (const Ball3& ball : balls) {
    distance = std::min(distance, (p - ball.centre).norm() - ball.radius);
    size = std::max(size, 2 * (ball.centre.norm() + ball.radius));
  }
  return !balls.empty() && distance > size ? distance : 0;
}

}  // namespace

/// Limits, and the rest of a spring, of many turns.
void SceneReader::note_many_turns(JsonObject& axis) const {
  for (const auto& [property, keys] :
       {std::pair{"limits", std::vector{"lower", "upper"}}, {"spring", {"rest"}}}) {
    const auto node = axis.find(property);
    if (!node || !node->json().is_object()) continue;
    for (const char* key : keys) {
      const auto value = node->json().find(key);
      if (value == node->json().end() || !value->is_number()) continue;
      const double angle = value->get<double>();
      if (std::abs(angle) > kManyTurns)
        JsonNode(*value, child_path(node->path(), key), problems_)
            .slip(format("is %.3g turns, since it is in radians; if degrees are meant, write \"%s_deg\"",
                         std::abs(angle) / (2 * std::numbers::pi), key));
    }
  }
}

/// Points of joints that lie far outside the shapes of both bodies.  What the ground, or a body without
/// shapes, holds may be anywhere.
void SceneReader::note_far_anchors() const {
  if (anchors_.empty() || !problems_.by_hand) return;
  const std::vector<std::vector<Ball3>> balls = balls_of_bodies(scene_);
  for (const FileAnchor& anchor : anchors_) {
    const double from_a = far_from(balls[anchor.a.index], anchor.p_AP);
    const double from_b = far_from(balls[anchor.b.index], anchor.p_BQ);
    if (from_a == 0 || from_b == 0) continue;
    const auto name = [&](BodyId body) { return quoted_list({scene_.world.name(body)}); };
    anchor.node.slip(format("has its anchor %.3g m outside ", from_a) + name(anchor.a) +
                     format(" and %.3g m outside ", from_b) + name(anchor.b) +
                     "; points are in the world, unless \"frame\" is \"body\"");
  }
}

}  // namespace taut
