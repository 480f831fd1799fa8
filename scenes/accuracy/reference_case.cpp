#include "scenes/accuracy/reference_case.h"

#include <algorithm>

#include "core/joints/joints.h"
#include "scenes/accuracy/reference_builder.h"
#include "scenes/files/scene_file.h"

namespace taut::reference {
namespace {

using Json = nlohmann::json;

Quat quaternion_of(const Json& object, const char* key) {
  const Json& q = object.at(key);
  return Quat(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>())
      .normalized();
}

MassProperties mass_of(const Json& body) {
  const double mass = body.at("mass");
  const Json& inertia = body.at("inertia");
  if (inertia.at(0).is_number()) return {mass, vector_of(body, "inertia")};
  Mat3 I;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) I(i, j) = inertia.at(i).at(j);
  return {mass, I};
}

void add_body(Case& out, const Json& body) {
  BodySpec spec{.name = body_name(body.at("name")), .mass = mass_of(body)};
  spec.pose = {quaternion_of(body, "orientation"), vector_of(body, "position")};
  spec.twist = {vector_of(body, "angular_velocity"), vector_of(body, "velocity")};
  out.world.add_body(spec);
}

/// The straight hanging chain that its file describes by numbers only: rods along z on ball joints, a sphere
/// at the lower end.
void add_hanging_chain(Case& out, const Json& p) {
  const int n = p.at("N");
  const double length = p.at("rod_length"), section = p.at("section"), mass = p.at("rod_mass");
  BodyId last = kGround;
  for (int i = 1; i <= n + 1; ++i) {
    const bool end = i == n + 1;
    BodySpec spec;
    spec.name = end ? "sphere" : std::string("rod").append(std::to_string(i));
    spec.mass = end ? MassProperties::sphere(0.1, p.at("end_mass"))
                    : MassProperties::box(Vec3(section, section, length), mass);
    spec.pose.p = Vec3(0, 0, end ? -n * length : -(i - 0.5) * length);
    const BodyId body = out.world.add_body(spec);
    const Vec3 joint(0, 0, -(i - 1) * length);
    out.world.add(end ? "jend" : std::string("j").append(std::to_string(i)),
                  Ball::at(out.world, last, body, joint));
    last = body;
  }
}

Quantity quantity_of(const Json& json) {
  Quantity quantity;
  quantity.name = json.at("name");
  if (!json.at("time").is_null()) quantity.time = json.at("time").get<double>();
  const Json& value = json.at("value");
  if (value.is_array())
    quantity.value = value.get<std::vector<double>>();
  else
    quantity.value.push_back(value.get<double>());
  quantity.uncertainty = json.at("ref_uncertainty");
  quantity.tolerance = json.at("abs_tol");
  quantity.tolerance_limit = json.at("abs_tol_limit");
  if (json.contains("probe")) quantity.probe = json.at("probe");
  quantity.orientation = json.value("for_orientation", "");
  return quantity;
}

void add_bodies(Case& out, const Json& setup) {
  for (const Json& body : list_of(setup, "bodies")) add_body(out, body);
  if (out.world.body_count() > 1) return;
  const Json parameters = setup.value("parameters", Json::object());
  if (setup.contains("generator") && parameters.contains("rod_length") && parameters.contains("end_mass"))
    add_hanging_chain(out, parameters);
  else
    out.missing.emplace_back("the file lists no bodies");
}

void add_impulse(Case& out, const Json& impulse) {
  if (impulse.value("time", 0.0) != 0) fail("impulse", "must be at t = 0", impulse.dump());
  const BodyId body = find_body(out.world, impulse.at("body"));
  const Vec3 p_BP = out.world.pose(body).local(vector_of(impulse, "point"));
  out.impulses.push_back({body, p_BP, vector_of(impulse, "impulse")});
}

void read_setup(Case& out, const Json& setup) {
  if (setup.contains("duration") && setup.at("duration").is_number()) out.duration = setup.at("duration");
  out.world.set_gravity(vector_of(setup, "gravity"));
  add_bodies(out, setup);
  std::map<std::string, Json> drivers;
  for (const Json& driver : list_of(setup, "drivers")) drivers[driver.at("joint")] = driver;
  for (const Json& joint : list_of(setup, "joints")) {
    const auto driver = drivers.find(joint.at("name"));
    add_joint(out, driver == drivers.end() ? joint : with_driven_anchor(out, joint, driver->second));
  }
  for (const Json& force : list_of(setup, "forces")) add_force(out, force);
  for (const Json& impulse : list_of(setup, "impulses")) add_impulse(out, impulse);
  add_contacts(out, setup);
}

}  // namespace

bool Case::has_axis_properties() const {
  for (int j = 0; j < world.joint_count(); ++j)
    if (world.has_axis_properties(JointId{j})) return true;
  return false;
}

Json list_of(const Json& object, const char* key) {
  const Json list = object.value(key, Json::array());
  return list.is_null() ? Json::array() : list;
}

std::string body_name(const std::string& name) { return name == "ground" ? "the file's ground" : name; }

BodyId find_body(const World& world, const std::string& name) {
  return name == "world" ? kGround : world.body(body_name(name));
}

Vec3 vector_of(const Json& object, const char* key) {
  const Json& v = object.at(key);
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

BodyId add_carrier(Case& out, const std::string& name, const PoseMotion& motion) {
  BodySpec spec{.name = name};
  spec.pose = motion(0).pose;
  spec.twist = motion(0).velocity;
  const BodyId carrier = out.world.add_body(spec);
  out.world.add(name, PoseDriver(kGround, carrier, motion));
  out.carriers.insert(carrier);
  return carrier;
}

Case load_case(const std::filesystem::path& file) {
  const Json json = Json::parse(read_text_file(file));
  Case out;
  out.id = json.at("id");
  out.family = json.value("family", "");
  out.description = json.value("description", "");
  out.level = json.at("level");
  out.dt = json.at("tol_dt");
  read_setup(out, json.at("setup"));
  for (const Json& quantity : json.at("quantities")) out.quantities.push_back(quantity_of(quantity));
  return out;
}

std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) fail("references", "must be a folder", folder.string());
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json" && entry.path().filename() != "index.json")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace taut::reference
