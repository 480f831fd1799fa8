#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// `; "revolute" is called "hinge" here` if the known names have another one for what is meant by the given
/// name elsewhere, with what else is different in a few words; nothing if they do not.  Upper and lower case,
/// '-', '_' and spaces make no difference.
std::string called_here(std::string_view given, const std::vector<std::string>& known);

}  // namespace taut
