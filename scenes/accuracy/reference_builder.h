#pragma once

#include <nlohmann/json.hpp>

#include "core/state/motion.h"
#include "scenes/accuracy/reference_case.h"

/// The parts of load_case(), one per list of the set-up.
namespace taut::reference {

/// Joints, gears, differentials and driven hinges.
void add_joint(Case& out, const nlohmann::json& joint);
/// The joint with a body in place of the world's end that a driver moves along its path.
nlohmann::json with_driven_anchor(Case& out, nlohmann::json joint, const nlohmann::json& driver);
/// Forces, motors, friction and springs.
void add_force(Case& out, const nlohmann::json& force);
/// Static bodies, the shapes of all bodies that are in a pair, and the pairs.
void add_contacts(Case& out, const nlohmann::json& setup);
/// A body whose pose is a function of time, in place of a moving part of the world.
BodyId add_carrier(Case& out, const std::string& name, const PoseMotion& motion);

/// The name in the World, where "ground" is the world itself.
std::string body_name(const std::string& name);
/// The list under a key, or none.
nlohmann::json list_of(const nlohmann::json& object, const char* key);

}  // namespace taut::reference
