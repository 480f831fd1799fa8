#pragma once

#include <map>

#include "scenes/import/mjcf_geom.h"

namespace taut::model {

/// Names of what a MJCF file defines, for what refers to it.
struct MjcfNames {
  std::map<std::string, int> bodies{{"world", kWorld}};
  std::map<std::string, LinkFrame> sites;
  std::map<std::string, int> bodies_of_geoms;
  std::map<std::string, AxisName> joints;
};

/// Reads the bodies of a MJCF file into a model.
class MjcfTree {
 public:
  MjcfTree(XmlFiles& files, const pugi::xml_node& mujoco, const MjcfCompiler& compiler,
           const MjcfDefaults& defaults, RobotModel& model)
      : files_(files),
        compiler_(compiler),
        defaults_(defaults),
        meshes_(files, defaults, compiler, mujoco),
        model_(model) {}

  void read(const pugi::xml_node& worldbody);
  /// Settles masses after all bodies are there.
  void finish();
  const MjcfNames& names() const { return names_; }

 private:
  /// Where elements are: in a frame of a body, with a class and an ending of names.
  struct Where {
    int link = kWorld;
    Pose X_LF;
    std::string childclass, ending;
  };
  void read_children(const pugi::xml_node& parent, const Where& where);
  void read_child(const pugi::xml_node& node, const Where& where);
  void read_body(const pugi::xml_node& node, const Where& where);
  void read_frame(const pugi::xml_node& node, Where where);
  void read_replicate(const pugi::xml_node& node, const Where& where);
  void read_joint(const pugi::xml_node& node, const Where& where);
  void read_law(LinkAxis& axis, const MjcfElement& joint);
  void read_inertial(const pugi::xml_node& node, const Where& where);
  void read_geom_of(const pugi::xml_node& node, const Where& where);
  void read_site(const pugi::xml_node& node, const Where& where);
  void count(const pugi::xml_node& node);
  std::string name_of(const MjcfElement& element, const Where& where) const;
  void note(const pugi::xml_node& node, const std::string& message) {
    model_.notices.push_back({files_.place(node), message, 1});
  }

  XmlFiles& files_;
  const MjcfCompiler& compiler_;
  const MjcfDefaults& defaults_;
  MjcfMeshes meshes_;
  RobotModel& model_;
  MjcfNames names_;
  std::vector<bool> has_inertial_;  // by link
  int elements_ = 0;
};

}  // namespace taut::model
