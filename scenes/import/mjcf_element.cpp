#include "scenes/import/mjcf_element.h"

#include <algorithm>
#include <cctype>
#include <numbers>
#include <set>

namespace taut::model {
namespace {

/// Elements that share the defaults of <general>.
const std::set<std::string_view> kActuators = {"general", "motor",    "position", "velocity", "intvelocity",
                                               "damper",  "cylinder", "muscle",   "adhesion", "dcmotor"};

/// Whether an element of a default class is the one for elements of this name.
bool gives(std::string_view in_class, std::string_view element) {
  if (in_class == element) return true;
  if (element == "freejoint") return false;
  if (element == "spatial" || element == "fixed") return in_class == "tendon";
  if (element == "connect" || element == "weld") return in_class == "equality";
  return kActuators.contains(in_class) && kActuators.contains(element);
}

Quat from_axes(const Vec3& x, const Vec3& y) {
  Mat3 R;
  R << x, y, x.cross(y);
  return Quat(R);
}

bool yes(XmlFiles& files, const pugi::xml_node& node, const char* attribute, bool fallback) {
  const char* text = files.find(node, attribute);
  return text ? std::string_view(text) == "true" : fallback;
}

}  // namespace

MjcfCompiler read_compiler(XmlFiles& files, const pugi::xml_node& mujoco) {
  MjcfCompiler c;
  for (const pugi::xml_node& node : files.children(mujoco, "compiler")) {
    if (const char* angle = files.find(node, "angle"))
      c.angle = std::string_view(angle) == "radian" ? 1 : std::numbers::pi / 180;
    if (const char* order = files.find(node, "eulerseq")) c.eulerseq = order;
    const bool known = c.eulerseq.size() == 3 && c.eulerseq.find_first_not_of("xyzXYZ") == std::string::npos;
    if (!known) files.fail(node, "\"eulerseq\" must be three of x, y, z (value: " + c.eulerseq + ")");
    if (const char* frames = files.find(node, "coordinate"); frames && std::string_view(frames) != "local")
      files.fail(node, std::string("only local coordinates are read (value: ") + frames + ")");
    c.autolimits = yes(files, node, "autolimits", c.autolimits);
    if (const char* from = files.find(node, "inertiafromgeom"))
      c.inertia_from_geoms = std::string_view(from) == "true"    ? MjcfCompiler::FromGeoms::kYes
                             : std::string_view(from) == "false" ? MjcfCompiler::FromGeoms::kNo
                                                                 : MjcfCompiler::FromGeoms::kAuto;
    if (const char* range = files.find(node, "inertiagrouprange")) {
      const auto groups = exactly(files, node, "inertiagrouprange", range, 2);
      c.first_group = static_cast<int>(std::clamp(groups[0], -1e6, 1e6));
      c.last_group = static_cast<int>(std::clamp(groups[1], -1e6, 1e6));
    }
    c.balance_inertia = yes(files, node, "balanceinertia", c.balance_inertia);
    c.bound_mass = number(files, node, "boundmass", c.bound_mass);
    c.bound_inertia = number(files, node, "boundinertia", c.bound_inertia);
    c.total_mass = number(files, node, "settotalmass", c.total_mass);
    c.strip_path = yes(files, node, "strippath", c.strip_path);
    for (const char* key : {"assetdir", "meshdir"})
      if (const char* folder = files.find(node, key)) c.mesh_folder = folder;
  }
  return c;
}

const char* MjcfElement::find(const char* attribute) const {
  const char* found = nullptr;
  for (const pugi::xml_node& layer : layers_)  // all of them count as read
    if (const char* text = files_->find(layer, attribute); text && !found) found = text;
  return found;
}

std::string MjcfElement::text(const char* attribute, const char* fallback) const {
  const char* found = find(attribute);
  return found ? found : fallback;
}

double MjcfElement::number(const char* attribute, double fallback) const {
  const char* found = find(attribute);
  return found ? exactly(*files_, node_, attribute, found, 1)[0] : fallback;
}

std::vector<double> MjcfElement::numbers(const char* attribute) const {
  const char* found = find(attribute);
  return found ? model::numbers(*files_, node_, attribute, found) : std::vector<double>();
}

std::vector<double> MjcfElement::numbers(const char* attribute, std::vector<double> fallback) const {
  const std::vector<double> found = numbers(attribute);
  if (found.size() > fallback.size())
    fail(std::string("\"") + attribute + "\" has at most " + std::to_string(fallback.size()) + " numbers");
  std::copy(found.begin(), found.end(), fallback.begin());
  return fallback;
}

Vec3 MjcfElement::vector(const char* attribute, const Vec3& fallback) const {
  const char* found = find(attribute);
  if (!found) return fallback;
  const std::vector<double> v = exactly(*files_, node_, attribute, found, 3);
  return {v[0], v[1], v[2]};
}

bool MjcfElement::flag(const char* attribute, bool fallback) const {
  const std::string found = text(attribute, "auto");
  return found == "auto" ? fallback : found == "true" || found == "enable";
}

std::optional<std::pair<double, double>> MjcfElement::range(const char* attribute, const char* limited,
                                                            const MjcfCompiler& compiler) const {
  const std::vector<double> ends = numbers(attribute, {0, 0});
  const bool given = ends[0] < ends[1];
  if (!flag(limited, compiler.autolimits && given) || !given) return std::nullopt;
  return std::pair(ends[0], ends[1]);
}

Pose MjcfElement::pose(const MjcfCompiler& compiler) const {
  return {orientation(compiler), vector("pos", Vec3::Zero())};
}

Quat from_euler(const Vec3& angles, const MjcfCompiler& compiler) {
  Quat q = Quat::Identity();
  for (int i = 0; i < 3; ++i) {
    const char letter = compiler.eulerseq[i];
    const Quat turn = exp_so3(angles[i] * compiler.angle * Vec3::Unit(std::tolower(letter) - 'x'));
    q = std::islower(static_cast<unsigned char>(letter)) ? q * turn : turn * q;
  }
  return q.normalized();
}

Quat z_to(const Vec3& direction) {
  const Vec3 z = direction.normalized(), axis = Vec3::UnitZ().cross(z);
  if (axis.norm() < 1e-15) return z.z() > 0 ? Quat(1, 0, 0, 0) : Quat(0, 1, 0, 0);
  return exp_so3(std::atan2(axis.norm(), z.z()) * axis.normalized());
}

Quat MjcfElement::orientation(const MjcfCompiler& compiler) const {
  const auto exact = [&](const char* key, const char* found, std::size_t count) {
    return exactly(*files_, node_, key, found, count);
  };
  if (const char* found = find("axisangle")) {
    const auto v = exact("axisangle", found, 4);
    return exp_so3(v[3] * compiler.angle * direction(*files_, node_, "axisangle", {v[0], v[1], v[2]}));
  }
  if (const char* found = find("xyaxes")) {
    const auto v = exact("xyaxes", found, 6);
    const Vec3 x = direction(*files_, node_, "xyaxes", {v[0], v[1], v[2]}), second(v[3], v[4], v[5]);
    return from_axes(x, direction(*files_, node_, "xyaxes", second - second.dot(x) * x));
  }
  if (const char* found = find("zaxis")) {
    const auto v = exact("zaxis", found, 3);
    return z_to(direction(*files_, node_, "zaxis", {v[0], v[1], v[2]}));
  }
  if (const char* found = find("euler")) {
    const auto v = exact("euler", found, 3);
    return from_euler({v[0], v[1], v[2]}, compiler);
  }
  if (const char* found = find("quat")) {
    const auto v = exact("quat", found, 4);
    const Quat q(v[0], v[1], v[2], v[3]);
    if (!(q.norm() > 1e-12)) fail("\"quat\" must not be 0");
    return q.normalized();
  }
  return Quat::Identity();
}

MjcfDefaults::MjcfDefaults(XmlFiles& files, const pugi::xml_node& mujoco) : files_(files) {
  for (const pugi::xml_node& node : files.children(mujoco, "default")) read(node, "");
}

void MjcfDefaults::read(const pugi::xml_node& node, const std::string& parent) {
  const char* given = files_.find(node, "class");
  std::string name = given ? given : "";
  if (parent.empty()) {
    if (classes_.empty() && given) top_ = name;
    if (!given) name = top_;
  } else if (!given) {
    files_.fail(node, "a <default> within another needs a \"class\"");
  }
  const auto [place, is_new] = classes_.try_emplace(name);
  if (is_new) place->second.parent = parent.empty() && name != top_ ? top_ : parent;
  for (const pugi::xml_node& child : files_.children(node))
    if (std::string_view(child.name()) != "default") place->second.elements.push_back(child);
  for (const pugi::xml_node& child : files_.children(node, "default")) read(child, name);
}

MjcfElement MjcfDefaults::element(const pugi::xml_node& node, const std::string& childclass) const {
  std::string name = childclass.empty() ? top_ : childclass;
  if (const char* given = files_.find(node, "class")) name = given;
  if (!classes_.contains(name) && name != top_)
    files_.fail(node, "there is no default class of this name" + near_name(name, classes_) +
                          " (value: " + name + ")");
  std::vector<pugi::xml_node> layers;
  std::set<std::string> seen;
  for (auto found = classes_.find(name); found != classes_.end() && seen.insert(found->first).second;
       found = classes_.find(found->second.parent))
    for (const pugi::xml_node& child : found->second.elements)
      if (gives(child.name(), node.name())) layers.push_back(child);
  return MjcfElement(files_, node, std::move(layers));
}

}  // namespace taut::model
