#include "scenes/import/scene_document.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/math/dense.h"
#include "scenes/files/shape_json.h"
#include "scenes/import/link_inertia.h"
#include "scenes/import/rigid_groups.h"

namespace taut::model {
namespace {

/// A scene has no two joints without a body between them.  Such a body takes this share of the mass of the
/// link behind it, at the point of the joint between both, where it moves as it would with the link, and so
/// changes nothing, unless the joint slides: then a smaller one, by which the mass that slides is less; and
/// this share of its inertia, which does not turn with the link, and so changes the motion by about as much.
constexpr double kShareOfMass = 1e-2, kShareOfSlidingMass = 1e-4, kShareOfInertia = 1e-3;
constexpr int kMostClasses = 32;

/// The motion of what is behind the first `count` axes of a link, whose parent moves; of the point that is at
/// the origin of the world.
Twist behind_axes(const Twist& parent, const Link& link, int count) {
  Twist motion = parent;
  const auto turn = [&](const LinkAxis& axis, const Vec3& w) {
    motion.w += w, motion.v += link.X_WL.point(axis.anchor).cross(w);
  };
  for (int k = 0; k < count; ++k) {
    const LinkAxis& axis = link.axes[k];
    const Vec3 along = link.X_WL.q * (axis.rate * axis.axis);
    if (axis.kind == LinkAxis::Kind::kBall)
      turn(axis, link.X_WL.q * axis.spin);
    else if (axis.kind == LinkAxis::Kind::kHinge)
      turn(axis, along);
    else if (axis.kind == LinkAxis::Kind::kSlide)
      motion.v += along;
  }
  return motion;
}

bool slides(const Link& link, const JointSegment& segment) {
  const auto first = link.axes.begin() + segment.first;
  return std::any_of(first, first + segment.count, [](const LinkAxis& axis) {
    return axis.kind == LinkAxis::Kind::kSlide || axis.kind == LinkAxis::Kind::kScrew;
  });
}

}  // namespace

SceneJson vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
SceneJson quaternion_json(const Quat& q) {
  const Quat unit = q.normalized();
  return {unit.w(), unit.x(), unit.y(), unit.z()};
}

std::string SceneDocument::unique(TakenNames& taken, const std::string& name, const std::string& fallback) {
  const std::string stem = name.empty() ? fallback : name;
  const auto [place, is_new] = taken.try_emplace(stem, 1);
  int& last = place->second;
  std::string result = stem;
  for (bool free = is_new; !free; free = taken.try_emplace(result, 1).second)
    result = stem + '_' + std::to_string(++last);
  return result;
}

SceneJson SceneDocument::write() {
  SceneJson document{{"format", "taut-scene/1"}};
  if (!model_.name.empty()) document["name"] = model_.name;
  document["gravity"] = vector_json(model_.gravity);
  document["dt"] = model_.dt;
  if (!model_.contacts) document["settings"] = {{"contacts", false}};
  name_bodies();
  gather_motions();
  gather_surfaces();
  gather_classes();
  write_materials(document);
  if (!model_.ground_shapes.empty())
    document["ground"] = {{"shapes", shapes_json(model_.ground_shapes, Vec3::Zero())}};
  write_bodies(document);
  write_joints(document);
  write_pairs(document);
  write_probes(document);
  if (open_) document["assemble"] = true;
  return document;
}

/// Impulses that hold a point at a distance are as much larger than those that turn it as (distance/ρ)².
void SceneDocument::note_points_on_levers(const Link& link, const std::string& name) {
  constexpr double kNearlyAPoint = 1e7;  // of that, where 16 digits leave 9 of the smaller ones
  const double least = dense::symmetric_eigenvalues3(link.inertia.inertia).minCoeff() / link.inertia.mass;
  for (const LinkAxis& axis : link.axes) {
    if (axis.kind == LinkAxis::Kind::kSlide) continue;
    const Vec3 arm = link.inertia.centre - axis.anchor;
    const double d = axis.kind == LinkAxis::Kind::kBall ? arm.norm() : arm.cross(axis.axis).norm();
    if (!(d * d > kNearlyAPoint * least)) continue;
    std::ostringstream message;
    message.precision(3);
    message << '"' << name << "\" is nearly a point (value: " << std::sqrt(least) << " m across, " << d
            << " m from its axis \"" << axis.name
            << "\"): what holds it there is found to few digits, and steps may not converge";
    note(axis.place, message.str());
  }
}

void SceneDocument::name_bodies() {
  for (const Link& link : model_.links) {
    bodies_.push_back(unique(body_names_, link.name, "link"));
    if (!link.name.empty() && bodies_.back() != link.name)
      note(link.place,
           "\"" + link.name + "\" is the name of another body: it is called \"" + bodies_.back() + "\"");
    segments_.push_back(joint_segments(link));
    if (is_solid(link.inertia)) note_points_on_levers(link, bodies_.back());
  }
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    between_.emplace_back();
    for (std::size_t k = 1; k < segments_[i].size(); ++k)
      between_[i].push_back(unique(body_names_, bodies_[i] + "_" + std::to_string(k), ""));
    if (!between_[i].empty())
      note(model_.links[i].place,
           "\"" + bodies_[i] +
               "\" has axes that no single joint has: 1e-2 of its mass, of what slides "
               "1e-4, and 1e-3 of its inertia are a body between them");
  }
}

/// As rates of axes and velocities of free links say.  A parent may stand behind what hangs on it, where
/// links have become one.
void SceneDocument::gather_motions() {
  const int count = static_cast<int>(model_.links.size());
  motions_.resize(count);
  std::vector<bool> known(count, false);
  for (int i = 0; i < count; ++i) {
    std::vector<int> way;  // from the link to one that is known
    for (int k = i; k != kWorld && !known[k]; k = model_.links[k].free ? kWorld : model_.links[k].parent)
      way.push_back(k);
    for (; !way.empty(); way.pop_back()) {
      const Link& link = model_.links[way.back()];
      motions_[way.back()] = link.free
                                 ? Twist{link.free_twist.w, link.free_twist.at(-link.X_WL.p)}
                                 : behind_axes(motion(link.parent), link, static_cast<int>(link.axes.size()));
      known[way.back()] = true;
    }
  }
}

void SceneDocument::gather_surfaces() {
  const auto add = [&](const std::vector<LinkShape>& shapes) {
    for (const LinkShape& shape : shapes)
      surfaces_.try_emplace(shape.surface, "surface_" + std::to_string(surfaces_.size() + 1));
  };
  add(model_.ground_shapes);
  for (const Link& link : model_.links) add(link.shapes);
}

void SceneDocument::gather_classes() {
  const auto add = [&](const LinkShape& shape, const ModelPlace& place) {
    classes_.try_emplace(shape.touches, static_cast<int>(classes_.size()));
    if (classes_.size() > kMostClasses)
      throw ImportError(place, "more than 32 kinds of shapes that touch different others");
  };
  for (const LinkShape& shape : model_.ground_shapes) add(shape, {});
  for (const Link& link : model_.links)
    for (const LinkShape& shape : link.shapes) add(shape, link.place);
}

/// The classes that touch this one, as bits.
std::uint32_t SceneDocument::partners(int contact_class) const {
  TouchKind mine;
  for (const auto& [kind, index] : classes_)
    if (index == contact_class) mine = kind;
  std::uint32_t result = 0;
  for (const auto& [kind, index] : classes_)
    if (touch(mine, kind)) result |= std::uint32_t{1} << index;
  return result;
}

/// Materials by surface, and what holds between two of them.
void SceneDocument::write_materials(SceneJson& document) const {
  if (surfaces_.empty()) return;
  const auto both = [&](const Surface& a, const Surface& b) {
    const auto own = model_.pair_surfaces.find(std::minmax(a.number, b.number));
    const Surface s = own == model_.pair_surfaces.end() ? larger_of(a, b) : own->second;
    SceneJson json{{"static_friction", s.directions < 3 ? 0 : s.sliding},
                   {"dynamic_friction", s.directions < 3 ? 0 : s.sliding}};
    if (s.directions >= 4 && s.spinning > 0) json["spinning_friction"] = s.spinning;
    if (s.directions >= 6 && s.rolling > 0) json["rolling_friction"] = s.rolling;
    return json;
  };
  for (const auto& [surface, name] : surfaces_) document["materials"][name] = both(surface, surface);
  for (auto a = surfaces_.begin(); a != surfaces_.end(); ++a)
    for (auto b = std::next(a); b != surfaces_.end(); ++b) {
      const SceneJson material = both(a->first, b->first);  // of equals it is theirs without being said
      if (material != document["materials"][a->second] || material != document["materials"][b->second])
        document["material_pairs"].push_back({{"a", a->second}, {"b", b->second}, {"material", material}});
    }
}

SceneJson SceneDocument::shapes_json(const std::vector<LinkShape>& shapes, const Vec3& centre) const {
  SceneJson list = SceneJson::array();
  const auto bits = [](std::uint32_t set) {
    SceneJson json = SceneJson::array();
    for (int i = 0; i < kMostClasses; ++i)
      if (set >> i & 1) json.push_back(i);
    return json;
  };
  for (const LinkShape& shape : shapes) {
    SceneJson json(shape_to_json(shape.shape));
    if (const Vec3 p = shape.X_LS.p - centre; !p.isZero(0)) json["position"] = vector_json(p);
    if (!shape.X_LS.q.vec().isZero(0)) json["orientation"] = quaternion_json(shape.X_LS.q);
    json["material"] = surfaces_.at(shape.surface);
    const int index = classes_.at(shape.touches);
    if (classes_.size() > 1 || partners(index) == 0) {
      json["groups"] = SceneJson::array({index});
      json["collides_with"] = bits(partners(index));
    }
    list.push_back(std::move(json));
  }
  return list;
}

SceneJson SceneDocument::body_json(const std::string& name, const Link& link, const LinkInertia& inertia,
                                   const Twist& motion) const {
  SceneJson json{{"name", name}};
  const Mat3& I = inertia.inertia;
  if (is_solid(inertia)) {
    json["mass"] = inertia.mass;
    json["inertia"] = {vector_json(I.row(0)), vector_json(I.row(1)), vector_json(I.row(2))};
  }
  json["position"] = vector_json(link.X_WL.point(inertia.centre));
  if (!link.X_WL.q.vec().isZero(0)) json["orientation"] = quaternion_json(link.X_WL.q);
  if (const Vec3 v = motion.at(link.X_WL.point(inertia.centre)); !v.isZero(0))
    json["velocity"] = vector_json(v);
  if (!motion.w.isZero(0)) json["angular_velocity"] = vector_json(motion.w);
  return json;
}

std::vector<LinkInertia> SceneDocument::shares_between(std::size_t i) const {
  const Link& link = model_.links[i];
  std::vector<LinkInertia> shares;
  for (std::size_t k = 1; k < segments_[i].size(); ++k) {
    const double share = slides(link, segments_[i][k]) ? kShareOfSlidingMass : kShareOfMass;
    shares.push_back({share * link.inertia.mass, link.X_WL.local(segments_[i][k].anchor),
                      kShareOfInertia * link.inertia.inertia});
  }
  return shares;
}

void SceneDocument::write_bodies(SceneJson& document) {
  SceneJson& bodies = document["bodies"] = SceneJson::array();
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    Link& link = model_.links[i];
    std::vector<LinkInertia> shares = shares_between(i);
    LinkInertia rest = link.inertia;
    for (const LinkInertia& share : shares) rest = difference(rest, share);
    if (!is_solid(rest) && !shares.empty()) {  // the joint is too far away
      for (LinkInertia& share : shares) share = scaled(link.inertia, kShareOfInertia);
      rest = scaled(link.inertia, 1 - kShareOfInertia * static_cast<double>(shares.size()));
    }
    link.inertia = rest;
    for (std::size_t k = 0; k < shares.size(); ++k)
      bodies.push_back(body_json(between_[i][k], link, shares[k],
                                 behind_axes(motion(link.parent), link, segments_[i][k + 1].first)));
    SceneJson json = body_json(bodies_[i], link, link.inertia, motion(static_cast<int>(i)));
    if (stands_still(model_, static_cast<int>(i))) json["fixed"] = true;
    if (!link.shapes.empty()) json["shapes"] = shapes_json(link.shapes, link.inertia.centre);
    bodies.push_back(std::move(json));
  }
}

}  // namespace taut::model
