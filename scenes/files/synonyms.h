#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// `; "revolute" is called "hinge" here` if the known names have another one for what is meant by the given
/// name elsewhere, with what else is different in a few words; nothing if they do not.  Upper and lower case,
/// '-', '_' and spaces make no difference.
/// @param is_list  the name is of a list, such as a point, which no body's name is
std::string called_here(std::string_view given, const std::vector<std::string>& known, bool is_list = false);
/// That other one of the known names; "" if there is none.
std::string name_here(std::string_view given, const std::vector<std::string>& known);
/// Both are names of one thing, of which one may be its name here.
bool are_synonyms(std::string_view one, std::string_view other);

}  // namespace taut
