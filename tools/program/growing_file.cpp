#include "program/growing_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "mallow/errors.h"
#include "program/fnv.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw IoError({file.string(), 0, 0, "--series", message});
}

int open_file(const fs::path& file, int flags) {
  const int descriptor = ::open(file.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor < 0)
    fail(file, std::string(flags & O_CREAT ? "cannot be written: " : "cannot be continued: ") +
                   std::strerror(errno));
  return descriptor;
}

}  // namespace

GrowingFile::GrowingFile(fs::path file)
    : file_(std::move(file)),
      descriptor_(open_file(file_, O_WRONLY | O_CREAT | O_TRUNC)),
      hash_(k_fnv_of_nothing) {}

GrowingFile::GrowingFile(fs::path file, std::uint64_t size, std::uint64_t hash)
    : file_(std::move(file)), descriptor_(open_file(file_, O_RDWR)), hash_(k_fnv_of_nothing) {
  try {
    char bytes[1 << 14];
    while (size_ < size) {
      const ssize_t count = ::read(descriptor_, bytes, std::min<std::uint64_t>(sizeof bytes, size - size_));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      hash_ = fnv({bytes, static_cast<std::size_t>(count)}, hash_);
      size_ += static_cast<std::uint64_t>(count);
    }
    if (size_ < size)
      fail(file_, "is not the series of this run: it has " + std::to_string(size_) + " bytes, at least the " +
                      std::to_string(size) + " that were written up to the checkpoint are needed");
    if (hash_ != hash)
      fail(file_, "is not the series of this run: its first " + std::to_string(size) +
                      " bytes are not those that were written up to the checkpoint");
    if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0)
      fail(file_, std::string("cannot be continued: ") + std::strerror(errno));
  } catch (const IoError&) {
    ::close(descriptor_);
    throw;
  }
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

GrowingFile::GrowingFile(GrowingFile&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_),
      hash_(other.hash_) {}

void GrowingFile::add(const std::string& line) {
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = ::write(descriptor_, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      // Half a line would be read as a row. A pipe has none to take back.
      [[maybe_unused]] const int stays = ::ftruncate(descriptor_, static_cast<off_t>(size_));
      fail(file_, std::string("cannot be written: ") + std::strerror(error));
    }
    written += static_cast<std::size_t>(count);
  }
  size_ += line.size();
  hash_ = fnv(line, hash_);
}

void GrowingFile::sync() const {
  // What is no file on a disk says EINVAL.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
    fail(file_, std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace mallow::program
