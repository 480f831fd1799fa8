#include <algorithm>

#include "tests/fuzz/mechanism.h"
#include "tests/fuzz/mechanism_random.h"

namespace taut::fuzz {
namespace {

using Json = nlohmann::json;

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json json_of(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

/// Names of the free axes by joint type, those of angles first; what may act along them.
struct AxisName {
  const char* name;
  bool angular;
  bool has_position;
};
std::vector<AxisName> axes_of(const Json& joint) {
  const std::string type = joint["type"];
  if (type == "hinge" || type == "screw") return {{"angle", true, true}};
  if (type == "slider" || type == "point_on_line") return {{"displacement", false, true}};
  if (type == "cylindrical") return {{"angle", true, true}, {"displacement", false, true}};
  if (type == "universal") return {{"angle_1", true, true}, {"angle_2", true, true}, {"swing", true, true}};
  if (type == "point_on_curve") return {{"parameter", false, true}};
  if (type == "planar") return {{"angle", true, true}, {"x", false, true}, {"y", false, true}};
  if (type == "hinge2") return {{"travel", false, true}, {"steering", true, true}, {"spin", true, true}};
  if (type == "ball" && joint.contains("frame_orientation"))
    return {{"swing", true, true}, {"twist", true, true}, {"turn_x", true, false}, {"turn_y", true, false}};
  if (type == "six_dof") {
    std::vector<AxisName> axes;
    static constexpr AxisName kAll[] = {{"x", false, true},      {"y", false, true},
                                        {"z", false, true},      {"angle_x", true, true},
                                        {"angle_y", true, true}, {"angle_z", true, true}};
    int free_angles = 3;
    for (const Json& lock : joint["locked"])
      if (lock.get<std::string>().starts_with("angle")) --free_angles;
    for (const AxisName& axis : kAll)
      if (std::find(joint["locked"].begin(), joint["locked"].end(), axis.name) == joint["locked"].end() &&
          (!axis.angular || (free_angles > 0 && free_angles < 3)))
        axes.push_back(axis);
    return axes;
  }
  return {};
}

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {
    scene_["format"] = "taut-scene/1";
    scene_["name"] = "mechanism " + std::to_string(seed);
    choose_scales();
    choose_settings();
  }

  Json make() {
    add_bodies();
    add_joints();
    if (!plain_) add_couplings();
    add_forces();
    if (contacts_) add_ground();
    return std::move(scene_);
  }

 private:
  void choose_scales() {
    size_ = random_.chance(0.4) ? random_.decades(-1, 1) : random_.decades(-3, 3);
    mass_ = random_.decades(-3, 3);
    mass_decades_ = random_.chance(0.5) ? 1 : random_.uniform(0, 12);
    free_ = random_.chance(0.35);
    g_ = random_.chance(0.8) ? 9.81 : random_.decades(-2, 2);
    const Vec3 down = random_.chance(0.8) ? Vec3(0, 0, -1) : random_.direction();
    scene_["gravity"] = json_of(free_ ? Vec3(0, 0, 0) : Vec3(g_ * down));
    speed_ = std::sqrt(g_ * size_) * (random_.chance(0.3) ? 0 : random_.decades(-2, 0.7));
    const double period = std::sqrt(size_ / g_);
    dt_ = period / random_.decades(0.7, 3);
    scene_["dt"] = dt_;
    scene_["duration"] = (10 + random_.below(31)) * dt_;
    count_ = 2 + random_.below(random_.chance(0.2) ? 11 : 6);
  }

  void choose_settings() {
    Json& settings = scene_["settings"] = Json::object();
    const double kind = random_.uniform(0, 1);
    plain_ = false;
    if (kind < 0.15) {
      settings["integrator"] = random_.of<std::string>({"rattle4", "rattle6", "rattle8"});
      plain_ = true;
    } else if (kind < 0.25) {
      settings["integrator"] = random_.of<std::string>({"force-euler", "force-runge-kutta"});
      if (random_.chance(0.5))
        settings["drift_cure"] =
            random_.of<std::string>({"none", "baumgarte", "velocity-impulse", "position-push", "penalty"});
      plain_ = true;
    } else if (kind < 0.37) {
      settings["integrator"] = "moreau-jean";
      if (random_.chance(0.3)) settings["theta"] = random_.uniform(0.5, 1);
      if (random_.chance(0.1)) settings["drift_cure"] = "none";
      moreau_ = true;
    } else if (kind < 0.45) {
      settings["solver"] = random_.of<std::string>({"gauss-seidel", "pairwise", "propagation"});
      settings["iterations"] = 10 + random_.below(40);
    } else {
      if (random_.chance(0.25)) settings["tension"] = "implicit";
      if (random_.chance(0.05)) settings["tension"] = "ignore";
      if (random_.chance(0.2)) settings["merge_fixed_joints"] = true;
      if (random_.chance(0.15))
        settings["sleep"] = true, settings["sleep_time"] = 3 * dt_,
        settings["sleep_speed"] = 0.05 * std::sqrt(g_ * size_);
      if (random_.chance(0.3))
        settings["factor"] = random_.of<std::string>({"cholmod", "simplicial", "supernodal", "multifrontal"});
      if (random_.chance(0.05)) settings["report_rank"] = true;
    }
    settings["max_substeps"] = 64;  // a mechanism that needs more is a failed step, and not a slow one
    contacts_ = !plain_ && random_.chance(0.3);
    if (contacts_) settings["contact_margin"] = 0.005 * size_;
  }

  Json material() {
    Json m = {{"static_friction", random_.chance(0.3) ? 0 : random_.uniform(0, 1.2)}};
    if (random_.chance(0.3)) m["restitution"] = random_.uniform(0, 1);
    if (random_.chance(0.2)) m["rolling_friction"] = random_.uniform(0, 0.01 * size_);
    if (random_.chance(0.1)) m["spinning_friction"] = random_.uniform(0, 0.01 * size_);
    if (!moreau_ && random_.chance(0.3)) m["compliance"] = size_ / (mass_ * g_) * random_.decades(-6, -2);
    return m;
  }

  Json shape() {
    const double r = size_ * random_.uniform(0.1, 0.35);
    Json s;
    switch (random_.below(8)) {
      case 0:
        s = {{"type", "box"}, {"size", json_of(Vec3(r, r, r) + random_.in_cube(r / 2))}};
        break;
      case 1:
        s = {{"type", "capsule"}, {"radius", r / 2}, {"length", r * random_.uniform(0, 2)}};
        break;
      case 2:
        s = {{"type", "cylinder"}, {"radius", r / 2}, {"length", r * random_.uniform(0.1, 2)}};
        break;
      case 3:
        s = {{"type", "ellipsoid"}, {"radii", json_of(Vec3(r, r, r) + random_.in_cube(r / 2))}};
        break;
      case 4:
        s = {{"type", "cone"}, {"radius", r / 2}, {"height", r}};
        break;
      case 5: {
        Json points = Json::array();
        const int n = 5 + random_.below(6);
        for (int i = 0; i < n; ++i) points.push_back(json_of(Vec3(r * random_.direction())));
        s = {{"type", "convex_hull"}, {"points", points}};
        break;
      }
      case 6: {
        const Json corners = {json_of(Vec3(0, 0, r)), json_of(Vec3(r, 0, -r / 2)),
                              json_of(Vec3(-r / 2, 0.8 * r, -r / 2)),
                              json_of(Vec3(-r / 2, -0.8 * r, -r / 2))};
        s = {{"type", "triangle_mesh"},
             {"vertices", corners},
             {"triangles", {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}}};
        break;
      }
      default:
        s = {{"type", "sphere"}, {"radius", r}};
    }
    s["material"] = material();
    if (random_.chance(0.2)) s["position"] = json_of(random_.in_cube(r / 2));
    if (random_.chance(0.3)) s["orientation"] = json_of(random_.rotation());
    return s;
  }

  void add_bodies() {
    Json& bodies = scene_["bodies"] = Json::array();
    const double half = size_ * std::cbrt(count_) * (contacts_ ? 0.8 : 0.6);
    for (int i = 0; i < count_; ++i) {
      const double m = mass_ * std::pow(10.0, random_.uniform(-mass_decades_ / 2, mass_decades_ / 2));
      const Vec3 half_size =
          size_ * Vec3(random_.uniform(0.1, 0.5), random_.uniform(0.1, 0.5), random_.uniform(0.1, 0.5));
      const Vec3 s = half_size.cwiseProduct(half_size);
      Json body = {{"name", "b" + std::to_string(i)},
                   {"mass", m},
                   {"inertia", json_of(Vec3(m / 3 * Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y())))}};
      places_.push_back(random_.in_cube(half) + Vec3(0, 0, contacts_ && !free_ ? half : 0));
      body["position"] = json_of(places_.back());
      body["orientation"] = json_of(random_.rotation());
      if (speed_ > 0) {
        body["velocity"] = json_of(Vec3(speed_ * random_.in_cube(1)));
        body["angular_velocity"] = json_of(Vec3(speed_ / size_ * random_.in_cube(1)));
      }
      if (contacts_ && random_.chance(0.8)) {
        Json shapes = Json::array({shape()});
        if (random_.chance(0.2)) shapes.push_back(shape());
        body["shapes"] = shapes;
      }
      bodies.push_back(body);
    }
  }

  std::string body_name(int i) const { return i < 0 ? "ground" : "b" + std::to_string(i); }
  Vec3 place(int i) const { return i < 0 ? Vec3(0, 0, size_) : places_[i]; }
  Vec3 near(int i, int j) {
    const double t = random_.chance(0.2) ? 0 : random_.uniform(0, 1);
    return (1 - t) * place(i) + t * place(j) + random_.in_cube(0.3 * size_);
  }

  void add_joints() {
    scene_["joints"] = Json::array();
    for (int i = 0; i < count_; ++i) {
      int parent = i == 0 ? -1 : random_.chance(0.1) ? -1 : random_.below(i);
      if (parent < 0 && free_) {
        if (i == 0) continue;
        parent = random_.below(i);
      }
      if (random_.chance(contacts_ ? 0.5 : 0.07)) continue;  // loose
      add_joint(parent, i);
    }
    const int loops = random_.chance(0.4) ? 1 + random_.below(3) : 0;
    for (int k = 0; k < loops; ++k) {
      const int a = random_.below(count_ + (free_ ? 0 : 1)) - (free_ ? 0 : 1), b = random_.below(count_);
      if (a != b) add_joint(a, b);
    }
  }

  void add_joint(int a, int b) {
    static const std::vector<std::string> kTypes = {
        "ball",     "ball",        "hinge",  "hinge",          "slider",        "fixed",  "universal",
        "distance", "cylindrical", "screw",  "planar",         "point_on_line", "hinge2", "six_dof",
        "rope",     "wire",        "pulley", "point_on_curve", "pose_driver"};
    std::string type = random_.of(kTypes);
    if (free_ && type == "pose_driver") type = "ball";
    if (plain_ && (type == "rope" || type == "wire")) type = "distance";
    const Vec3 anchor = near(a, b);
    Vec3 axis = random_.direction();
    Json j = {{"name", "j" + std::to_string(scene_["joints"].size())},
              {"type", type},
              {"a", body_name(a)},
              {"b", body_name(b)}};
    if (type == "distance" || type == "rope") {
      const Vec3 p = place(a) + random_.in_cube(0.3 * size_), q = place(b) + random_.in_cube(0.3 * size_);
      if ((q - p).norm() < 1e-3 * size_) return;
      j.update({{"frame", "world"}, {"anchor_a", json_of(p)}, {"anchor_b", json_of(q)}});
      if (type == "rope") {
        j["length"] = (q - p).norm() * (random_.chance(0.5) ? 1 : random_.uniform(1, 1.3)) * (1 + 1e-12);
        if (random_.chance(0.3)) j["restitution"] = random_.uniform(0, 1);
      }
    } else if (type == "wire" || type == "pulley") {
      if (!add_wire(j, type, a, b)) return;
    } else {
      j["anchor"] = json_of(anchor);
      add_axes_of_type(j, type, axis, anchor, a);
    }
    add_properties(j);
    scene_["joints"].push_back(j);
  }

  bool add_wire(Json& j, const std::string& type, int a, int b) {
    int c = random_.below(count_);
    if (!free_ && random_.chance(0.5)) c = -1;
    if (c == a || c == b || a == b) return false;
    std::vector<std::pair<int, Vec3>> points = {{a, place(a) + random_.in_cube(0.3 * size_)},
                                                {c, place(c) + random_.in_cube(0.3 * size_)},
                                                {c, place(c) + random_.in_cube(0.3 * size_)},
                                                {b, place(b) + random_.in_cube(0.3 * size_)}};
    double way = 0;
    Json list = Json::array();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) way += (points[i].second - points[i - 1].second).norm();
      list.push_back({{"body", body_name(points[i].first)}, {"point", json_of(points[i].second)}});
    }
    j.erase("a"), j.erase("b");
    j.update({{"frame", "world"}, {"points", list}});
    if (type == "wire") {
      j["type"] = "rope";
      j["length"] = way * (random_.chance(0.5) ? 1 + 1e-12 : random_.uniform(1, 1.3));
    } else if (random_.chance(0.5)) {
      j["ratio"] = random_.uniform(0.5, 3);
    }
    return true;
  }

  void add_axes_of_type(Json& j, const std::string& type, const Vec3& axis, const Vec3& anchor, int a) {
    if (type == "hinge" || type == "slider" || type == "cylindrical" || type == "screw" || type == "planar" ||
        type == "point_on_line")
      j["axis"] = json_of(axis);
    if (type == "screw") j["pitch"] = size_ * random_.uniform(0.05, 1) * (random_.chance(0.5) ? 1 : -1);
    if (type == "universal" || type == "hinge2") {
      const Vec3 across = axis.cross(random_.direction());
      const Vec3 second = across.norm() > 0.01 ? Vec3(across.normalized()) : Vec3(axis.unitOrthogonal());
      j.update({{"frame", "world"}, {"axis_a", json_of(axis)}, {"axis_b", json_of(second)}});
    }
    if (type == "ball" && random_.chance(0.4)) j["frame_orientation"] = json_of(random_.rotation());
    if (type == "six_dof") {
      Json locked = Json::array();
      for (const char* lock : {"x", "y", "z", "angle_x", "angle_y", "angle_z"})
        if (random_.chance(0.55)) locked.push_back(lock);
      j.update({{"locked", locked}, {"frame_orientation", json_of(random_.rotation())}});
    }
    if (type == "point_on_curve") {
      Json points = Json::array();
      const bool straight = random_.chance(0.5);
      for (int i = -2; i <= 3; ++i)
        points.push_back(
            json_of(Vec3(anchor + size_ * (0.5 * i * axis +
                                           (straight || i == 0 ? Vec3(0, 0, 0) : random_.in_cube(0.2))))));
      j["points"] = points;
      j["frame"] = "world";
      j["anchor_b"] = j["anchor"];
      j.erase("anchor");
    }
    if (type == "pose_driver") add_pose_driver(j, a);
  }

  /// Where it starts it is where B is: only B's displacement from there is driven, and turns begin with 0.
  void add_pose_driver(Json& j, int a) {
    j.erase("anchor");
    if (a >= 0) j["a"] = "ground";
    const Vec3 p = place(std::stoi(j["b"].get<std::string>().substr(1)));
    Json position = Json::array();
    for (int i = 0; i < 3; ++i) position.push_back(motion(p[i], 0.5 * size_));
    j["position"] = position;
    if (random_.chance(0.5)) j["turns"] = {{{"axis", json_of(random_.direction())}, {"angle", motion(0, 1)}}};
  }

  Json motion(double start, double amplitude) {
    const double omega = 1 / (dt_ * random_.uniform(8, 60));
    if (random_.chance(0.5))
      return {{"linear", {{"value", start}, {"rate", amplitude * omega * random_.uniform(-1, 1)}}}};
    return {{"harmonic",
             {{"mean", start},
              {"amplitude", amplitude * random_.uniform(0, 1)},
              {"omega", omega},
              {"phase", 0}}}};
  }

  double force() const { return mass_ * g_; }

  Json table(double x, double y) {
    return Json::array({Json::array({-x, -y * random_.uniform(0.5, 2)}), Json::array({0, 0}),
                        Json::array({x, y * random_.uniform(0.5, 2)})});
  }

  void add_properties(Json& j) {
    if (plain_) return;
    if (random_.chance(0.1)) {
      Json& c = j["compliance"] = Json::object();
      const double soft = size_ / force() * random_.decades(-6, -1);
      if (random_.chance(0.8)) c["translation"] = soft;
      if (random_.chance(0.5)) c["rotation"] = soft / (size_ * size_);
      if (random_.chance(0.5)) c["translation_damping"] = force() / size_ * dt_ * random_.decades(-2, 2);
      if (c.empty()) c["translation"] = soft;
    }
    if (!moreau_ && random_.chance(0.12)) j["break"] = {{"force", force() * random_.decades(-1, 3)}};
    if (random_.chance(0.03)) j["attached"] = false;
    Json axes = Json::object();
    for (const AxisName& axis : axes_of(j)) {
      if (!random_.chance(0.35)) continue;
      Json p = properties(axis);
      if (!p.empty()) axes[axis.name] = p;
    }
    if (!axes.empty()) j["axes"] = axes;
  }

  Json properties(const AxisName& axis) {
    Json p = Json::object();
    const double length = axis.angular ? 1 : size_, push = axis.angular ? force() * size_ : force();
    const double rate = length / std::sqrt(size_ / g_);
    if (axis.has_position && random_.chance(0.4)) {
      p["limits"] = {{"lower", -length * random_.uniform(0, 1)}, {"upper", length * random_.uniform(0, 1)}};
      if (random_.chance(0.3))
        p["limits"]["restitution"] = random_.uniform(0, 1);
      else if (random_.chance(0.3))
        p["limits"].update({{"compliance", length / push * random_.decades(-5, -1)},
                            {"damping", push / rate * random_.decades(-4, 0)}});
    }
    if (!free_ && random_.chance(0.2)) {
      Json& m = p["motor"] = Json::object();
      const int mode = axis.has_position ? random_.below(3) : 0;
      if (mode == 0) m["velocity"] = rate * random_.uniform(-1, 1);
      if (mode == 1) m["position"] = length * random_.uniform(-0.3, 0.3);
      if (mode == 2) m["trajectory"] = motion(0, 0.5 * length);
      if (random_.chance(0.8)) m["max_force"] = push * random_.decades(-2, 2);
      if (mode != 0) m["max_speed"] = rate * random_.decades(-1, 1);
    }
    if (random_.chance(0.4)) {
      Json& f = p["friction"] = Json::object();
      f["static"] = push * random_.decades(-3, 1);
      f["dynamic"] = f["static"].get<double>() * random_.uniform(0, 1);
      if (random_.chance(0.3)) f["viscous"] = push / rate * random_.decades(-3, 1);
      if (random_.chance(0.2)) f["per_load"] = axis.angular ? 0.01 * size_ : 0.1;
    }
    if (axis.has_position && random_.chance(0.4)) {
      Json& s = p["spring"] = Json::object();
      const double k = push / length * random_.decades(-2, 3);
      if (random_.chance(0.8))
        s["stiffness"] = k, s["rest"] = length * random_.uniform(-0.2, 0.2);
      else
        s["table"] = table(length, k * length);
      if (random_.chance(0.4)) s["damping"] = push / rate * random_.decades(-3, 1);
    }
    return p;
  }

  /// Gears and the like between axes that are there.
  void add_couplings() {
    std::vector<Json> angles, lengths;
    for (const Json& j : scene_["joints"])
      if (j.value("attached", true))
        for (const AxisName& axis : axes_of(j))
          if (axis.has_position && std::string(axis.name) != "swing" && std::string(axis.name) != "parameter")
            (axis.angular ? angles : lengths).push_back({{"joint", j["name"]}, {"axis", axis.name}});
    const auto name = [&] { return "j" + std::to_string(scene_["joints"].size()); };
    if (angles.size() >= 2 && random_.chance(0.3)) {
      const Json driving = random_.of(angles), driven = random_.of(angles);
      if (driving != driven)
        scene_["joints"].push_back({{"name", name()},
                                    {"type", "gear"},
                                    {"driving", driving},
                                    {"driven", driven},
                                    {"ratio", random_.uniform(0.3, 3) * (random_.chance(0.5) ? 1 : -1)}});
    }
    if (!angles.empty() && !lengths.empty() && random_.chance(0.2))
      scene_["joints"].push_back({{"name", name()},
                                  {"type", "rack_and_pinion"},
                                  {"pinion", random_.of(angles)},
                                  {"rack", random_.of(lengths)},
                                  {"radius", size_ * random_.uniform(0.1, 0.5)}});
    if (angles.size() >= 3 && random_.chance(0.2)) {
      const int i = random_.below(static_cast<int>(angles.size()) - 2);
      scene_["joints"].push_back({{"name", name()},
                                  {"type", "differential"},
                                  {"input", angles[i]},
                                  {"left", angles[i + 1]},
                                  {"right", angles[i + 2]}});
    }
    if (!free_ && random_.chance(0.15) && angles.size() + lengths.size() > 0) {
      const bool turns = lengths.empty() || (!angles.empty() && random_.chance(0.5));
      scene_["joints"].push_back({{"name", name()},
                                  {"type", "driver"},
                                  {"of", random_.of(turns ? angles : lengths)},
                                  {"motion", motion(0, turns ? 0.5 : 0.3 * size_)}});
    }
  }

  void add_forces() {
    Json forces = Json::array();
    const int springs = random_.chance(0.35) ? 1 + random_.below(3) : 0;
    for (int k = 0; k < springs; ++k) {
      const int a = free_ ? random_.below(count_) : random_.below(count_ + 1) - 1, b = random_.below(count_);
      if (a == b) continue;
      Json s = {{"type", "spring-damper"},
                {"a", body_name(a)},
                {"b", body_name(b)},
                {"frame", "world"},
                {"anchor_a", json_of(Vec3(place(a) + random_.in_cube(0.3 * size_)))},
                {"anchor_b", json_of(Vec3(place(b) + random_.in_cube(0.3 * size_)))}};
      const double stiff = force() / size_ * random_.decades(-2, 4);
      if (random_.chance(0.85))
        s["stiffness"] = stiff;
      else
        s["table"] = table(size_, stiff * size_);
      if (random_.chance(0.5)) s["rest_length"] = size_ * random_.uniform(0, 1.5);
      if (random_.chance(0.4)) s["damping"] = stiff * dt_ * random_.decades(-2, 2);
      forces.push_back(s);
    }
    if (!free_ && random_.chance(0.15))
      forces.push_back({{"type", "point-force"},
                        {"body", body_name(random_.below(count_))},
                        {"force", json_of(Vec3(force() * random_.decades(-2, 1) * random_.direction()))},
                        {"point", json_of(random_.in_cube(0.3 * size_))},
                        {"follows_body", random_.chance(0.5)}});
    if (!free_ && random_.chance(0.1))
      forces.push_back(
          {{"type", "torque"},
           {"body", body_name(random_.below(count_))},
           {"torque", json_of(Vec3(force() * size_ * random_.decades(-2, 0) * random_.direction()))}});
    if (!forces.empty()) scene_["forces"] = forces;
  }

  void add_ground() {
    if (free_) return;
    Json shape;
    if (random_.chance(0.7)) {
      shape = {{"type", "half_space"}};
    } else {
      Json heights = Json::array();
      for (int i = 0; i < 36; ++i) heights.push_back(size_ * random_.uniform(-0.2, 0));
      shape = {{"type", "height_field"}, {"nx", 6}, {"ny", 6}, {"dx", size_}, {"dy", size_},
               {"heights", heights}};
    }
    shape["material"] = material();
    scene_["ground"] = {{"shapes", Json::array({shape})}};
  }

  Random random_;
  Json scene_;
  double size_ = 1, mass_ = 1, mass_decades_ = 0, g_ = 9.81, speed_ = 0, dt_ = 0;
  int count_ = 2;
  bool free_ = false, plain_ = false, moreau_ = false, contacts_ = false;
  std::vector<Vec3> places_;
};

}  // namespace

nlohmann::json make_mechanism(std::uint64_t seed) { return Maker(seed).make(); }

}  // namespace taut::fuzz
