#include "scenes/import/mjcf_tree.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "core/math/dense.h"
#include "scenes/import/link_inertia.h"
#include "scenes/import/mjcf_relations.h"

namespace taut::model {
namespace {

/// Copies of <replicate> in copies are many; a scene has some thousand bodies.
constexpr int kMostElements = 200'000;

/// The inertia with principal moments as <compiler> wants them.
LinkInertia bounded(LinkInertia inertia, const MjcfCompiler& compiler) {
  inertia.mass = std::max(inertia.mass, compiler.bound_mass);
  if (!compiler.balance_inertia && compiler.bound_inertia <= 0) return inertia;
  auto [moments, axes] = dense::symmetric_eigenpairs3(inertia.inertia);
  if (compiler.bound_inertia > 0) moments = moments.cwiseMax(compiler.bound_inertia);
  if (compiler.balance_inertia && moments[0] + moments[1] < moments[2]) moments.setConstant(moments.mean());
  inertia.inertia = axes * moments.asDiagonal() * axes.transpose();
  return inertia;
}

void read_range(LinkAxis& axis, const MjcfElement& joint, double unit, bool autolimits) {
  const auto range = joint.numbers("range", {0, 0});
  const bool given = range[0] != 0 || range[1] != 0;
  if (!joint.flag("limited", autolimits && given)) return;
  if (!(range[0] < range[1]) && axis.kind != LinkAxis::Kind::kBall)
    joint.fail("\"range\" must be two numbers that increase");
  axis.law.lower = unit * range[0];
  axis.law.upper = unit * range[1];
}

}  // namespace

void MjcfTree::read_all(const Where& where) {
  for (const char* name : {"worldbody", "body", "frame", "replicate"})
    files_.know_children(name, {"body", "frame", "replicate", "geom", "site", "attach", "joint", "freejoint",
                                "inertial", "camera", "light", "composite", "flexcomp", "plugin"});
  for (const pugi::xml_node& world : files_.children(mujoco_, "worldbody")) read_children(world, where);
}

void MjcfTree::count(const pugi::xml_node& node) {
  if (++model_.elements > kMostElements) files_.give_up(node, "the model has more than 200,000 elements");
}

std::string MjcfTree::name_of(const MjcfElement& element, const Where& where) {
  const std::string name = element.text("name");
  if (!name.empty() && !where.ending.empty()) names_.copied.insert(name);
  return name.empty() ? name : name + where.ending;
}

void MjcfTree::read_children(const pugi::xml_node& parent, const Where& where) {
  for (const pugi::xml_node& node : files_.children(parent)) read_child(node, where);
}

void MjcfTree::read_child(const pugi::xml_node& node, const Where& where) {
  struct Kind {
    std::string_view name;
    void (MjcfTree::*read)(const pugi::xml_node&, const Where&);
    bool of_a_link = false;  // the world has none
  };
  static constexpr Kind kKinds[] = {{"body", &MjcfTree::read_body},
                                    {"frame", &MjcfTree::read_frame},
                                    {"replicate", &MjcfTree::read_replicate},
                                    {"geom", &MjcfTree::read_geom_of},
                                    {"site", &MjcfTree::read_site},
                                    {"attach", &MjcfTree::read_attach},
                                    {"joint", &MjcfTree::read_joint, true},
                                    {"freejoint", &MjcfTree::read_joint, true},
                                    {"inertial", &MjcfTree::read_inertial, true}};
  const std::string_view name = node.name();
  count(node);
  if (name == "flexcomp" || name == "composite" || name == "plugin") names_.lacks_some = true;
  const auto kind =
      std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& each) { return each.name == name; });
  if (kind == std::end(kKinds)) return;
  files_.accept(node);
  if (where.link == kWorld && kind->of_a_link) return;
  // What is wrong may have defined what others refer to.
  if (!files_.attempt([&] { (this->*kind->read)(node, where); })) names_.lacks_some = true;
}

void MjcfTree::read_body(const pugi::xml_node& node, const Where& where) {
  const MjcfElement element(files_, node);
  Link link;
  const std::string name = name_of(element, where);
  link.name = name.empty() ? name : where.beginning + name;
  link.parent = where.link;
  link.place = files_.place(node);
  const Pose X_WP = where.link == kWorld ? Pose{} : model_.links[where.link].X_WL;
  link.X_WL = X_WP * where.X_LF * element.pose(compiler_);
  link.X_WL.q.normalize();
  if (!link.X_WL.p.allFinite()) files_.fail(node, "the position is not finite");
  if (element.flag("mocap", false))
    note(node, "\"" + link.name + "\" is moved by motion capture: it stays where it is");
  Where inside{static_cast<int>(model_.links.size()),
               {},
               element.text("childclass", where.childclass.c_str()),
               where.beginning,
               where.ending};
  if (!inside.childclass.empty() && !defaults_.has(inside.childclass) && inside.childclass != "main")
    files_.fail(node, "there is no default class of this name (value: " + inside.childclass + ")");
  if (!name.empty() && !names_.bodies.try_emplace(name, inside.link).second)
    files_.fail(node, "there is another body of this name (value: " + name + ")");
  model_.links.push_back(std::move(link));
  links_.push_back(inside.link);
  for (const pugi::xml_node& child : files_.children(node, "inertial"))  // in front of the geoms
    read_inertial(child, inside);
  read_children(node, inside);
}

void MjcfTree::read_frame(const pugi::xml_node& node, const Where& where) {
  const MjcfElement element(files_, node);
  Where inside = where;
  inside.X_LF = where.X_LF * element.pose(compiler_);
  inside.childclass = element.text("childclass", where.childclass.c_str());
  element.find("name");
  read_children(node, inside);
}

/// Copies of the children, each moved against the one before.
void MjcfTree::read_replicate(const pugi::xml_node& node, const Where& where) {
  const MjcfElement element(files_, node);
  const double copies = element.number("count", 0);
  if (!(copies >= 1 && copies <= kMostElements)) files_.fail(node, "\"count\" must be from 1 to 200000");
  const Vec3 offset = element.vector("offset", Vec3::Zero()), euler = element.vector("euler", Vec3::Zero());
  const int digits = static_cast<int>(std::to_string(static_cast<int>(copies) - 1).size());
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < static_cast<int>(copies); ++i) {
    const Quat q = from_euler(i * euler, compiler_);
    Where copy = where;
    copy.X_LF = where.X_LF * Pose{q, p};
    std::string number = std::to_string(i);
    number.insert(0, static_cast<std::size_t>(digits) - number.size(), '0');
    copy.ending = element.text("sep") + number + where.ending;
    read_children(node, copy);
    p += q * offset;
    count(node);
  }
}

void MjcfTree::read_joint(const pugi::xml_node& node, const Where& where) {
  Link& link = model_.links[where.link];
  const MjcfElement joint = defaults_.element(node, where.childclass);
  const std::string type =
      std::string_view(node.name()) == "freejoint" ? "free" : joint.text("type", "hinge");
  const std::string name = name_of(joint, where);
  if (type == "free") {
    link.free = true;
    names_.free_joints.insert(name);
    return;
  }
  LinkAxis axis;
  axis.name = name.empty() ? name : where.beginning + name;
  axis.place = files_.place(node);
  axis.kind =
      type == "hinge"   ? LinkAxis::Kind::kHinge
      : type == "slide" ? LinkAxis::Kind::kSlide
      : type == "ball"
          ? LinkAxis::Kind::kBall
          : (joint.fail("unknown type of joint" + meant_type(type, {"free", "ball", "slide", "hinge"}) +
                        " (value: " + type + ")"),
             LinkAxis::Kind::kHinge);
  axis.anchor = where.X_LF.point(joint.vector("pos", Vec3::Zero()));
  if (axis.kind != LinkAxis::Kind::kBall)
    axis.axis = where.X_LF.q * direction(files_, node, "axis", joint.vector("axis", Vec3::UnitZ()));
  else
    joint.find("axis");
  const AxisName here{where.link, static_cast<int>(link.axes.size())};
  read_law(axis, joint, here);
  if (!name.empty()) names_.joints[name] = here;
  link.axes.push_back(std::move(axis));
}

void MjcfTree::read_law(LinkAxis& axis, const MjcfElement& joint, const AxisName& name) {
  const double unit = axis.kind == LinkAxis::Kind::kSlide ? 1 : compiler_.angle;
  axis.start = unit * joint.number("ref", 0);
  AxisLaw& law = axis.law;
  const auto first = [&](const char* key) {
    const std::vector<double> found = joint.numbers(key);
    if (found.size() > 1 && std::any_of(found.begin() + 1, found.end(), [](double x) { return x != 0; }))
      note(joint.node(), std::string("\"") + key + "\" that is no constant: its first number is taken");
    return found.empty() ? 0.0 : not_negative(files_, joint.node(), key, found[0]);
  };
  law.stiffness = first("stiffness");
  law.damping = first("damping");
  law.rest = unit * joint.number("springref", 0);
  law.friction = first("frictionloss");
  if (const auto pair = joint.numbers("springdamper", {0, 0}); pair[0] > 0 && pair[1] > 0)
    springs_.push_back({name, pair[0], pair[1], joint.node()});
  else if (pair[0] != 0 || pair[1] != 0)
    joint.fail("\"springdamper\" must be two positive numbers");
  axis.armature = not_negative(files_, joint.node(), "armature", joint.number("armature", 0));
  if (axis.kind == LinkAxis::Kind::kBall && axis.armature > 0)
    note(joint.node(), "\"armature\" of a ball joint: has no counterpart");
  if (const auto force = joint.range("actuatorfrcrange", "actuatorfrclimited", compiler_)) {
    axis.most_drive = std::max(std::abs(force->first), std::abs(force->second));
    if (force->first != -force->second)
      note(joint.node(), "\"actuatorfrcrange\" that is not symmetric: its larger end is taken both ways");
  }
  read_range(axis, joint, unit, compiler_.autolimits);
}

void MjcfTree::read_inertial(const pugi::xml_node& node, const Where& where) {
  if (has_inertial_.contains(where.link)) return;
  const MjcfElement element(files_, node);
  if (compiler_.inertia_from_geoms == MjcfCompiler::FromGeoms::kYes) return;
  has_inertial_.insert(where.link);
  LinkInertia inertia;
  files_.required(node, "mass");
  inertia.mass = not_negative(files_, node, "mass", element.number("mass", 0));
  const std::vector<double> full = element.numbers("fullinertia");
  if (full.size() == 6)
    inertia.inertia << full[0], full[3], full[4], full[3], full[1], full[5], full[4], full[5], full[2];
  else if (!full.empty())
    element.fail("\"fullinertia\" must have 6 numbers");
  else
    inertia.inertia = element.vector("diaginertia", Vec3::Zero()).asDiagonal();
  Link& link = model_.links[where.link];
  link.inertia = in_frame(where.X_LF * element.pose(compiler_), inertia);
}

/// The inertia of the link is that of its geoms, and this is one of them.
bool MjcfTree::adds_inertia(const MjcfGeom& geom, int link) const {
  const bool in_groups = geom.group >= compiler_.first_group && geom.group <= compiler_.last_group;
  return link != kWorld && !has_inertial_.contains(link) && geom.weighs && in_groups &&
         compiler_.inertia_from_geoms != MjcfCompiler::FromGeoms::kNo;
}

void MjcfTree::read_geom_of(const pugi::xml_node& node, const Where& where) {
  const MjcfElement element = defaults_.element(node, where.childclass);
  MjcfGeom geom = read_geom(element, compiler_, meshes_, fields_);
  const std::string name = name_of(element, where);
  std::vector<LinkShape>& shapes = model_.shapes_of(where.link);
  if (!name.empty()) names_.geoms[name] = {where.link, geom.shape ? static_cast<int>(shapes.size()) : -1};
  if (!geom.shape) note(node, "<geom>: its shape is left out: " + geom.problem);
  if (geom.shape) {
    geom.shape->X_LS = where.X_LF * geom.shape->X_LS;
    shapes.push_back(std::move(*geom.shape));
  }
  if (!adds_inertia(geom, where.link)) return;
  Link& link = model_.links[where.link];
  const bool weightless =
      !geom.problem.empty() && (element.text("mass") == "0" || element.text("density") == "0");
  if (!geom.problem.empty() && !weightless && link.unknown_mass.empty())
    link.unknown_mass = "the mass of \"" + link.name + "\" is not known: " + geom.problem;
  link.inertia = sum(link.inertia, in_frame(where.X_LF, geom.inertia));
}

void MjcfTree::read_site(const pugi::xml_node& node, const Where& where) {
  const MjcfElement element = defaults_.element(node, where.childclass);
  Pose pose = element.pose(compiler_);
  if (const char* ends = element.find("fromto")) {
    const auto v = exactly(files_, node, "fromto", ends, 6);
    const Vec3 from(v[0], v[1], v[2]), to(v[3], v[4], v[5]);
    pose = {z_to(from - to), (from + to) / 2};
  }
  const std::string name = name_of(element, where);
  if (!name.empty()) names_.sites[name] = {where.link, where.X_LF * pose};
}

void MjcfTree::finish() {
  double total = 0;
  for (int i : links_) {
    Link& link = model_.links[i];
    link.inertia = bounded(link.inertia, compiler_);
    total += link.inertia.mass;
  }
  if (compiler_.total_mass > 0 && total > 0)
    for (int i : links_)
      model_.links[i].inertia = scaled(model_.links[i].inertia, compiler_.total_mass / total);
  for (const auto& attached : attached_) attached->finish();
}

/// The spring and damper with this time constant and damping ratio, in place of those that are given, for the
/// inertia at the start.
void MjcfTree::give_springs() {
  for (const auto& [on, time, ratio, node] : springs_) {
    AxisLaw& law = model_.links[on.link].axes[on.axis].law;
    if (const auto inertia = inertia_along(model_, on)) {
      law.stiffness = *inertia / (time * time * ratio * ratio);
      law.damping = 2 * *inertia / time;
    } else {
      note(node, "\"springdamper\", without a hinge or slide whose mass is known: has no counterpart");
    }
  }
}

void MjcfTree::relate() {
  give_springs();
  MjcfRelations(files_, defaults_, compiler_, names_, prefix_, model_).read(mujoco_);
  for (const auto& attached : attached_) attached->relate();
}

}  // namespace taut::model
