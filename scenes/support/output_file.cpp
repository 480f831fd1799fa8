#include "scenes/support/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __linux__
#include <linux/magic.h>
#include <sys/statfs.h>
#endif

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <iostream>
#include <map>
#include <streambuf>
#include <system_error>

#include "core/base/check.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr int kMostSymlinks = 40;  // as the kernel
constexpr mode_t kAnyMode = 07777;

std::string text_of(int error) { return std::generic_category().message(error); }

/// The standard output or error, if it goes to this very file; −1: neither does.
int standard_stream_of(const struct stat& file) {
  struct stat own {};
  for (const int fd : {STDOUT_FILENO, STDERR_FILENO})
    if (fstat(fd, &own) == 0 && own.st_dev == file.st_dev && own.st_ino == file.st_ino &&
        (fcntl(fd, F_GETFL) & O_ACCMODE) != O_RDONLY)
      return fd;
  return -1;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// A folder such as /dev/fd, whose links stand for what is open.
bool has_open_files([[maybe_unused]] const fs::path& folder) {
#ifdef __linux__
  struct statfs system {};
  return statfs(folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
#else
  return false;  // there they are devices, not links
#endif
}

/// Where symbolic links lead, the last of which may lead nowhere.
struct EndOfLinks {
  fs::path place;
  bool is_open = false;  ///< one of them stands for a file that is open, as /dev/fd/3
};

EndOfLinks end_of_links(const std::string& file) {
  EndOfLinks end{file};
  std::error_code error;
  for (int links = 0; links < kMostSymlinks && fs::is_symlink(fs::symlink_status(end.place, error));
       ++links) {
    const fs::path folder = folder_of(end.place), next = fs::read_symlink(end.place, error);
    if (error) break;
    end.is_open = end.is_open || has_open_files(folder);
    end.place = next.is_absolute() ? next : folder / next;
  }
  return end;
}

/// Makes a file in this folder under a name that nobody has.  −1 with errno if that cannot be.
int make_temporary(const fs::path& folder, mode_t mode, std::string& name) {
  static std::atomic<unsigned> count{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    name = (folder / (".taut-" + std::to_string(getpid()) + "-" + std::to_string(count++))).string();
    const int fd = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

bool can_make_temporary(const fs::path& folder) {
  std::string name;
  const int fd = make_temporary(folder, 0600, name);
  if (fd < 0) return false;
  close(fd);
  unlink(name.c_str());
  return true;
}

/// Gives it the owner, group and mode of the other.
bool make_alike(int fd, const struct stat& other) {
  struct stat own {};
  if (fstat(fd, &own) != 0) return false;
  const bool same_owner = own.st_uid == other.st_uid && own.st_gid == other.st_gid;
  return (same_owner || fchown(fd, other.st_uid, other.st_gid) == 0) &&
         fchmod(fd, other.st_mode & kAnyMode) == 0;
}

/// How a file is going to be written.
struct Target {
  int error = 0;  // errno if it cannot be
  bool through = false;
  bool exists = false;
  struct stat now {};
  fs::path place;  // of what is to be replaced
};

/// Of a file that is not there, or cannot be looked at.
int error_of_new(const fs::path& place) {
  if (errno != ENOENT) return errno;
  if (!can_make_temporary(folder_of(place))) return errno;
  return place.has_filename() ? 0 : EISDIR;
}

/// Why what is there cannot be written to; 0: it can.
int error_of_present(const std::string& file, const struct stat& now) {
  if (S_ISDIR(now.st_mode)) return EISDIR;
  if (standard_stream_of(now) >= 0) return 0;
  if (S_ISSOCK(now.st_mode)) return ENXIO;
  return access(file.c_str(), W_OK) == 0 ? 0 : errno;
}

/// A new file can take the place of what is there.
bool is_replaceable(const struct stat& now, const EndOfLinks& end) {
  return standard_stream_of(now) < 0 && !end.is_open && S_ISREG(now.st_mode) && now.st_nlink == 1 &&
         can_make_temporary(folder_of(end.place));
}

Target target_of(const std::string& file, OutputFile::Way way) {
  Target target;
  const EndOfLinks end = end_of_links(file);
  target.place = end.place;
  const bool streamed = way == OutputFile::Way::kStreamed;
  target.exists = stat(file.c_str(), &target.now) == 0;
  target.error = target.exists ? error_of_present(file, target.now) : error_of_new(end.place);
  target.through = streamed || (target.exists && !is_replaceable(target.now, end));
  return target;
}

/// Two names of one file have the same; a device has none.
std::string identity_of(const std::string& file) {
  struct stat now {};
  if (stat(file.c_str(), &now) == 0) {
    if (S_ISCHR(now.st_mode)) return {};
    return std::to_string(now.st_dev) + ":" + std::to_string(now.st_ino);
  }
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(end_of_links(file).place, ignored), ignored).string();
}

}  // namespace

void require_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  std::map<std::string, const char*> taken;
  for (const NamedFile& input : inputs)
    if (!input.file.empty()) taken.emplace(identity_of(input.file), input.option);
  taken.erase(std::string());
  for (const NamedFile& output : outputs) {
    const std::string identity = output.file.empty() ? std::string() : identity_of(output.file);
    if (identity.empty()) continue;
    if (const auto [other, is_new] = taken.emplace(identity, output.option); !is_new)
      fail(output.option, std::string("must not be the file of ") + other->second, output.file);
  }
}

void require_writable(const char* option, const std::string& file) {
  if (file.empty()) return;
  if (const int error = target_of(file, OutputFile::Way::kWhole).error; error != 0)
    fail(option, "cannot write the file: " + text_of(error), file);
}

void require_writable_folder(const char* option, const std::string& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  fs::path there = fs::absolute(folder, ignored);
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, ignored))
    fail(option, "cannot write to the folder: " + text_of(ENOTDIR), folder);
  if (!can_make_temporary(there)) fail(option, "cannot write to the folder: " + text_of(errno), folder);
}

/// Writes to a file descriptor and remembers why it could not.
class OutputFile::Buffer : public std::streambuf {
 public:
  explicit Buffer(int fd) : fd_(fd), bytes_(1 << 16) { setp(bytes_.data(), bytes_.data() + bytes_.size()); }
  ~Buffer() override { (void)end(); }

  int fd() const { return fd_; }
  int error() const { return error_; }
  /// Passes on what waits and closes the file.
  int end() {
    if (fd_ < 0) return error_;
    (void)sync();
    if (close(fd_) != 0 && error_ == 0) error_ = errno;  // some file systems say only now that they are full
    fd_ = -1;
    return error_;
  }

 protected:
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  int sync() override {
    const char* from = pbase();
    while (error_ == 0 && from < pptr()) {
      const ssize_t count = ::write(fd_, from, static_cast<std::size_t>(pptr() - from));
      if (count > 0)
        from += count;
      else if (count == 0 || errno != EINTR)
        error_ = count == 0 ? EIO : errno;
    }
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    return error_ == 0 ? 0 : -1;
  }

 private:
  int fd_, error_ = 0;
  std::vector<char> bytes_;
};

OutputFile::OutputFile(const std::string& file, Way way) : file_(file) {
  const Target target = target_of(file, way);
  int fd = -1, error = target.error;
  if (error == 0 && !target.through) {
    target_ = target.place.string();
    // What nobody but its owner may read is not to be seen while it is made, either.
    fd = make_temporary(folder_of(target.place), target.exists ? 0600 : 0666, temporary_);
    if (fd >= 0 && target.exists && !make_alike(fd, target.now)) {
      close(fd);
      unlink(temporary_.c_str());
      fd = -1;
    }
    if (fd < 0) temporary_.clear();
  }
  if (error == 0 && fd < 0) fd = open_through(file);
  if (error == 0 && fd < 0) error = errno;
  if (fd >= 0) buffer_ = std::make_unique<Buffer>(fd);
  out_ = std::make_unique<std::ostream>(buffer_.get());  // without a buffer it is bad from the start
  note_error(error);
}

OutputFile::~OutputFile() {
  buffer_.reset();
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::note_error(int number) {
  if (number != 0 && error_.empty()) error_ = file_ + ": " + text_of(number);
}

bool OutputFile::flush() {
  out_->flush();
  if (buffer_) note_error(buffer_->error());
  return error_.empty();
}

bool OutputFile::finish() {
  if (buffer_) note_error(buffer_->end());
  if (error_.empty() && !out_->good()) error_ = file_ + ": could not be written";
  if (temporary_.empty()) return error_.empty();
  if (error_.empty() && rename(temporary_.c_str(), target_.c_str()) != 0) note_error(errno);
  if (!error_.empty()) unlink(temporary_.c_str());
  temporary_.clear();
  return error_.empty();
}

std::string write_output(const std::string& file, std::string_view text) {
  OutputFile output(file);
  output.out() << text;
  output.finish();
  return output.error();
}

int open_through(const std::string& file) {
  struct stat now {};
  if (stat(file.c_str(), &now) == 0)
    if (const int standard = standard_stream_of(now); standard >= 0) {
      std::cout.flush();  // what was said before comes first
      return fcntl(standard, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    }
  return open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

void reserve_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(fd, F_GETFD) == -1 && errno == EBADF)
      (void)open("/dev/null",
                 fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // takes the lowest number that is free
}

}  // namespace taut
