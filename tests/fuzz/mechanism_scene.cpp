#include <cmath>
#include <string>
#include <utility>

#include "tests/fuzz/mechanism.h"
#include "tests/fuzz/mechanism_draft.h"

namespace taut::fuzz {
namespace {

/// Scales, settings, bodies, forces and the ground; joints are those of mechanism_joints.cpp.
class Maker {
 public:
  explicit Maker(std::uint64_t seed) : draft_(seed) {
    draft_.scene["format"] = "taut-scene/1";
    draft_.scene["name"] = "mechanism " + std::to_string(seed);
    choose_scales();
    choose_settings();
  }

  Json make() {
    add_bodies();
    add_joints(draft_);
    if (!draft_.plain) add_couplings(draft_);
    add_forces();
    if (draft_.contacts) add_ground();
    return std::move(draft_.scene);
  }

 private:
  void choose_scales() {
    draft_.size = draft_.random.chance(0.4) ? draft_.random.decades(-1, 1) : draft_.random.decades(-3, 3);
    draft_.mass = draft_.random.decades(-3, 3);
    draft_.mass_decades = draft_.random.chance(0.5) ? 1 : draft_.random.uniform(0, 12);
    draft_.free = draft_.random.chance(0.35);
    draft_.g = draft_.random.chance(0.8) ? 9.81 : draft_.random.decades(-2, 2);
    const Vec3 down = draft_.random.chance(0.8) ? Vec3(0, 0, -1) : draft_.random.direction();
    draft_.scene["gravity"] = json_of(draft_.free ? Vec3(0, 0, 0) : Vec3(draft_.g * down));
    draft_.speed =
        std::sqrt(draft_.g * draft_.size) * (draft_.random.chance(0.3) ? 0 : draft_.random.decades(-2, 0.7));
    const double period = std::sqrt(draft_.size / draft_.g);
    draft_.dt = period / draft_.random.decades(0.7, 3);
    draft_.scene["dt"] = draft_.dt;
    draft_.scene["duration"] = (10 + draft_.random.below(31)) * draft_.dt;
    draft_.count = 2 + draft_.random.below(draft_.random.chance(0.2) ? 11 : 6);
  }

  void choose_settings() {
    Json& settings = draft_.scene["settings"] = Json::object();
    const double kind = draft_.random.uniform(0, 1);
    draft_.plain = false;
    if (kind < 0.15) {
      settings["integrator"] = draft_.random.of<std::string>({"rattle4", "rattle6", "rattle8"});
      draft_.plain = true;
    } else if (kind < 0.25) {
      settings["integrator"] = draft_.random.of<std::string>({"force-euler", "force-runge-kutta"});
      if (draft_.random.chance(0.5))
        settings["drift_cure"] = draft_.random.of<std::string>(
            {"none", "baumgarte", "velocity-impulse", "position-push", "penalty"});
      draft_.plain = true;
    } else if (kind < 0.37) {
      settings["integrator"] = "moreau-jean";
      if (draft_.random.chance(0.3)) settings["theta"] = draft_.random.uniform(0.5, 1);
      if (draft_.random.chance(0.1)) settings["drift_cure"] = "none";
      draft_.moreau = true;
    } else if (kind < 0.45) {
      settings["solver"] = draft_.random.of<std::string>({"gauss-seidel", "pairwise", "propagation"});
      settings["iterations"] = 10 + draft_.random.below(40);
    } else {
      if (draft_.random.chance(0.25)) settings["tension"] = "implicit";
      if (draft_.random.chance(0.05)) settings["tension"] = "ignore";
      if (draft_.random.chance(0.2)) settings["merge_fixed_joints"] = true;
      if (draft_.random.chance(0.15))
        settings["sleep"] = true, settings["sleep_time"] = 3 * draft_.dt,
        settings["sleep_speed"] = 0.05 * std::sqrt(draft_.g * draft_.size);
      if (draft_.random.chance(0.3))
        settings["factor"] =
            draft_.random.of<std::string>({"cholmod", "simplicial", "supernodal", "multifrontal"});
      if (draft_.random.chance(0.05)) settings["report_rank"] = true;
    }
    settings["max_substeps"] = 64;  // a mechanism that needs more is a failed step, and not a slow one
    draft_.contacts = !draft_.plain && draft_.random.chance(0.3);
    if (draft_.contacts) settings["contact_margin"] = 0.005 * draft_.size;
  }

  Json material() {
    Json m = {{"static_friction", draft_.random.chance(0.3) ? 0 : draft_.random.uniform(0, 1.2)}};
    if (draft_.random.chance(0.3)) m["restitution"] = draft_.random.uniform(0, 1);
    if (draft_.random.chance(0.2)) m["rolling_friction"] = draft_.random.uniform(0, 0.01 * draft_.size);
    if (draft_.random.chance(0.1)) m["spinning_friction"] = draft_.random.uniform(0, 0.01 * draft_.size);
    if (!draft_.moreau && draft_.random.chance(0.3))
      m["compliance"] = draft_.size / (draft_.mass * draft_.g) * draft_.random.decades(-6, -2);
    return m;
  }

  Json shape() {
    const double r = draft_.size * draft_.random.uniform(0.1, 0.35);
    Json s;
    switch (draft_.random.below(8)) {
      case 0:
        s = {{"type", "box"}, {"size", json_of(Vec3(r, r, r) + draft_.random.in_cube(r / 2))}};
        break;
      case 1:
        s = {{"type", "capsule"}, {"radius", r / 2}, {"length", r * draft_.random.uniform(0, 2)}};
        break;
      case 2:
        s = {{"type", "cylinder"}, {"radius", r / 2}, {"length", r * draft_.random.uniform(0.1, 2)}};
        break;
      case 3:
        s = {{"type", "ellipsoid"}, {"radii", json_of(Vec3(r, r, r) + draft_.random.in_cube(r / 2))}};
        break;
      case 4:
        s = {{"type", "cone"}, {"radius", r / 2}, {"height", r}};
        break;
      case 5: {
        Json points = Json::array();
        const int n = 5 + draft_.random.below(6);
        for (int i = 0; i < n; ++i) points.push_back(json_of(Vec3(r * draft_.random.direction())));
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
    if (draft_.random.chance(0.2)) s["position"] = json_of(draft_.random.in_cube(r / 2));
    if (draft_.random.chance(0.3)) s["orientation"] = json_of(draft_.random.rotation());
    return s;
  }

  void add_bodies() {
    Json& bodies = draft_.scene["bodies"] = Json::array();
    const double half = draft_.size * std::cbrt(draft_.count) * (draft_.contacts ? 0.8 : 0.6);
    for (int i = 0; i < draft_.count; ++i) {
      const double m = draft_.mass * std::pow(10.0, draft_.random.uniform(-draft_.mass_decades / 2,
                                                                          draft_.mass_decades / 2));
      const Vec3 half_size =
          draft_.size * Vec3(draft_.random.uniform(0.1, 0.5), draft_.random.uniform(0.1, 0.5),
                             draft_.random.uniform(0.1, 0.5));
      const Vec3 s = half_size.cwiseProduct(half_size);
      Json body = {{"name", "b" + std::to_string(i)},
                   {"mass", m},
                   {"inertia", json_of(Vec3(m / 3 * Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y())))}};
      draft_.places.push_back(draft_.random.in_cube(half) +
                              Vec3(0, 0, draft_.contacts && !draft_.free ? half : 0));
      body["position"] = json_of(draft_.places.back());
      body["orientation"] = json_of(draft_.random.rotation());
      if (draft_.speed > 0) {
        body["velocity"] = json_of(Vec3(draft_.speed * draft_.random.in_cube(1)));
        body["angular_velocity"] = json_of(Vec3(draft_.speed / draft_.size * draft_.random.in_cube(1)));
      }
      if (draft_.contacts && draft_.random.chance(0.8)) {
        Json shapes = Json::array({shape()});
        if (draft_.random.chance(0.2)) shapes.push_back(shape());
        body["shapes"] = shapes;
      }
      bodies.push_back(body);
    }
  }

  void add_forces() {
    Json forces = Json::array();
    const int springs = draft_.random.chance(0.35) ? 1 + draft_.random.below(3) : 0;
    for (int k = 0; k < springs; ++k) {
      const int a = draft_.free ? draft_.random.below(draft_.count)
                                : draft_.random.below(draft_.count + 1) - 1,
                b = draft_.random.below(draft_.count);
      if (a == b) continue;
      Json s = {{"type", "spring-damper"},
                {"a", draft_.body_name(a)},
                {"b", draft_.body_name(b)},
                {"frame", "world"},
                {"anchor_a", json_of(Vec3(draft_.place(a) + draft_.random.in_cube(0.3 * draft_.size)))},
                {"anchor_b", json_of(Vec3(draft_.place(b) + draft_.random.in_cube(0.3 * draft_.size)))}};
      const double stiff = draft_.force() / draft_.size * draft_.random.decades(-2, 4);
      if (draft_.random.chance(0.85))
        s["stiffness"] = stiff;
      else
        s["table"] = draft_.table(draft_.size, stiff * draft_.size);
      if (draft_.random.chance(0.5)) s["rest_length"] = draft_.size * draft_.random.uniform(0, 1.5);
      if (draft_.random.chance(0.4)) s["damping"] = stiff * draft_.dt * draft_.random.decades(-2, 2);
      forces.push_back(s);
    }
    if (!draft_.free && draft_.random.chance(0.15))
      forces.push_back({{"type", "point-force"},
                        {"body", draft_.body_name(draft_.random.below(draft_.count))},
                        {"force", json_of(Vec3(draft_.force() * draft_.random.decades(-2, 1) *
                                               draft_.random.direction()))},
                        {"point", json_of(draft_.random.in_cube(0.3 * draft_.size))},
                        {"follows_body", draft_.random.chance(0.5)}});
    if (!draft_.free && draft_.random.chance(0.1))
      forces.push_back({{"type", "torque"},
                        {"body", draft_.body_name(draft_.random.below(draft_.count))},
                        {"torque", json_of(Vec3(draft_.force() * draft_.size * draft_.random.decades(-2, 0) *
                                                draft_.random.direction()))}});
    if (!forces.empty()) draft_.scene["forces"] = forces;
  }

  void add_ground() {
    if (draft_.free) return;
    Json shape;
    if (draft_.random.chance(0.7)) {
      shape = {{"type", "half_space"}};
    } else {
      Json heights = Json::array();
      for (int i = 0; i < 36; ++i) heights.push_back(draft_.size * draft_.random.uniform(-0.2, 0));
      shape = {{"type", "height_field"}, {"nx", 6},           {"ny", 6},
               {"dx", draft_.size},      {"dy", draft_.size}, {"heights", heights}};
    }
    shape["material"] = material();
    draft_.scene["ground"] = {{"shapes", Json::array({shape})}};
  }

  MechanismDraft draft_;
};

}  // namespace

nlohmann::json make_mechanism(std::uint64_t seed) { return Maker(seed).make(); }

}  // namespace taut::fuzz
