#pragma once

#include <filesystem>
#include <string>

namespace taut {

/// In lower case, with its dot: ".png"; "" without one.
std::string ending_of(const std::filesystem::path& file);

/// What a command writes to a file, by which other programs know it from its name.
enum class FileKind { kPage, kAnimation, kPicture, kTable, kJson, kRecording };

/// Refuses a name that other programs would take for something else: for pages, animations and pictures any
/// ending but theirs, for the rest that of another kind of file.  A name without an ending is taken, and that
/// of a device, a pipe or what else is no regular file; "" asks for nothing.
/// @throws std::invalid_argument naming the option, the ending and the file.
void require_ending(const char* option, const std::string& file, FileKind kind);
/// The same for a folder, whose name must not be that of a file.
void require_folder_name(const char* option, const std::string& folder);

}  // namespace taut
