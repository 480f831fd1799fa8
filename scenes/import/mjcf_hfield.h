#pragma once

#include "core/world/shape.h"
#include "scenes/import/mjcf_element.h"

namespace taut::model {

/// Height fields by name.
class MjcfFields {
 public:
  MjcfFields(XmlFiles& files, const MjcfDefaults& defaults, const MjcfCompiler& compiler,
             const pugi::xml_node& mujoco, std::vector<ImportNotice>& notices);
  /// @throws std::invalid_argument if there is no such field, or its file cannot be read.
  const HeightField& field(const std::string& name) const;

 private:
  struct Entry {
    HeightField field;
    std::string problem;
  };
  void read(const MjcfElement& hfield, const MjcfCompiler& compiler, std::vector<ImportNotice>& notices);
  std::map<std::string, Entry> fields_;
};

}  // namespace taut::model
