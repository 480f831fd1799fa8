#pragma once

#include <filesystem>

namespace taut {

/// The file of the program that runs, for what lies beside it; empty where the system does not tell, as any
/// but Linux here.
std::filesystem::path program_path();

}  // namespace taut
