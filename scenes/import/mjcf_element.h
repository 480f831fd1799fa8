#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenes/import/xml_values.h"

namespace taut::model {

/// What <compiler> says.
struct MjcfCompiler {
  enum class FromGeoms { kNo, kYes, kAuto };
  double angle = 0.017453292519943295;  ///< rad per unit of angles
  std::string eulerseq = "xyz";
  bool autolimits = true;
  FromGeoms inertia_from_geoms = FromGeoms::kAuto;
  int first_group = 0, last_group = 5;  ///< of geoms that have a mass
  bool balance_inertia = false;
  double bound_mass = 0, bound_inertia = 0, total_mass = -1;
  bool strip_path = false;
  std::filesystem::path mesh_folder;

  /// Where a mesh or a height field is that names this file, from the folder of the model.
  std::string asset(const std::filesystem::path& file) const {
    return (mesh_folder / (strip_path ? file.filename() : file)).string();
  }
};
MjcfCompiler read_compiler(XmlFiles& files, const pugi::xml_node& mujoco);

/// An element with the attributes that its default classes give it.
class MjcfElement {
 public:
  MjcfElement(XmlFiles& files, pugi::xml_node node, std::vector<pugi::xml_node> defaults = {})
      : files_(&files), node_(node), layers_(std::move(defaults)) {
    layers_.insert(layers_.begin(), node);
  }
  const pugi::xml_node& node() const { return node_; }
  XmlFiles& files() const { return *files_; }
  ModelPlace place() const { return files_->place(node_); }
  [[noreturn]] void fail(const std::string& message) const { files_->fail(node_, message); }

  /// The text of an attribute, the element's own or that of the nearest class; null if there is none.
  const char* find(const char* attribute) const;
  std::string text(const char* attribute, const char* fallback = "") const;
  double number(const char* attribute, double fallback) const;
  /// All numbers of an attribute; none if it is missing.
  std::vector<double> numbers(const char* attribute) const;
  /// `count` numbers; fewer keep those of the fallback behind them.
  std::vector<double> numbers(const char* attribute, std::vector<double> fallback) const;
  Vec3 vector(const char* attribute, const Vec3& fallback) const;
  /// true, false, and what the attribute "auto" or a missing one is.
  bool flag(const char* attribute, bool fallback) const;
  /// The ends of a range that is in force: whether it is, the attribute `limited` says, or else that it is
  /// given.
  std::optional<std::pair<double, double>> range(const char* attribute, const char* limited,
                                                 const MjcfCompiler& compiler) const;
  /// Position and orientation, in any of the ways of saying it.
  Pose pose(const MjcfCompiler& compiler) const;
  Quat orientation(const MjcfCompiler& compiler) const;

 private:
  XmlFiles* files_;
  pugi::xml_node node_;
  std::vector<pugi::xml_node> layers_;  // the element itself first
};

/// The tree of default classes.
class MjcfDefaults {
 public:
  MjcfDefaults(XmlFiles& files, const pugi::xml_node& mujoco);
  /// The element with the class that it names, or else `childclass`, or else the outermost one.
  /// @throws ImportError if there is no class of that name.
  MjcfElement element(const pugi::xml_node& node, const std::string& childclass) const;
  bool has(const std::string& name) const { return classes_.contains(name); }

 private:
  struct Class {
    std::string parent;
    std::vector<pugi::xml_node> elements;  // in <default>, one or several, without those within them
  };
  void read(const pugi::xml_node& node, const std::string& parent);

  XmlFiles& files_;
  std::map<std::string, Class> classes_;
  std::string top_ = "main";
};

/// Three turns in the order of the compiler: about axes that turn along (small letters) or stay (capitals).
Quat from_euler(const Vec3& angles, const MjcfCompiler& compiler);
/// The rotation that takes z to a direction, as MJCF has it.
Quat z_to(const Vec3& direction);

}  // namespace taut::model
