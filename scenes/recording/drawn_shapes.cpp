#include "scenes/recording/drawn_shapes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "scenes/files/shape_json.h"

namespace taut {
namespace {

/// Lists equal shapes once.
class ShapeList {
 public:
  explicit ShapeList(std::vector<Shape>& shapes) : shapes_(shapes) {}
  int index(const Shape& shape) {
    const auto [found, is_new] =
        index_of_.try_emplace(shape_to_json(shape).dump(), static_cast<int>(shapes_.size()));
    if (is_new) shapes_.push_back(shape);
    return found->second;
  }

 private:
  std::vector<Shape>& shapes_;
  std::unordered_map<std::string, int> index_of_;
};

Ellipsoid inertia_ellipsoid(const MassProperties& mass) {
  const Vec3& I = mass.principal_moments();
  Vec3 radii;
  for (int i = 0; i < 3; ++i)
    radii[i] = std::sqrt(std::max(0.0, 2.5 * (I[(i + 1) % 3] + I[(i + 2) % 3] - I[i]) / mass.mass()));
  return {radii.cwiseMax(radii.maxCoeff() / 50)};
}

}  // namespace

void collect_shapes(const Scene& scene, RecordingHeader& header) {
  const World& world = scene.world;
  ShapeList list(header.shapes);
  std::vector<char> is_drawn(world.body_count(), 0);
  const auto add = [&](BodyId body, const Shape& shape, const Pose& pose) {
    header.drawn.push_back({list.index(shape), body, pose});
  };
  for (const Drawing& drawing : scene.drawings) {
    add(drawing.body, drawing.shape.shape, drawing.shape.pose);
    is_drawn[drawing.body.index] = 1;
  }
  std::vector<char> has_shape = is_drawn;
  for (int s = 0; s < world.shape_count(); ++s) {
    const ShapeRecord& record = world.shape(ShapeId{s});
    if (is_drawn[record.body.index]) continue;
    add(record.body, *record.shape, record.pose);
    has_shape[record.body.index] = 1;
  }
  for (int b = 1; b < world.body_count(); ++b) {
    if (has_shape[b] || world.is_fixed(BodyId{b})) continue;
    const MassProperties& mass = world.mass_properties(BodyId{b});
    add(BodyId{b}, inertia_ellipsoid(mass), {mass.q_BP(), Vec3::Zero()});
  }
}

}  // namespace taut
