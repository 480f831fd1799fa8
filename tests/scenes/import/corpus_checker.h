#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Models of others (tests/scenes/import/models), and what is known of them.
namespace taut::testing {

std::filesystem::path model_folder();
/// All of them, by their paths in the folder, in order.
std::vector<std::string> model_files();

}  // namespace taut::testing
