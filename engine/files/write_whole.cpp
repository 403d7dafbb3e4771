#include "files/write_whole.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <string>
#include <system_error>

#include "files/byte_reader.h"
#include "mallow/files.h"

namespace mallow {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_write(const fs::path& file, int error) {
  fail_file(file, "cannot be written: " + std::generic_category().message(error));
}

/// A file open for as long as this lives.
class OpenFile {
 public:
  /// Errors speak of `name`, which need not be the file itself.
  OpenFile(const fs::path& file, int flags, const fs::path& name)
      : name_(name), descriptor_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail_write(name_, errno);
  }
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail_write(name_, errno);
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() {
    // Some file systems cannot sync a folder and say EINVAL; the rename stands all the same.
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail_write(name_, errno);
  }
  /// A full disk or quota may show only here.
  void close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0 && errno != EINTR) fail_write(name_, errno);
  }

 private:
  const fs::path& name_;
  int descriptor_;
};

/// Removes a file when it goes out of scope, unless it has been renamed by then.
class PartialFile {
 public:
  explicit PartialFile(fs::path path) : path_(std::move(path)) { remove(); }
  ~PartialFile() { remove(); }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const fs::path& path() const { return path_; }

 private:
  void remove() noexcept { ::unlink(path_.c_str()); }

  fs::path path_;
};

void write_content(const fs::path& file, std::string_view content, const fs::path& name) {
  OpenFile out(file, O_WRONLY | O_CREAT | O_TRUNC, name);
  out.write(content);
  out.close();
}

/// A name beside the file. File systems take names of at most 255 bytes, so of a long one only the beginning
/// is used, and a hash for what follows.
fs::path partial_name(const fs::path& file) {
  constexpr std::size_t k_longest = 200;
  std::string name = file.filename().string();
  if (name.size() > k_longest)
    name = name.substr(0, k_longest) + '-' + std::to_string(std::hash<std::string>{}(name));
  return fs::path(file).replace_filename('.' + name + ".partial");
}

/// What the file was goes to `previous`, or is lost where that is empty.
void replace(const fs::path& file, const std::function<void(const fs::path& beside)>& write,
             const fs::path& previous) {
  const PartialFile partial(partial_name(file));
  write(partial.path());
  OpenFile(partial.path(), O_RDONLY, file).sync();
  if (!previous.empty() && ::rename(file.c_str(), previous.c_str()) != 0 && errno != ENOENT)
    fail_write(previous, errno);
  if (::rename(partial.path().c_str(), file.c_str()) != 0) fail_write(file, errno);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  OpenFile(folder, O_RDONLY | O_DIRECTORY, file).sync();
}

}  // namespace

bool is_written_in_place(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status) || fs::is_directory(status)) return false;
  if (!fs::is_regular_file(status)) return true;
  // A file that replaced this name would take the place of the system's link.
  const std::string path = fs::absolute(file, error).lexically_normal().string();
  if (path == "/dev/stdout" || path == "/dev/stderr" || path.starts_with("/dev/fd/") ||
      path.starts_with("/proc/"))
    fail_file(file, "leads to a file here, and cannot be replaced; give the name of that file");
  return false;
}

void write_whole(const fs::path& file, const std::function<void(const fs::path& beside)>& write) {
  if (!file.has_filename()) fail_file(file, "cannot be written: it has no file name");
  std::error_code error;
  if (fs::is_directory(file, error)) fail_write(file, EISDIR);
  if (is_written_in_place(file))
    write(file);
  else
    replace(file, write, {});
}

void write_whole(const fs::path& file, std::string_view content) {
  write_whole(file, [&](const fs::path& beside) { write_content(beside, content, file); });
}

void write_whole_keeping(const fs::path& file, std::string_view content, const fs::path& previous) {
  replace(
      file, [&](const fs::path& beside) { write_content(beside, content, file); }, previous);
}

}  // namespace mallow
