#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/export/model_tree.h"

namespace taut {

/// Motors of axes as <actuator>, whose controls are their targets.  MuJoCo's are servos,
///   F = kp (u − q) − kv q̇  or  kv (u − q̇),  |F| ≤ forcerange,
/// which is what a servo of taut is; a motor that keeps its target exactly becomes one that is as stiff as
/// the step allows.
class MjcfActuators {
 public:
  MjcfActuators(const Scene& scene, const ModelTree& tree, std::vector<std::string>& notices)
      : scene_(scene), tree_(tree), notices_(notices) {}
  /// The motor of an axis by which a body hangs on its parent, if it has one; `joint` is its name there.
  void add(const TreeAxis& axis, BodyId body, const std::string& joint);
  /// Those that were added, at the end of <mujoco>, and an integrator that takes their dampers implicitly.
  /// @return `ctrl` of the <key> that they start with, or ""
  std::string write(pugi::xml_node mujoco) const;

 private:
  struct Servo {
    std::string joint;
    bool to_position = false;
    double target = 0, stiffness = 0, damping = 0, max_force = kUnlimited;
  };
  Servo exact(const TreeAxis& axis, BodyId body, Servo servo);
  double inertia_behind(const TreeAxis& axis, BodyId body) const;

  const Scene& scene_;
  const ModelTree& tree_;
  std::vector<std::string>& notices_;
  std::vector<Servo> servos_;
};

}  // namespace taut
