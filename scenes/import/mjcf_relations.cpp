#include "scenes/import/mjcf_relations.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "scenes/import/link_inertia.h"

namespace taut::model {
namespace {

constexpr const char* kIdleTendon = "a tendon that neither limits nor pulls by itself: left out";

/// Thrown where something names what a part without counterpart would have defined, or has several copies.
struct NotThere {
  std::string name;
};

/// The entry of a name that an attribute gives.
template <typename Value>
Value named(const MjcfElement& element, const std::map<std::string, Value>& entries, const char* attribute,
            const MjcfNames& names) {
  const std::string name = element.files().required(element.node(), attribute);
  const auto found = entries.find(name);
  if (found != entries.end()) return found->second;
  if (names.lacks_some || names.copied.contains(name)) throw NotThere{name};
  element.fail(std::string("\"") + attribute + "\" names nothing that is there" + near_name(name, entries) +
               " (value: " + name + ")");
}

/// From the one end to a body that both branches have a site of, and on from there to the other end.
std::optional<std::vector<LinkFrame>> points_of_pulley(const std::vector<LinkFrame>& p) {
  for (const bool turn_first : {false, true})
    for (const bool turn_second : {false, true}) {
      const LinkFrame &c1 = p[turn_first ? 0 : 1], &c2 = p[turn_second ? 3 : 2];
      const LinkFrame &a = p[turn_first ? 1 : 0], &b = p[turn_second ? 2 : 3];
      if (c1.link == c2.link && a.link != b.link && a.link != c1.link && b.link != c1.link)
        return std::vector<LinkFrame>{a, c1, c2, b};
    }
  return {};
}

/// Of all joints, as a <key> has them: of a free one position and quaternion, of a ball a quaternion.
std::vector<double> start_coordinates(const RobotModel& model) {
  std::vector<double> q;
  for (const Link& link : model.links) {
    if (link.free)
      q.insert(q.end(), {link.X_WL.p.x(), link.X_WL.p.y(), link.X_WL.p.z(), link.X_WL.q.w(), link.X_WL.q.x(),
                         link.X_WL.q.y(), link.X_WL.q.z()});
    for (const LinkAxis& axis : link.axes)
      if (axis.kind == LinkAxis::Kind::kBall)
        q.insert(q.end(), {1, 0, 0, 0});
      else
        q.push_back(axis.start);
  }
  return q;
}

}  // namespace

int MjcfRelations::body(const MjcfElement& e, const char* attribute) const {
  return named(e, names_.bodies, attribute, names_);
}
LinkFrame MjcfRelations::site(const MjcfElement& e, const char* attribute) const {
  return named(e, names_.sites, attribute, names_);
}
AxisName MjcfRelations::joint(const MjcfElement& e, const char* attribute) const {
  const std::string name = e.text(attribute);
  if (names_.free_joints.contains(name)) throw NotThere{name};
  return named(e, names_.joints, attribute, names_);
}

void MjcfRelations::read(const pugi::xml_node& mujoco) {
  const auto each = [&](const char* section, void (MjcfRelations::*read_one)(const pugi::xml_node&)) {
    for (const pugi::xml_node& part : files_.children(mujoco, section))
      for (const pugi::xml_node& node : files_.children(part)) try {
          files_.attempt([&] { (this->*read_one)(node); });
        } catch (const NotThere& missing) {
          leave_out(MjcfElement(files_, node), std::string("<") + node.name() + "> names \"" + missing.name +
                                                   "\", which has no counterpart, or several: left out");
        }
  };
  files_.know_children("tendon", {"spatial", "fixed"});
  files_.know_children("equality", {"connect", "weld", "joint", "tendon", "flex", "flexvert"});
  files_.know_children("contact", {"pair", "exclude"});
  files_.know_children("spatial", {"site", "geom", "pulley"});
  each("contact", &MjcfRelations::read_contact);
  each("tendon", &MjcfRelations::read_tendon);
  each("equality", &MjcfRelations::read_equality);
  for (const auto& [name, place] : idle_) model_.notices.push_back({place, kIdleTendon, 1});
  files_.attempt([&] { read_key(mujoco); });
  each("actuator", &MjcfRelations::read_actuator);
  each("sensor", &MjcfRelations::read_sensor);
}

void MjcfRelations::read_contact(const pugi::xml_node& node) {
  const MjcfElement element = defaults_.element(node, "");
  const std::string_view kind = node.name();
  if (kind == "exclude") {
    element.find("name");
    model_.pairs.push_back({body(element, "body1"), body(element, "body2"), false});
  } else if (kind == "pair") {
    element.find("name");
    const auto geom = [&](const char* key) { return named(element, names_.geoms, key, names_); };
    const GeomPlace a = geom("geom1"), b = geom("geom2");
    const int number = static_cast<int>(model_.pairs.size());
    model_.pairs.push_back({a.link, b.link, true});
    if (a.shape < 0 || b.shape < 0) return;  // said where the shape was left out
    // Pairs with one first share its number: there are few kinds of shapes.
    std::set<int>& first_of = model_.shapes_of(a.link)[a.shape].touches.first_of;
    if (first_of.empty()) first_of.insert(number);
    LinkShape &first = model_.shapes_of(a.link)[a.shape], &second = model_.shapes_of(b.link)[b.shape];
    second.touches.second_of.insert(*first_of.begin());
    give_surface(element, first.surface, second.surface);
    if (model_.are_next(a.link, b.link))
      note(element,
           "<pair> of geoms: other geoms of their bodies may touch, too, as far as contype and "
           "conaffinity let them");
  }
}

/// Sliding along two directions, spinning, and rolling about two: those of the pair, or MuJoCo's own,
/// whatever the geoms have.
void MjcfRelations::give_surface(const MjcfElement& pair, Surface& a, Surface& b) {
  Surface both{3, 1, 0.005, 0.0001};
  both.directions = static_cast<int>(pair.number("condim", both.directions));
  const auto f = pair.numbers("friction");
  const auto coefficient = [&](std::size_t i, double& value) {
    if (i < f.size()) value = not_negative(files_, pair.node(), "friction", f[i]);
  };
  coefficient(0, both.sliding), coefficient(2, both.spinning), coefficient(3, both.rolling);
  if ((f.size() > 1 && f[0] != f[1]) || (f.size() > 4 && f[3] != f[4]))
    note(pair, "\"friction\" of <pair> that differs by direction: the first number is taken");
  if (both == larger_of(a, b) && a.number == 0 && b.number == 0) return;
  for (Surface* surface : {&a, &b})
    if (surface->number == 0) surface->number = ++model_.numbered_surfaces;
  model_.pair_surfaces[std::minmax(a.number, b.number)] = both;
}

void MjcfRelations::read_equality(const pugi::xml_node& node) {
  const std::string_view kind = node.name();
  if (kind == "tendon") return read_tendon_equality(node);
  if (kind != "connect" && kind != "weld" && kind != "joint") return;
  files_.accept(node);
  const MjcfElement element(files_, node);
  if (kind == "joint") return read_joint_equality(element);
  Loop loop;
  loop.name = name_of(element);
  loop.place = element.place();
  loop.active = element.flag("active", true);
  if (element.find("site1")) {
    loop.a = site(element, "site1");
    loop.b = site(element, "site2");
    loop.fixed = kind == "weld";
    model_.loops.push_back(std::move(loop));
    return;
  }
  loop.a.link = body(element, "body1");
  if (element.find("body2")) loop.b.link = body(element, "body2");
  kind == "connect" ? read_connect(element, std::move(loop)) : read_weld(element, std::move(loop));
}

/// The anchor is a point of the first body; the second one has it where it is at the start.
void MjcfRelations::read_connect(const MjcfElement& connect, Loop loop) {
  files_.required(connect.node(), "anchor");
  loop.a.X_LF.p = connect.vector("anchor", Vec3::Zero());
  loop.b.X_LF = inverse(pose(loop.b.link)) * pose(loop.a.link) * loop.a.X_LF;
  model_.loops.push_back(std::move(loop));
}

/// `relpose` is the pose of the second body in the first; as at the start if its quaternion is 0 or missing.
void MjcfRelations::read_weld(const MjcfElement& weld, Loop loop) {
  loop.fixed = true;
  const auto v = weld.numbers("relpose", {0, 1, 0, 0, 0, 0, 0});
  const Quat q(v[3], v[4], v[5], v[6]);
  Pose X_12 = inverse(pose(loop.a.link)) * pose(loop.b.link);
  if (q.norm() > 1e-12) X_12 = {q.normalized(), Vec3(v[0], v[1], v[2])};
  weld.find("anchor");  // of a rigid joint all points do
  loop.a.X_LF = X_12;
  model_.loops.push_back(std::move(loop));
}

void MjcfRelations::read_joint_equality(const MjcfElement& equality) {
  AxisRelation relation;
  relation.name = name_of(equality);
  relation.place = equality.place();
  relation.active = equality.flag("active", true);
  relation.driven = joint(equality, "joint1");
  const auto poly = equality.numbers("polycoef", {0, 1, 0, 0, 0});
  if (equality.find("joint2")) {
    relation.driving = joint(equality, "joint2");
    relation.ratio = poly[1];
    if (poly[2] != 0 || poly[3] != 0 || poly[4] != 0 || poly[1] == 0)
      return leave_out(equality, "a relation of joints that is not linear: has no counterpart");
    if (poly[0] != 0)
      note(equality, "\"polycoef\": the relation holds as at the start, without its constant");
  } else {
    relation.value = axis(relation.driven).start + poly[0];
  }
  model_.relations.push_back(std::move(relation));
}

/// Σ c q of the first tendon − factor Σ c q of the second, if there is one, by joint in their order.
std::vector<MjcfRelations::FixedPart> MjcfRelations::sum_of(const std::string& first,
                                                            const std::string& second, double factor) const {
  std::vector<FixedPart> sum;
  const auto add = [&](const std::string& tendon, double scale) {
    for (const FixedPart& part : fixed_.at(tendon)) {
      const auto same = std::ranges::find_if(sum, [&](const FixedPart& s) { return s.axis == part.axis; });
      if (same == sum.end())
        sum.push_back({part.axis, scale * part.coef});
      else
        same->coef += scale * part.coef;
    }
  };
  add(first, 1);
  if (!second.empty()) add(second, -factor);
  std::erase_if(sum, [](const FixedPart& part) { return part.coef == 0; });
  return sum;
}

/// The length of a wire; or the sum of joints of a tendon is a linear function of that of another, or stays
/// as it is.
void MjcfRelations::read_tendon_equality(const pugi::xml_node& node) {
  files_.accept(node);
  const MjcfElement equality(files_, node);
  const std::string first = equality.text("tendon1"), second = equality.text("tendon2");
  if (const auto wire = spatial_.find(first); wire != spatial_.end() && second.empty())
    return read_bar(equality, wire->second);
  for (const std::string& name : {first, second})
    if (!name.empty() && !fixed_.contains(name))
      return leave_out(equality, "<tendon> \"" + name + "\", which is no sum of joints: has no counterpart");
  if (first.empty()) return leave_out(equality, "<tendon> without \"tendon1\": left out");
  const auto poly = equality.numbers("polycoef", {0, 1, 0, 0, 0});
  if (!second.empty() && std::any_of(poly.begin() + 2, poly.end(), [](double c) { return c != 0; }))
    return leave_out(equality, "a relation of tendons that is not linear: has no counterpart");
  relate(equality, sum_of(first, second, poly[1]), poly[0]);
}

/// Of one joint it is a value, of two a gear, of three a differential.
void MjcfRelations::relate(const MjcfElement& equality, const std::vector<FixedPart>& sum, double constant) {
  AxisRelation relation;
  relation.name = name_of(equality);
  relation.place = equality.place();
  relation.active = equality.flag("active", true);
  if (sum.empty() || sum.size() > 3 || (sum.size() == 3 && !is_differential(sum, relation)))
    return leave_out(equality, "a relation of " + std::to_string(sum.size()) +
                                   " joints that is no gear and no differential: has no counterpart");
  if (sum.size() < 3) relation.driven = sum[0].axis;
  if (sum.size() == 2) relation.driving = sum[1].axis, relation.ratio = -sum[1].coef / sum[0].coef;
  if (sum.size() == 1) relation.value = axis(relation.driven).start + constant / sum[0].coef;
  if (sum.size() > 1 && constant != 0)
    note(equality, "\"polycoef\": the relation holds as at the start, without its constant");
  model_.relations.push_back(std::move(relation));
}

/// a + b − 2 c of three hinges, or a multiple.
bool MjcfRelations::is_differential(const std::vector<FixedPart>& sum, AxisRelation& relation) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const FixedPart &in = sum[k], &left = sum[(k + 1) % 3], &right = sum[(k + 2) % 3];
    if (left.coef != right.coef || in.coef != -2 * left.coef) continue;
    for (const FixedPart& part : sum)
      if (model_.links[part.axis.link].axes[part.axis.axis].kind != LinkAxis::Kind::kHinge) return false;
    relation.driven = in.axis;
    relation.driving = left.axis;
    relation.other = right.axis;
    return true;
  }
  return false;
}

/// A wire between two sites, or over a pulley, that stays as long as it is.
void MjcfRelations::read_bar(const MjcfElement& equality, Wire bar) {
  idle_.erase(bar.name);
  if ((bar.points.size() > 2 && !bar.pulley) || equality.numbers("polycoef", {0, 1, 0, 0, 0})[0] != 0)
    return leave_out(equality,
                     "a wire whose length is given, over several sites or other than at the start: "
                     "has no counterpart");
  bar.bar = length_of(bar);
  bar.bar_active = equality.flag("active", true);
  if (const std::string name = name_of(equality); !name.empty()) bar.name = name;
  bar.place = equality.place();
  bar.longest = kNoLimit;
  bar.stiffness = bar.damping = 0;
  model_.wires.push_back(std::move(bar));
}

/// Of hinges and slides: what refers to it can act on these.
bool MjcfRelations::read_fixed(const MjcfElement& tendon) {
  std::vector<FixedPart> parts;
  for (const pugi::xml_node& node : files_.children(tendon.node(), "joint")) {
    const MjcfElement part(files_, node);
    parts.push_back({joint(part, "joint"), part.number("coef", 1)});
    if (parts.back().coef == 0 || axis(parts.back().axis).kind == LinkAxis::Kind::kBall) return false;
  }
  if (parts.empty()) return false;
  act_by_itself(tendon, parts);
  if (const std::string name = tendon.text("name"); !name.empty()) fixed_[name] = std::move(parts);
  return true;
}

/// Range, spring, damper and friction of a tendon: where it is c q of one joint they are those of the joint.
void MjcfRelations::act_by_itself(const MjcfElement& tendon, const std::vector<FixedPart>& parts) {
  const auto range = tendon.range("range", "limited", compiler_);
  const auto first = [&](const char* key) {
    const std::vector<double> found = tendon.numbers(key);
    if (found.size() > 1)
      note(tendon, std::string("\"") + key + "\" that is no constant: its first number is taken");
    return found.empty() ? 0.0 : not_negative(files_, tendon.node(), key, found[0]);
  };
  const double stiffness = first("stiffness"), damping = first("damping"), friction = first("frictionloss");
  if (parts.size() > 1) {
    if (range || stiffness > 0 || damping > 0 || friction > 0)
      note(tendon,
           "<fixed> of several joints: range, stiffness, damping and frictionloss of their sum have no "
           "counterpart");
    return;
  }
  const double c = parts[0].coef;
  AxisLaw& law = axis(parts[0].axis).law;
  if (range) {
    const auto [low, high] = std::minmax({range->first / c, range->second / c});
    law.lower = std::max(law.lower, low), law.upper = std::min(law.upper, high);
    if (law.lower > law.upper) tendon.fail("\"range\" and that of the joint exclude each other");
  }
  law.damping += c * c * damping;
  law.friction += std::abs(c) * friction;
  if (stiffness == 0) return;
  // At rest where the joint's own spring is, unless it says so; two springs are one between both.
  const auto length = tendon.numbers("springlength");
  if (length.size() > 1 && length[0] != length[1])
    note(tendon, "\"springlength\" of two numbers: the first is taken");
  const double added = c * c * stiffness, rest = length.empty() || length[0] < 0 ? law.rest : length[0] / c;
  law.rest = (law.stiffness * law.rest + added * rest) / (law.stiffness + added);
  law.stiffness += added;
}

void MjcfRelations::read_tendon(const pugi::xml_node& node) {
  files_.accept(node);
  const std::string_view kind = node.name();
  if (kind == "spatial")
    read_spatial(defaults_.element(node, ""));
  else if (kind == "fixed" && read_fixed(defaults_.element(node, "")))
    return;
  else
    leave_out(MjcfElement(files_, node),
              "<" + std::string(node.name()) + ">: this tendon has no counterpart");
}

/// A wire through sites.  What it wraps around has no counterpart.
void MjcfRelations::read_spatial(const MjcfElement& tendon) {
  Wire wire;
  wire.name = name_of(tendon);
  wire.place = tendon.place();
  std::vector<double> divisors;     // of branches
  std::vector<std::size_t> firsts;  // points that these begin with
  for (const pugi::xml_node& point : files_.children(tendon.node())) {
    files_.accept(point);
    const std::string_view kind = point.name();
    if (kind == "pulley") {
      divisors.push_back(positive(files_, point, "divisor", MjcfElement(files_, point).number("divisor", 1)));
      firsts.push_back(wire.points.size());
      continue;
    }
    if (kind != "site")
      return leave_out(tendon, "a tendon with <" + std::string(kind) + ">: has no counterpart");
    wire.points.push_back(site(MjcfElement(files_, point), "site"));
  }
  if (wire.points.size() < 2) tendon.fail("a tendon needs two sites");
  if (!divisors.empty()) return read_pulley(tendon, std::move(wire), divisors, firsts);
  const auto range = tendon.numbers("range", {0, 0});
  if (tendon.flag("limited", compiler_.autolimits && (range[0] != 0 || range[1] != 0))) {
    wire.longest = positive(files_, tendon.node(), "range", range[1]);
    if (range[0] > 0) note(tendon, "the least length of a tendon: has no counterpart");
  }
  read_spring(tendon, wire);
  if (const std::string name = tendon.text("name"); !name.empty()) spatial_[name] = wire;
  if (wire.longest < kNoLimit || wire.stiffness > 0 || wire.damping > 0)
    return model_.wires.push_back(std::move(wire));
  if (wire.name.empty()) return leave_out(tendon, kIdleTendon);
  files_.accept_all(tendon.node());
  idle_[wire.name] = wire.place;
}

/// Two branches, l₁/d₁ + l₂/d₂, over two sites of one body.  Only where an equality keeps it as long as it is
/// has it a counterpart: the wire of a pulley, l₁ + d₁/d₂ l₂, with the branches from and to this body.
void MjcfRelations::read_pulley(const MjcfElement& tendon, Wire wire, const std::vector<double>& divisors,
                                const std::vector<std::size_t>& firsts) {
  const bool divided_from_start = firsts[0] == 0;
  const std::size_t branches = firsts.size() + (divided_from_start ? 0 : 1);
  const bool two_by_two = branches == 2 && wire.points.size() == 4 && firsts.back() == 2;
  if (!two_by_two)
    return leave_out(tendon,
                     "a tendon with <pulley> that is not two branches of two sites each: has no counterpart");
  wire.pulley = true;
  wire.ratio = (divided_from_start ? divisors[0] : 1) / divisors.back();
  const auto points = points_of_pulley(wire.points);
  if (!points)
    return leave_out(tendon,
                     "a tendon with <pulley> whose branches do not meet at one body and end at two others: "
                     "has no counterpart");
  wire.points = *points;
  bool acts = false;
  for (const char* key : {"range", "stiffness", "damping"}) acts = tendon.find(key) || acts;
  if (acts) note(tendon, "a tendon with <pulley>: its range, stiffness and damping have no counterpart");
  if (wire.name.empty()) return leave_out(tendon, kIdleTendon);
  spatial_[tendon.text("name")] = wire;
  idle_[wire.name] = wire.place;
}

double MjcfRelations::length_of(const Wire& wire) const {
  const auto at = [&](const LinkFrame& point) { return pose(point.link).point(point.X_LF.p); };
  double length = 0;
  if (wire.pulley)
    return (at(wire.points[1]) - at(wire.points[0])).norm() +
           wire.ratio * (at(wire.points[3]) - at(wire.points[2])).norm();
  for (std::size_t k = 1; k < wire.points.size(); ++k)
    length += (at(wire.points[k]) - at(wire.points[k - 1])).norm();
  return length;
}

/// At rest at the length that it starts with, unless it says so.
void MjcfRelations::read_spring(const MjcfElement& tendon, Wire& wire) {
  const auto stiffness = tendon.numbers("stiffness"), damping = tendon.numbers("damping");
  if (!stiffness.empty()) wire.stiffness = not_negative(files_, tendon.node(), "stiffness", stiffness[0]);
  if (!damping.empty()) wire.damping = not_negative(files_, tendon.node(), "damping", damping[0]);
  if (stiffness.size() > 1 || damping.size() > 1)
    note(tendon, "stiffness or damping of a tendon that is no constant: its first number is taken");
  const auto rest = tendon.numbers("springlength");
  wire.rest = rest.empty() || rest[0] < 0 ? length_of(wire) : rest[0];
  if (rest.size() > 1 && rest[1] > rest[0] && rest[0] >= 0) wire.slack = rest[1] - rest[0];
}

/// Its coordinates, if it has any, are those that the model starts with.
bool MjcfRelations::is_start(const MjcfElement& key) const {
  const std::vector<double> q = key.numbers("qpos");
  if (q.empty()) return true;
  const std::vector<double> start = start_coordinates(model_);
  const auto same = [](double x, double y) { return std::abs(x - y) <= 1e-9 * (1 + std::abs(y)); };
  return std::equal(q.begin(), q.end(), start.begin(), start.end(), same);
}

bool MjcfRelations::is_at_rest(const MjcfElement& key) {
  const std::vector<double> v = key.numbers("qvel");
  return std::all_of(v.begin(), v.end(), [](double rate) { return rate == 0; });
}

/// The first <key> that starts from where the model does, at rest and with controls; or else, with controls
/// or in motion; or none.
pugi::xml_node MjcfRelations::start_key(const pugi::xml_node& mujoco) {
  pugi::xml_node moving;
  for (const pugi::xml_node& part : files_.children(mujoco, "keyframe"))
    for (const pugi::xml_node& key : files_.children(part, "key")) {
      const MjcfElement element(files_, key);
      const bool rests = is_at_rest(element);
      if (!is_start(element) || (rests && !key.attribute("ctrl"))) continue;
      if (rests) return key;
      if (!moving) moving = key;
    }
  return moving;
}

/// Controls and velocities at the start: those of its <key>, or else 0.
void MjcfRelations::read_key(const pugi::xml_node& mujoco) {
  std::size_t count = 0;
  for (const pugi::xml_node& part : files_.children(mujoco, "actuator"))
    count += files_.children(part).size();
  const pugi::xml_node start = start_key(mujoco);
  for (const pugi::xml_node& part : files_.children(mujoco, "keyframe"))
    for (const pugi::xml_node& key : files_.children(part, "key")) {
      const MjcfElement element(files_, key);
      if (key != start) {
        leave_out(element, "<key>: the model starts as without it");
        continue;
      }
      files_.accept(key);
      element.find("name");
      if (!is_at_rest(element)) give_velocities(element);
      controls_ = element.numbers("ctrl");
      if (controls_.empty() || controls_.size() == count) continue;
      note(element, "\"ctrl\" has not as many numbers as there are actuators: controls are 0");
      controls_.assign(count, 0.0);
    }
  controls_.resize(count, 0.0);
}

/// `qvel`, joint by joint: of a free one the velocity of its origin, world axes, and the angular velocity in
/// the axes of the body, which those of a ball are in, too.
void MjcfRelations::give_velocities(const MjcfElement& key) {
  const std::vector<double> v = key.numbers("qvel");
  std::size_t count = 0;
  for (const Link& link : model_.links) {
    count += link.free ? 6 : 0;
    for (const LinkAxis& axis : link.axes) count += axis.kind == LinkAxis::Kind::kBall ? 3 : 1;
  }
  if (v.size() != count)
    return note(key, "\"qvel\" has not as many numbers as the joints have: the model starts at rest");
  std::size_t at = 0;
  const auto three = [&] {
    at += 3;
    return Vec3(v[at - 3], v[at - 2], v[at - 1]);
  };
  for (Link& link : model_.links) {
    if (link.free) {
      link.free_twist.v = three();
      link.free_twist.w = link.X_WL.q * three();
    }
    for (LinkAxis& axis : link.axes)
      if (axis.kind == LinkAxis::Kind::kBall)
        axis.spin = three();
      else
        axis.rate = v[at++];
  }
  note(key, "<key>: the model starts with its velocities");
}

void MjcfRelations::read_actuator(const pugi::xml_node& node) {
  const double control = controls_[actuators_++];
  const MjcfElement actuator = defaults_.element(node, "");
  const std::string kind = node.name(), name = actuator.text("name");
  const bool known =
      kind == "general" || kind == "motor" || kind == "position" || kind == "velocity" || kind == "damper";
  const auto through =
      known && model_.actuation && !has_state(actuator) ? transmission(actuator) : std::nullopt;
  if (!through)
    return leave_out(actuator, "<" + kind + "> \"" + name + "\": has no counterpart: it does nothing");
  if (model_.groups_disabled.contains(static_cast<int>(actuator.number("group", 0))))
    return leave_out(actuator, "<" + kind + "> \"" + name + "\": its group is disabled: it does nothing");
  actuator_axes_[name] = through->axis;
  const auto range = control_range(actuator, through->axis);
  act_on_joint(actuator, range ? std::clamp(control, range->first, range->second) : control, *through);
}

/// The joint that it acts on, by itself or by a tendon that is a multiple of it; none of anything else.
std::optional<MjcfRelations::FixedPart> MjcfRelations::transmission(const MjcfElement& actuator) const {
  const pugi::xml_node& node = actuator.node();
  for (const char* key : {"joint", "jointinparent"})
    if (node.attribute(key)) return FixedPart{joint(actuator, key), 1};
  const auto found = fixed_.find(node.attribute("tendon").value());
  if (found == fixed_.end() || found->second.size() != 1 || node.attribute("inheritrange")) return {};
  actuator.text("tendon");
  return found->second[0];
}

/// That its control keeps to: its own, or of a position that of its joint, scaled about the middle.
std::optional<std::pair<double, double>> MjcfRelations::control_range(const MjcfElement& actuator,
                                                                      const AxisName& on) {
  auto range = actuator.range("ctrlrange", "ctrllimited", compiler_);
  const double part =
      actuator.node().name() == std::string_view("position")
          ? not_negative(files_, actuator.node(), "inheritrange", actuator.number("inheritrange", 0))
          : 0;
  if (part > 0) {
    const AxisLaw& law = axis(on).law;
    if (actuator.find("ctrlrange")) actuator.fail("\"ctrlrange\" and \"inheritrange\" exclude each other");
    if (!(law.lower > -kNoLimit && law.upper < kNoLimit))
      actuator.fail("\"inheritrange\" needs a joint with a range");
    const double middle = 0.5 * (law.lower + law.upper), half = 0.5 * part * (law.upper - law.lower);
    range = std::pair(middle - half, middle + half);
  }
  return model_.clamps_controls ? range : std::nullopt;
}

/// Its force follows the control later.
bool MjcfRelations::has_state(const MjcfElement& actuator) const {
  return actuator.text("dyntype", "none") != "none" || actuator.number("timeconst", 0) > 0;
}

/// Of a position: given, or as a part of what is critical for the inertia of the joint at the start, as the
/// actuator feels it.
double MjcfRelations::damping_of(const MjcfElement& position, double kp, double gear, const AxisName& on) {
  const double ratio = not_negative(files_, position.node(), "dampratio", position.number("dampratio", 0));
  const double given = position.number("kv", 0);
  if (ratio == 0) return given;
  if (given != 0) position.fail("\"kv\" and \"dampratio\" exclude each other");
  if (const auto inertia = inertia_along(model_, on); inertia && gear != 0)
    return 2 * ratio * std::sqrt(kp * *inertia) / std::abs(gear);
  note(position, "\"dampratio\", without a hinge or slide whose mass is known: has no counterpart");
  return 0;
}

/// Of its kind; three numbers of bias.
MjcfRelations::Gains MjcfRelations::gains_of(const MjcfElement& actuator, double control, double gear,
                                             const AxisName& on) {
  const std::string kind = actuator.node().name();
  Gains gains;
  auto& [gain, bias] = gains;
  if (kind == "position") {
    gain = actuator.number("kp", 1);
    bias[1] = -gain, bias[2] = -damping_of(actuator, gain, gear, on);
  } else if (kind == "velocity") {
    gain = actuator.number("kv", 1);
    bias[2] = -gain;
  } else if (kind == "damper") {
    gain = 0;
    bias[2] = -actuator.number("kv", 1) * control;
  } else if (kind == "general") {
    const std::vector<double> given = actuator.numbers("gainprm");
    if (actuator.text("gaintype", "fixed") != "fixed")
      gain = 0;
    else if (!given.empty())
      gain = given[0];
    const std::string type = actuator.text("biastype", "none");
    if (type == "affine") bias = actuator.numbers("biasprm");
    if (type != "affine" && type != "none")
      note(actuator, "\"biastype\": has no counterpart: it does nothing");
    if (gain == 0 && control != 0)
      note(actuator, "\"gaintype\": has no counterpart: its control does nothing");
  }
  bias.resize(3, 0.0);
  return gains;
}

/// force = gear (gain₀ u + bias₀ + bias₁ gear q + bias₂ gear q̇), with gain and bias of the kind.
AxisDrive MjcfRelations::drive_of(const MjcfElement& actuator, double control, const FixedPart& through) {
  const double gear = through.coef * actuator.numbers("gear", {1, 0, 0, 0, 0, 0})[0];
  const auto [gain, bias] = gains_of(actuator, control, gear, through.axis);
  const double constant = gain * control + bias[0];
  const auto range = actuator.range("forcerange", "forcelimited", compiler_);
  if (bias[1] == 0 && bias[2] == 0)
    return {gear * (range ? std::clamp(constant, range->first, range->second) : constant), 0, 0, kNoLimit};
  if (range && range->first != -range->second)
    note(actuator, "\"forcerange\" that is not symmetric: its larger end is taken both ways");
  const double most = range ? std::max(std::abs(range->first), std::abs(range->second)) : kNoLimit;
  return {gear * constant, -bias[1] * gear * gear, -bias[2] * gear * gear, most * std::abs(gear)};
}

/// Those of one joint are one motor.
void MjcfRelations::act_on_joint(const MjcfElement& actuator, double control, const FixedPart& through) {
  const AxisName& on = through.axis;
  const std::string label = "<" + std::string(actuator.node().name()) + "> \"" + actuator.text("name") + "\"";
  const AxisDrive drive = drive_of(actuator, control, through);
  AxisDrive& all = axis(on).drive;
  if (drive.stiffness < 0 || drive.damping < 0)
    return note(actuator, label + ": a bias that is no spring: has no counterpart");
  if (!drive.any()) return note(actuator, label + ": without a control it does nothing");
  if (axis(on).kind == LinkAxis::Kind::kBall)
    return note(actuator, label + ": acts on a ball joint: has no counterpart");
  if (all.any() && (all.most < kNoLimit || drive.most < kNoLimit))
    return note(actuator, label +
                              ": acts on a joint that another one drives, and one of them has a bounded "
                              "force: left out");
  all = {all.constant + drive.constant, all.stiffness + drive.stiffness, all.damping + drive.damping,
         drive.most};
  std::ostringstream message;
  message << label << ": a motor of its joint, with a control of " << control;
  note(actuator, message.str());
}

void MjcfRelations::read_sensor(const pugi::xml_node& node) {
  static const std::map<std::string_view, const char*> kOfJoints = {{"jointpos", "axis"},
                                                                    {"jointvel", "axis"},
                                                                    {"jointactuatorfrc", "axis-force"},
                                                                    {"jointlimitfrc", "axis-force"}};
  static const std::map<std::string_view, const char*> kOfSites = {{"force", "reaction-force"},
                                                                   {"torque", "reaction-torque"},
                                                                   {"velocimeter", "velocity"},
                                                                   {"gyro", "angular-velocity"}};
  const MjcfElement sensor(files_, node);
  const std::string kind = node.name();
  ModelProbe probe;
  probe.name = name_of(sensor);
  if (probe.name.empty()) probe.name = kind;
  probe.place = sensor.place();
  const auto of_joint = kOfJoints.find(kind), of_site = kOfSites.find(kind);
  if (of_joint != kOfJoints.end()) {
    probe.quantity = of_joint->second;
    probe.axis = joint(sensor, "joint");
  } else if (kind == "actuatorfrc") {
    const std::string actuator = files_.required(node, "actuator");
    const auto found = actuator_axes_.find(actuator);
    if (found == actuator_axes_.end()) throw NotThere{actuator};
    probe.quantity = "axis-force";
    probe.axis = found->second;
    note(sensor, "<actuatorfrc>: the probe is of all that acts along the joint of the actuator");
  } else if (of_site != kOfSites.end()) {
    probe.quantity = of_site->second;
    probe.at = site(sensor, "site");
  } else if (!frame_sensor(sensor, probe)) {
    return leave_out(sensor, "<" + kind + ">: this sensor has no counterpart");
  }
  if (of_site != kOfSites.end() || kind == "framequat")
    note(sensor, "<" + kind + ">: the probe is in world axes" + (kind == "framequat" ? ", of the body" : ""));
  model_.probes.push_back(std::move(probe));
}

bool MjcfRelations::frame_sensor(const MjcfElement& sensor, ModelProbe& probe) {
  static const std::map<std::string_view, std::string> kQuantityOf = {{"framepos", "position"},
                                                                      {"framequat", "orientation"},
                                                                      {"framelinvel", "velocity"},
                                                                      {"frameangvel", "angular-velocity"}};
  const auto found = kQuantityOf.find(sensor.node().name());
  const std::string type = sensor.text("objtype");
  if (found == kQuantityOf.end() || sensor.node().attribute("reftype")) return false;
  if (type != "body" && type != "xbody" && type != "site") return false;
  probe.quantity = found->second;
  probe.at = object_of(sensor);
  return true;
}

LinkFrame MjcfRelations::object_of(const MjcfElement& sensor) {
  const std::string type = sensor.text("objtype");
  if (type == "site") return site(sensor, "objname");
  const int link = body(sensor, "objname");
  if (type == "xbody" || link == kWorld) return {link, {}};
  return {link, {Quat::Identity(), model_.links[link].inertia.centre}};
}

}  // namespace taut::model
