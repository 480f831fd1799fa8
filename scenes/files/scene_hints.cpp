#include <numbers>

#include "scenes/files/pair_keys.h"
#include "scenes/support/format.h"

// What is possible in a scene file, and more often a slip of the hand.
namespace taut {
namespace {

/// A limit of more than two turns [rad]: degrees begin with 13 of them, and few mechanisms wind up so far.
constexpr double kManyTurns = 4 * std::numbers::pi;

/// A joint's point is far outside a body if it is so much farther from its surface than the body reaches from
/// its centre.  Less is common: a crank whose shape is its shaft, a door without its frame.
constexpr double kFarInReaches = 1.5;

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
  bool is_sphere;
};
std::vector<std::vector<Ball3>> balls_of_bodies(const Scene& scene) {
  std::vector<std::vector<Ball3>> balls(static_cast<std::size_t>(scene.world.body_count()));
  for (int s = 0; s < scene.world.shape_count(); ++s) {
    const ShapeRecord& shape = scene.world.shape(ShapeId{s});
    balls[shape.body.index].push_back({shape.pose.p, std::visit(ReachOfShape{}, *shape.shape),
                                       std::holds_alternative<Sphere>(*shape.shape)});
  }
  const std::vector<std::vector<Ball3>> colliding = balls;
  for (const Drawing& drawing : scene.drawings)
    if (colliding[drawing.body.index].empty())
      balls[drawing.body.index].push_back({drawing.shape.pose.p,
                                           std::visit(ReachOfShape{}, drawing.shape.shape),
                                           std::holds_alternative<Sphere>(drawing.shape.shape)});
  // A joint may be anywhere in the ground, whatever is drawn of it.
  balls[kGround.index].clear();
  return balls;
}

/// Distance of a point from the nearest of the balls [m], if it is far outside all of them; else 0.
double far_from(const std::vector<Ball3>& balls, const Vec3& p) {
  double distance = kUnlimited, reach = 0;
  for (const Ball3& ball : balls) {
    distance = std::min(distance, (p - ball.centre).norm() - ball.radius);
    reach = std::max(reach, ball.centre.norm() + ball.radius);
  }
  return !balls.empty() && distance > kFarInReaches * reach ? distance : 0;
}

/// Whether a body is drawn as a single ball: a bob, which hangs by a rod without mass as far away as it
/// likes.
bool is_bob(const std::vector<Ball3>& balls) { return balls.size() == 1 && balls[0].is_sphere; }

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

/// Points of joints that lie far outside all shapes of the bodies that have some.  What the ground, or a body
/// without shapes, holds may be anywhere.
void SceneReader::note_far_anchors() const {
  if (anchors_.empty() || !problems_.by_hand) return;
  const std::vector<std::vector<Ball3>> balls = balls_of_bodies(scene_);
  for (const FileAnchor& anchor : anchors_) {
    std::string outside;
    bool holds = false, bob = false;
    int shaped = 0;
    for (const auto& [body, p] : {std::pair{anchor.a, anchor.p_AP}, {anchor.b, anchor.p_BQ}}) {
      if (balls[body.index].empty()) continue;
      const double distance = far_from(balls[body.index], p);
      holds = holds || distance == 0;
      bob = bob || is_bob(balls[body.index]);
      outside += (shaped++ > 0 ? " and " : "") + format("%.3g m outside ", distance) +
                 quoted_list({scene_.world.name(body)});
    }
    if (shaped == 0 || holds || (shaped == 1 && bob)) continue;
    anchor.node.slip("has its anchor " + outside + "; points are in the world, unless \"frame\" is \"body\"");
  }
}

/// Bodies with a shape for their mass alone, where others collide.
void SceneReader::note_untouchable() const {
  if (untouchable_.empty() || scene_.world.shape_count() == 0 || !scene_.settings.contacts) return;
  const std::size_t others = untouchable_.size() - 1;
  const std::string so_do =
      others == 0 ? "" : format("; %zu more bod", others) + (others == 1 ? "y does" : "ies do") + " so";
  untouchable_.front().slip("has a shape for its mass alone and touches nothing: \"shapes\" collide, and " +
                            ("\"shapes\": [] says that it is meant" + so_do));
}

}  // namespace taut
