#include "scenes/import/sdf_sensor.h"

namespace taut::model {

void read_sdf_sensor(XmlFiles& files, const pugi::xml_node& sensor, const LinkFrame& at, bool of_joint,
                     RobotModel& model) {
  const std::string name = files.required(sensor, "name"), type = files.required(sensor, "type");
  const std::string label = "<sensor> \"" + name + "\" of type " + type;
  const auto note = [&](const std::string& message) {
    model.notices.push_back({files.place(sensor), label + ": " + message, 1});
  };
  const auto probe = [&](const char* ending, const char* quantity) {
    model.probes.push_back({name + ending, quantity, at, {}, files.place(sensor)});
  };
  files.accept(sensor);
  if (type == "imu" && !of_joint) {
    probe("", "angular-velocity");
    probe("_orientation", "orientation");
    note("probes of the angular velocity and orientation of its link, in world axes; acceleration has none");
  } else if (type == "force_torque" && of_joint) {
    probe("_force", "reaction-force");
    probe("_torque", "reaction-torque");
    note("probes of the reaction of its joint on the child, in world axes");
  } else {
    files.accept_all(sensor);
    note("has no counterpart: left out");
  }
}

}  // namespace taut::model
