#include "solvers/system/free_parts.h"

#include <cstddef>

namespace taut {

void FreeParts::begin(const MassMatrix& mass) {
  sets_.reset(mass.size());
  parts_.clear();
}

void FreeParts::find(const MassMatrix& mass, std::span<const Pose> poses, std::span<const char> filtered) {
  parts_.clear();
  part_of_body_.assign(poses.size(), std::nullopt);
  part_of_set_.assign(poses.size(), std::nullopt);
  is_sought_.assign(poses.size(), false);
  for (int b = 0; b < mass.size(); ++b)
    if (!mass[b].fixed && filtered[b]) is_sought_[sets_.find(b)] = true;
  for (int b = 0; b < mass.size(); ++b)  // what is held has no motion of its own
    if (mass[b].fixed) is_sought_[sets_.find(b)] = false;
  for (int b = 0; b < mass.size(); ++b) {
    const int set = sets_.find(b);
    if (!is_sought_[set]) continue;
    std::optional<std::size_t>& part = part_of_set_[set];
    if (!part) {
      part = parts_.size();
      parts_.emplace_back();
    }
    part_of_body_[b] = part;
    parts_[*part].mass += mass.inertia(b).mass;
    parts_[*part].centre += mass.inertia(b).mass * poses[b].p;
  }
  for (Part& part : parts_) part.centre /= part.mass;
  for (int b = 0; b < mass.size(); ++b) {
    if (!part_of_body_[b]) continue;
    Part& part = parts_[*part_of_body_[b]];
    const Mat3 axes = mass.principal_axes(b, poses[b]);
    const Vec3 r = poses[b].p - part.centre;
    part.inertia += axes * mass.inertia(b).moments.asDiagonal() * axes.transpose() +
                    mass.inertia(b).mass * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  for (Part& part : parts_) part.factor.compute(part.inertia);
}

void FreeParts::measure(std::span<const Pose> poses, std::span<const Wrench> p) {
  for (Part& part : parts_) part.sum = {};
  for (std::size_t b = 0; b < poses.size(); ++b) {
    if (!part_of_body_[b]) continue;
    Part& part = parts_[*part_of_body_[b]];
    part.sum = part.sum + Wrench{p[b].torque + (poses[b].p - part.centre).cross(p[b].force), p[b].force};
  }
  for (Part& part : parts_) part.motion = {part.factor.solve(part.sum.torque), part.sum.force / part.mass};
}

/// p ← p + factor M R c.
void FreeParts::add(const MassMatrix& mass, std::span<const Pose> poses, double factor,
                    std::span<Wrench> p) const {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!part_of_body_[i]) continue;
    const int b = static_cast<int>(i);
    const Part& part = parts_[*part_of_body_[i]];
    const Vec3 w = factor * part.motion.w;
    const Vec3 v = factor * part.motion.v + w.cross(poses[i].p - part.centre);
    p[i] = p[i] + Wrench{mass.angular_momentum(b, poses[i], w), mass.inertia(b).mass * v};
  }
}

void FreeParts::take_out(const MassMatrix& mass, std::span<const Pose> poses, std::span<Wrench> p) {
  measure(poses, p);
  taken_.clear();
  for (const Part& part : parts_) taken_.push_back(part.motion);
  add(mass, poses, -1, p);
}

void FreeParts::put_back(const MassMatrix& mass, std::span<const Pose> poses, std::span<Wrench> p) {
  measure(poses, p);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    parts_[i].motion = {taken_[i].w - parts_[i].motion.w, taken_[i].v - parts_[i].motion.v};
  add(mass, poses, 1, p);
}

}  // namespace taut
