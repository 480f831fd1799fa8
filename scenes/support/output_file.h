#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// A file of a command, and the option that says which; no name: none.
struct NamedFile {
  const char* option;
  std::string file;
};
/// @throws std::invalid_argument, naming both options, if one of two is to be written and they are the same
/// file, however they spell it, by links, too.  Devices take any number.
void require_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Asks whether a file can be written, before anything is: one that is there stays as it is, and none is
/// made. An empty name asks for nothing.
/// @throws std::invalid_argument naming the option, the file and what is in the way if it cannot.
void require_writable(const char* option, const std::string& file);
/// The same for a folder that files are written to, which need not be there.
void require_writable_folder(const char* option, const std::string& folder);

/// Everything that a command writes.  What a file is stays as it is.
///
/// A regular file, or a name that is free, gets its contents when they are whole: they are written under a
/// name of their own in the same folder, which then takes the place of the file.  Until then, and if that
/// fails or the program is killed, the old file is what it was.  Mode and owner are those of the old one.
/// Behind a symbolic link it is the file that the link leads to, and the link stays.
///
/// Written through is a device, FIFO or socket, and what the standard output or error already goes to; so is
/// a regular file with several names (hard links), which would else part, one next to which none can be made
/// or given to its owner, and what is streamed while a run goes on.
class OutputFile {
 public:
  enum class Way { kWhole, kStreamed };

  /// Opens the file, or says in error() why not.
  explicit OutputFile(const std::string& file, Way way = Way::kWhole);
  /// What was not finished has never been, unless it was written through.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& out() { return *out_; }
  /// Passes on what was written so far.  False if not all of it could be.
  bool flush();
  /// Ends the file.  False, with error(), if not all of it could be written.
  bool finish();
  /// "a.json: No space left on device", or "" if all is well.
  const std::string& error() const { return error_; }

 private:
  class Buffer;
  void note_error(int number);

  std::string file_, target_, temporary_, error_;
  std::unique_ptr<Buffer> buffer_;
  std::unique_ptr<std::ostream> out_;
};

/// All of a file at once.  @returns error() of it: "" if it is written.
std::string write_output(const std::string& file, std::string_view text);

/// A file descriptor that writes through to a file, cleared before if it is regular and not what the standard
/// output or error goes to; −1 with errno if it cannot be opened.
int open_through(const std::string& file);

/// The standard input, output and error that the program was started without are taken, so that no file which
/// it opens becomes one of them: writing there fails as before.
void reserve_standard_streams();

}  // namespace taut
