#pragma once

#include <map>
#include <memory>
#include <set>

#include "scenes/import/mjcf_geom.h"
#include "scenes/import/mjcf_names.h"

namespace taut::model {

/// One MJCF model, which becomes a part of a RobotModel: its bodies, and what refers to them.
class MjcfTree {
 public:
  MjcfTree(XmlFiles& files, const pugi::xml_node& mujoco, RobotModel& model, int depth = 0)
      : files_(files),
        mujoco_(mujoco),
        compiler_(read_compiler(files, mujoco)),
        defaults_(files, mujoco),
        meshes_(files, defaults_, compiler_, mujoco),
        fields_(files, defaults_, compiler_, mujoco, model.notices),
        model_(model),
        depth_(depth) {}

  /// All bodies of the model.
  void read_world() { read_all({}); }
  /// Settles masses after all bodies are there.
  void finish();
  /// What refers to bodies, joints and sites.
  void relate();

 private:
  /// Where elements are: in a frame of a body, with a class and both ends of names.
  struct Where {
    int link = kWorld;
    Pose X_LF;
    std::string childclass, beginning, ending;
  };
  void read_all(const Where& where);
  void read_children(const pugi::xml_node& parent, const Where& where);
  void read_child(const pugi::xml_node& node, const Where& where);
  void read_body(const pugi::xml_node& node, const Where& where);
  void read_frame(const pugi::xml_node& node, const Where& where);
  void read_replicate(const pugi::xml_node& node, const Where& where);
  void read_attach(const pugi::xml_node& node, const Where& where);
  /// Of the named asset <model>.
  pugi::xml_node model_named(const pugi::xml_node& node, const std::string& name);
  /// The part of this model that another one attaches.
  void read_part(const MjcfElement& attach, const Where& where);
  pugi::xml_node find_part(const pugi::xml_node& parent, const char* kind, const std::string& name);
  void adopt(const MjcfTree& attached, const std::string& prefix);
  void read_joint(const pugi::xml_node& node, const Where& where);
  void read_law(LinkAxis& axis, const MjcfElement& joint, const AxisName& name);
  void give_springs();
  void read_inertial(const pugi::xml_node& node, const Where& where);
  void read_geom_of(const pugi::xml_node& node, const Where& where);
  bool adds_inertia(const MjcfGeom& geom, int link) const;
  void read_site(const pugi::xml_node& node, const Where& where);
  void count(const pugi::xml_node& node);
  /// Its name in this model; in the whole, `beginning` stands in front.
  std::string name_of(const MjcfElement& element, const Where& where);
  void note(const pugi::xml_node& node, const std::string& message) {
    model_.notices.push_back({files_.place(node), message, 1});
  }

  XmlFiles& files_;
  pugi::xml_node mujoco_;
  MjcfCompiler compiler_;
  MjcfDefaults defaults_;
  MjcfMeshes meshes_;
  MjcfFields fields_;
  RobotModel& model_;
  int depth_;
  MjcfNames names_;
  std::string prefix_;
  /// Of axes whose spring and damper follow from the mass that moves.
  struct Spring {
    AxisName on;
    double time = 0, ratio = 0;  // constant [s], and damping over what is critical
    pugi::xml_node node;
  };
  std::vector<Spring> springs_;
  std::vector<int> links_;      // of this model, and not of one that is attached
  std::set<int> has_inertial_;  // links
  std::map<std::string, pugi::xml_node> models_;
  std::vector<std::unique_ptr<MjcfTree>> attached_;
};

}  // namespace taut::model
