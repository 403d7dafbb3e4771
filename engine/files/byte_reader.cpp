#include "files/byte_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <system_error>
#include <utility>

#include "mallow/errors.h"

namespace mallow {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }

 private:
  int value_;
};

[[noreturn]] void fail_read(const std::filesystem::path& file) {
  fail_file(file, "cannot be read: " + std::generic_category().message(errno));
}

}  // namespace

void fail_file(const std::filesystem::path& file, std::string message) {
  throw IoError(
      Problem{.file = file.string(), .line = 0, .column = 0, .field = {}, .message = std::move(message)});
}

std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

std::string lower_case_ending(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

void require_readable_size(const std::filesystem::path& file, std::uint64_t bytes) {
  if (bytes <= k_max_file_bytes) return;
  fail_file(file, counted(bytes, "byte") + " are not allowed: at most " + std::to_string(k_max_file_bytes));
}

std::string why_too_many(std::uint64_t count, const char* nouns) {
  if (count <= k_max_rows) return {};
  return "at most " + std::to_string(k_max_rows) + ' ' + nouns + " are allowed";
}

std::string read_whole_file(const std::filesystem::path& file) {
  // O_NONBLOCK, so that a pipe without a writer is refused below and not waited for.
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (descriptor.value() < 0 || ::fstat(descriptor.value(), &status) != 0) fail_read(file);
  if (S_ISDIR(status.st_mode)) fail_file(file, "is a folder; a file is needed");
  if (!S_ISREG(status.st_mode)) fail_file(file, "is a device or pipe; a regular file is needed");
  if (status.st_size == 0) fail_file(file, "is empty");
  require_readable_size(file, static_cast<std::uint64_t>(status.st_size));

  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(descriptor.value(), bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_read(file);
    if (got == 0) fail_file(file, "became shorter while it was read");
    filled += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace mallow
