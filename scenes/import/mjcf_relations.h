#pragma once

#include "scenes/import/mjcf_names.h"

namespace taut::model {

/// What refers to bodies, joints and sites of a MJCF file: contact pairs, equalities, tendons, actuators,
/// sensors.
class MjcfRelations {
 public:
  MjcfRelations(XmlFiles& files, const MjcfDefaults& defaults, const MjcfCompiler& compiler,
                const MjcfNames& names, std::string prefix, RobotModel& model)
      : files_(files),
        defaults_(defaults),
        compiler_(compiler),
        names_(names),
        prefix_(std::move(prefix)),
        model_(model) {}
  void read(const pugi::xml_node& mujoco);

 private:
  /// In the whole; nameless things stay so.
  std::string name_of(const MjcfElement& element) const {
    const std::string name = element.text("name");
    return name.empty() ? name : prefix_ + name;
  }
  void read_contact(const pugi::xml_node& node);
  void give_surface(const MjcfElement& pair, Surface& a, Surface& b);
  void read_equality(const pugi::xml_node& node);
  void read_connect(const MjcfElement& connect, Loop loop);
  void read_weld(const MjcfElement& weld, Loop loop);
  void read_joint_equality(const MjcfElement& equality);
  void read_tendon(const pugi::xml_node& node);
  void read_tendon_equality(const pugi::xml_node& node);
  /// A joint as a part of a tendon that is a sum of joints, or by itself.
  struct FixedPart {
    AxisName axis;
    double coef = 1;
  };
  bool read_fixed(const MjcfElement& tendon);
  void act_by_itself(const MjcfElement& tendon, const std::vector<FixedPart>& parts);
  std::vector<FixedPart> sum_of(const std::string& first, const std::string& second, double factor) const;
  void relate(const MjcfElement& equality, const std::vector<FixedPart>& sum, double constant);
  bool is_differential(const std::vector<FixedPart>& sum, AxisRelation& relation) const;
  double length_of(const Wire& wire) const;
  void read_bar(const MjcfElement& equality, Wire bar);
  std::optional<FixedPart> transmission(const MjcfElement& actuator) const;
  void read_spatial(const MjcfElement& tendon);
  void read_pulley(const MjcfElement& tendon, Wire wire, const std::vector<double>& divisors,
                   const std::vector<std::size_t>& firsts);
  void read_spring(const MjcfElement& tendon, Wire& wire);
  void read_key(const pugi::xml_node& mujoco);
  pugi::xml_node start_key(const pugi::xml_node& mujoco);
  bool is_start(const MjcfElement& key) const;
  static bool is_at_rest(const MjcfElement& key);
  void give_velocities(const MjcfElement& key);
  void read_actuator(const pugi::xml_node& node);
  bool has_state(const MjcfElement& actuator) const;
  struct Gains {
    double gain = 1;
    std::vector<double> bias = std::vector<double>(3, 0.0);
  };
  std::optional<std::pair<double, double>> control_range(const MjcfElement& actuator, const AxisName& on);
  double damping_of(const MjcfElement& position, double kp, double gear, const AxisName& on);
  Gains gains_of(const MjcfElement& actuator, double control, double gear, const AxisName& on);
  AxisDrive drive_of(const MjcfElement& actuator, double control, const FixedPart& through);
  void act_on_joint(const MjcfElement& actuator, double control, const FixedPart& through);
  void read_sensor(const pugi::xml_node& node);
  bool frame_sensor(const MjcfElement& sensor, ModelProbe& probe);
  LinkFrame object_of(const MjcfElement& sensor);

  int body(const MjcfElement& element, const char* attribute) const;
  LinkFrame site(const MjcfElement& element, const char* attribute) const;
  AxisName joint(const MjcfElement& element, const char* attribute) const;
  LinkAxis& axis(const AxisName& name) { return model_.links[name.link].axes[name.axis]; }
  Pose pose(int link) const { return link == kWorld ? Pose{} : model_.links[link].X_WL; }
  void note(const MjcfElement& element, const std::string& message) {
    model_.notices.push_back({element.place(), message, 1});
  }
  /// With all that is in it.
  void leave_out(const MjcfElement& element, const std::string& message) {
    files_.accept_all(element.node());
    note(element, message);
  }

  XmlFiles& files_;
  const MjcfDefaults& defaults_;
  const MjcfCompiler& compiler_;
  const MjcfNames& names_;
  std::string prefix_;  // of names in the whole
  RobotModel& model_;
  std::map<std::string, std::vector<FixedPart>> fixed_;  // tendons that are sums of joints
  std::map<std::string, Wire> spatial_;                  // through sites
  std::map<std::string, ModelPlace> idle_;               // of these, what does nothing by itself
  std::map<std::string, AxisName> actuator_axes_;
  std::vector<double> controls_;  // of the actuators in their order
  std::size_t actuators_ = 0;     // that are read already
};

}  // namespace taut::model
