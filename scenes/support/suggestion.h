#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// What a message suggests where a name is not known.
namespace taut {

/// `; did you mean "mass"?` if one of the candidates is at most a slip or two away, else nothing.  A slip is
/// a letter too many, too few or another one, or two that are exchanged; upper and lower case are the same.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& candidates);

/// The same for a file that is not there, among the files of its folder; with the folder in front.  Nothing
/// for one that is there, whatever else is wrong with it.
std::string did_you_mean_file(const std::filesystem::path& missing);

/// `"a", "b", "c"`
std::string quoted_list(const std::vector<std::string>& names);

}  // namespace taut
