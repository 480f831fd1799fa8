#include <algorithm>

#include "tests/fuzz/mechanism_draft.h"

namespace taut::fuzz {
namespace {

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

class JointMaker {
 public:
  explicit JointMaker(MechanismDraft& draft) : draft_(draft) {}

  void add_joints() {
    draft_.scene["joints"] = Json::array();
    for (int i = 0; i < draft_.count; ++i) {
      int parent = i == 0 ? -1 : draft_.random.chance(0.1) ? -1 : draft_.random.below(i);
      if (parent < 0 && draft_.free) {
        if (i == 0) continue;
        parent = draft_.random.below(i);
      }
      if (draft_.random.chance(draft_.contacts ? 0.5 : 0.07)) continue;  // loose
      add_joint(parent, i);
    }
    const int loops = draft_.random.chance(0.4) ? 1 + draft_.random.below(3) : 0;
    for (int k = 0; k < loops; ++k) {
      const int a = draft_.random.below(draft_.count + (draft_.free ? 0 : 1)) - (draft_.free ? 0 : 1),
                b = draft_.random.below(draft_.count);
      if (a != b) add_joint(a, b);
    }
  }

  void add_couplings() {
    std::vector<Json> angles, lengths;
    for (const Json& j : draft_.scene["joints"])
      if (j.value("attached", true))
        for (const AxisName& axis : axes_of(j))
          if (axis.has_position && std::string(axis.name) != "swing" && std::string(axis.name) != "parameter")
            (axis.angular ? angles : lengths).push_back({{"joint", j["name"]}, {"axis", axis.name}});
    const auto name = [&] { return "j" + std::to_string(draft_.scene["joints"].size()); };
    if (angles.size() >= 2 && draft_.random.chance(0.3)) {
      const Json driving = draft_.random.of(angles), driven = draft_.random.of(angles);
      if (driving != driven)
        draft_.scene["joints"].push_back(
            {{"name", name()},
             {"type", "gear"},
             {"driving", driving},
             {"driven", driven},
             {"ratio", draft_.random.uniform(0.3, 3) * (draft_.random.chance(0.5) ? 1 : -1)}});
    }
    if (!angles.empty() && !lengths.empty() && draft_.random.chance(0.2))
      draft_.scene["joints"].push_back({{"name", name()},
                                        {"type", "rack_and_pinion"},
                                        {"pinion", draft_.random.of(angles)},
                                        {"rack", draft_.random.of(lengths)},
                                        {"radius", draft_.size * draft_.random.uniform(0.1, 0.5)}});
    if (angles.size() >= 3 && draft_.random.chance(0.2)) {
      const int i = draft_.random.below(static_cast<int>(angles.size()) - 2);
      draft_.scene["joints"].push_back({{"name", name()},
                                        {"type", "differential"},
                                        {"input", angles[i]},
                                        {"left", angles[i + 1]},
                                        {"right", angles[i + 2]}});
    }
    if (!draft_.free && draft_.random.chance(0.15) && angles.size() + lengths.size() > 0) {
      const bool turns = lengths.empty() || (!angles.empty() && draft_.random.chance(0.5));
      draft_.scene["joints"].push_back({{"name", name()},
                                        {"type", "driver"},
                                        {"of", draft_.random.of(turns ? angles : lengths)},
                                        {"motion", motion(0, turns ? 0.5 : 0.3 * draft_.size)}});
    }
  }

 private:
  Vec3 near(int i, int j) {
    const double t = draft_.random.chance(0.2) ? 0 : draft_.random.uniform(0, 1);
    return (1 - t) * draft_.place(i) + t * draft_.place(j) + draft_.random.in_cube(0.3 * draft_.size);
  }

  void add_joint(int a, int b) {
    static const std::vector<std::string> kTypes = {
        "ball",     "ball",        "hinge",  "hinge",          "slider",        "fixed",  "universal",
        "distance", "cylindrical", "screw",  "planar",         "point_on_line", "hinge2", "six_dof",
        "rope",     "wire",        "pulley", "point_on_curve", "pose_driver"};
    std::string type = draft_.random.of(kTypes);
    if (draft_.free && type == "pose_driver") type = "ball";
    if (draft_.plain && (type == "rope" || type == "wire")) type = "distance";
    const Vec3 anchor = near(a, b);
    Vec3 axis = draft_.random.direction();
    Json j = {{"name", "j" + std::to_string(draft_.scene["joints"].size())},
              {"type", type},
              {"a", draft_.body_name(a)},
              {"b", draft_.body_name(b)}};
    if (type == "distance" || type == "rope") {
      const Vec3 p = draft_.place(a) + draft_.random.in_cube(0.3 * draft_.size),
                 q = draft_.place(b) + draft_.random.in_cube(0.3 * draft_.size);
      if ((q - p).norm() < 1e-3 * draft_.size) return;
      j.update({{"frame", "world"}, {"anchor_a", json_of(p)}, {"anchor_b", json_of(q)}});
      if (type == "rope") {
        j["length"] =
            (q - p).norm() * (draft_.random.chance(0.5) ? 1 : draft_.random.uniform(1, 1.3)) * (1 + 1e-12);
        if (draft_.random.chance(0.3)) j["restitution"] = draft_.random.uniform(0, 1);
      }
    } else if (type == "wire" || type == "pulley") {
      if (!add_wire(j, type, a, b)) return;
    } else {
      j["anchor"] = json_of(anchor);
      add_axes_of_type(j, type, axis, anchor, a);
    }
    add_properties(j);
    draft_.scene["joints"].push_back(j);
  }

  bool add_wire(Json& j, const std::string& type, int a, int b) {
    int c = draft_.random.below(draft_.count);
    if (!draft_.free && draft_.random.chance(0.5)) c = -1;
    if (c == a || c == b || a == b) return false;
    std::vector<std::pair<int, Vec3>> points = {
        {a, draft_.place(a) + draft_.random.in_cube(0.3 * draft_.size)},
        {c, draft_.place(c) + draft_.random.in_cube(0.3 * draft_.size)},
        {c, draft_.place(c) + draft_.random.in_cube(0.3 * draft_.size)},
        {b, draft_.place(b) + draft_.random.in_cube(0.3 * draft_.size)}};
    double way = 0;
    Json list = Json::array();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) way += (points[i].second - points[i - 1].second).norm();
      list.push_back({{"body", draft_.body_name(points[i].first)}, {"point", json_of(points[i].second)}});
    }
    j.erase("a"), j.erase("b");
    j.update({{"frame", "world"}, {"points", list}});
    if (type == "wire") {
      j["type"] = "rope";
      j["length"] = way * (draft_.random.chance(0.5) ? 1 + 1e-12 : draft_.random.uniform(1, 1.3));
    } else if (draft_.random.chance(0.5)) {
      j["ratio"] = draft_.random.uniform(0.5, 3);
    }
    return true;
  }

  void add_axes_of_type(Json& j, const std::string& type, const Vec3& axis, const Vec3& anchor, int a) {
    if (type == "hinge" || type == "slider" || type == "cylindrical" || type == "screw" || type == "planar" ||
        type == "point_on_line")
      j["axis"] = json_of(axis);
    if (type == "screw")
      j["pitch"] = draft_.size * draft_.random.uniform(0.05, 1) * (draft_.random.chance(0.5) ? 1 : -1);
    if (type == "universal" || type == "hinge2") {
      const Vec3 across = axis.cross(draft_.random.direction());
      const Vec3 second = across.norm() > 0.01 ? Vec3(across.normalized()) : Vec3(axis.unitOrthogonal());
      j.update({{"frame", "world"}, {"axis_a", json_of(axis)}, {"axis_b", json_of(second)}});
    }
    if (type == "ball" && draft_.random.chance(0.4))
      j["frame_orientation"] = json_of(draft_.random.rotation());
    if (type == "six_dof") {
      Json locked = Json::array();
      for (const char* lock : {"x", "y", "z", "angle_x", "angle_y", "angle_z"})
        if (draft_.random.chance(0.55)) locked.push_back(lock);
      j.update({{"locked", locked}, {"frame_orientation", json_of(draft_.random.rotation())}});
    }
    if (type == "point_on_curve") {
      Json points = Json::array();
      const bool straight = draft_.random.chance(0.5);
      for (int i = -2; i <= 3; ++i)
        points.push_back(json_of(Vec3(
            anchor + draft_.size * (0.5 * i * axis +
                                    (straight || i == 0 ? Vec3(0, 0, 0) : draft_.random.in_cube(0.2))))));
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
    const Vec3 p = draft_.place(std::stoi(j["b"].get<std::string>().substr(1)));
    Json position = Json::array();
    for (int i = 0; i < 3; ++i) position.push_back(motion(p[i], 0.5 * draft_.size));
    j["position"] = position;
    if (draft_.random.chance(0.5))
      j["turns"] = {{{"axis", json_of(draft_.random.direction())}, {"angle", motion(0, 1)}}};
  }

  Json motion(double start, double amplitude) {
    const double omega = 1 / (draft_.dt * draft_.random.uniform(8, 60));
    if (draft_.random.chance(0.5))
      return {{"linear", {{"value", start}, {"rate", amplitude * omega * draft_.random.uniform(-1, 1)}}}};
    return {{"harmonic",
             {{"mean", start},
              {"amplitude", amplitude * draft_.random.uniform(0, 1)},
              {"omega", omega},
              {"phase", 0}}}};
  }

  void add_properties(Json& j) {
    if (draft_.plain) return;
    if (draft_.random.chance(0.1)) {
      Json& c = j["compliance"] = Json::object();
      const double soft = draft_.size / draft_.force() * draft_.random.decades(-6, -1);
      if (draft_.random.chance(0.8)) c["translation"] = soft;
      if (draft_.random.chance(0.5)) c["rotation"] = soft / (draft_.size * draft_.size);
      if (draft_.random.chance(0.5))
        c["translation_damping"] = draft_.force() / draft_.size * draft_.dt * draft_.random.decades(-2, 2);
      if (c.empty()) c["translation"] = soft;
    }
    if (!draft_.moreau && draft_.random.chance(0.12))
      j["break"] = {{"force", draft_.force() * draft_.random.decades(-1, 3)}};
    if (draft_.random.chance(0.03)) j["attached"] = false;
    Json axes = Json::object();
    for (const AxisName& axis : axes_of(j)) {
      if (!draft_.random.chance(0.35)) continue;
      Json p = properties(axis);
      if (!p.empty()) axes[axis.name] = p;
    }
    if (!axes.empty()) j["axes"] = axes;
  }

  Json properties(const AxisName& axis) {
    Json p = Json::object();
    const double length = axis.angular ? 1 : draft_.size,
                 push = axis.angular ? draft_.force() * draft_.size : draft_.force();
    const double rate = length / std::sqrt(draft_.size / draft_.g);
    if (axis.has_position && draft_.random.chance(0.4)) {
      p["limits"] = {{"lower", -length * draft_.random.uniform(0, 1)},
                     {"upper", length * draft_.random.uniform(0, 1)}};
      if (draft_.random.chance(0.3))
        p["limits"]["restitution"] = draft_.random.uniform(0, 1);
      else if (draft_.random.chance(0.3))
        p["limits"].update({{"compliance", length / push * draft_.random.decades(-5, -1)},
                            {"damping", push / rate * draft_.random.decades(-4, 0)}});
    }
    if (!draft_.free && draft_.random.chance(0.2)) {
      Json& m = p["motor"] = Json::object();
      const int mode = axis.has_position ? draft_.random.below(3) : 0;
      if (mode == 0) m["velocity"] = rate * draft_.random.uniform(-1, 1);
      if (mode == 1) m["position"] = length * draft_.random.uniform(-0.3, 0.3);
      if (mode == 2) m["trajectory"] = motion(0, 0.5 * length);
      if (draft_.random.chance(0.8)) m["max_force"] = push * draft_.random.decades(-2, 2);
      if (mode != 0) m["max_speed"] = rate * draft_.random.decades(-1, 1);
    }
    if (draft_.random.chance(0.4)) {
      Json& f = p["friction"] = Json::object();
      f["static"] = push * draft_.random.decades(-3, 1);
      f["dynamic"] = f["static"].get<double>() * draft_.random.uniform(0, 1);
      if (draft_.random.chance(0.3)) f["viscous"] = push / rate * draft_.random.decades(-3, 1);
      if (draft_.random.chance(0.2)) f["per_load"] = axis.angular ? 0.01 * draft_.size : 0.1;
    }
    if (axis.has_position && draft_.random.chance(0.4)) {
      Json& s = p["spring"] = Json::object();
      const double k = push / length * draft_.random.decades(-2, 3);
      if (draft_.random.chance(0.8))
        s["stiffness"] = k, s["rest"] = length * draft_.random.uniform(-0.2, 0.2);
      else
        s["table"] = draft_.table(length, k * length);
      if (draft_.random.chance(0.4)) s["damping"] = push / rate * draft_.random.decades(-3, 1);
    }
    return p;
  }

  MechanismDraft& draft_;
};

}  // namespace

void add_joints(MechanismDraft& draft) { JointMaker(draft).add_joints(); }

void add_couplings(MechanismDraft& draft) { JointMaker(draft).add_couplings(); }

}  // namespace taut::fuzz
