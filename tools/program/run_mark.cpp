#include "program/run_mark.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "mallow/errors.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view k_any_format = "mallow run, format ";
constexpr std::string_view k_mark = "mallow run, format 1\n";
constexpr std::string_view k_process = "written by process ";
constexpr std::string_view k_host = " on ";

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw IoError({file.string(), 0, 0, "", message});
}

/// An open file, closed unless it is released.
class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : value_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }
  int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

/// The first bytes of a file: a mark is shorter.
std::string text_of(int descriptor) {
  char text[512];
  const ssize_t size = ::pread(descriptor, text, sizeof text, 0);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
}

MarkState state_of(const std::string& text, const fs::path& file) {
  if (text.empty()) return MarkState::empty;
  if (text.starts_with(k_mark)) return MarkState::run;
  if (text.starts_with(k_any_format)) fail(file, "was written by a later version of mallow");
  return MarkState::none;
}

std::string host_name() {
  char name[256] = "";
  if (::gethostname(name, sizeof name - 1) != 0) return "an unknown host";
  return name;
}

/// " by process 42 on HOST", as far as the mark tells; nothing where that process is gone, as then another
/// one holds the lock and did not sign.
std::string holder(const std::string& mark) {
  if (!mark.starts_with(k_mark)) return "";
  const std::string_view line = std::string_view(mark).substr(k_mark.size());
  if (!line.starts_with(k_process) || !line.ends_with('\n')) return "";
  const std::size_t at = line.find(k_host);
  if (at == line.npos) return "";
  const std::string host(line.substr(at + k_host.size(), line.size() - 1 - at - k_host.size()));
  const int process = std::atoi(std::string(line.substr(k_process.size())).c_str());
  const bool gone = host == host_name() && ::kill(process, 0) != 0 && errno == ESRCH;
  return gone ? "" : " by process " + std::to_string(process) + " on " + host;
}

/// Without waiting: whoever waits for a run would wait for hours. Returns a warning where the disk has no
/// locks.
std::string lock(int descriptor, int operation, const fs::path& folder) {
  if (::flock(descriptor, operation | LOCK_NB) == 0) return "";
  if (errno == EWOULDBLOCK)
    fail(folder, "is in use" + holder(text_of(descriptor)) + "; wait until that mallow has ended");
  return folder.string() + " cannot be locked (" + std::strerror(errno) +
         "), so that nothing keeps another mallow from writing there";
}

void write_at(int descriptor, std::string_view text, std::size_t place, const fs::path& file) {
  if (::pwrite(descriptor, text.data(), text.size(), static_cast<off_t>(place)) !=
      static_cast<ssize_t>(text.size()))
    fail(file, std::string("cannot be written: ") + std::strerror(errno));
}

void forget_holder(int descriptor) {
  // A line that stays is passed over by holder().
  [[maybe_unused]] const int stays = ::ftruncate(descriptor, static_cast<off_t>(k_mark.size()));
}

}  // namespace

MarkState mark_state(const fs::path& folder) {
  const fs::path file = folder / k_run_mark;
  const Descriptor mark(file, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
  if (mark.value() < 0) {
    if (errno == EACCES) fail(file, std::string("cannot be read: ") + std::strerror(errno));
    return MarkState::none;
  }
  struct stat status {};
  if (::fstat(mark.value(), &status) != 0 || !S_ISREG(status.st_mode)) return MarkState::none;
  return state_of(text_of(mark.value()), file);
}

RunLock RunLock::for_writing(const fs::path& folder) {
  const fs::path file = folder / k_run_mark;
  Descriptor mark(file, O_RDWR | O_CREAT | O_NOFOLLOW);
  if (mark.value() < 0) fail(file, std::string("cannot be written: ") + std::strerror(errno));
  std::string warning = lock(mark.value(), LOCK_EX, folder);
  const MarkState state = state_of(text_of(mark.value()), file);
  if (state == MarkState::none) fail(file, "is not a mark of mallow's, and stays as it is");
  // The line that makes it a mark is written once, so that it is whole however the rest is interrupted.
  if (state == MarkState::empty) write_at(mark.value(), k_mark, 0, file);
  forget_holder(mark.value());
  const std::string line =
      std::string(k_process) + std::to_string(::getpid()) + std::string(k_host) + host_name();
  write_at(mark.value(), line + '\n', k_mark.size(), file);
  return {mark.release(), std::move(warning), true};
}

RunLock RunLock::for_reading(const fs::path& folder) {
  const fs::path file = folder / k_run_mark;
  Descriptor mark(file, O_RDONLY | O_NOFOLLOW);
  if (mark.value() < 0) fail(file, std::string("cannot be read: ") + std::strerror(errno));
  std::string warning = lock(mark.value(), LOCK_SH, folder);
  return {mark.release(), std::move(warning), false};
}

RunLock RunLock::for_looking(const fs::path& folder) {
  const fs::path file = folder / k_run_mark;
  Descriptor mark(file, O_RDONLY | O_NOFOLLOW);
  if (mark.value() < 0) fail(file, std::string("cannot be read: ") + std::strerror(errno));
  if (::flock(mark.value(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    RunLock none;
    const std::string by = holder(text_of(mark.value()));
    none.writer_ = by.empty() ? "another mallow" : by.substr(std::string_view(" by ").size());
    return none;
  }
  std::string warning = lock(mark.value(), LOCK_SH, folder);
  return {mark.release(), std::move(warning), false};
}

RunLock RunLock::for_exports(const fs::path& folder, bool shared) {
  Descriptor place(folder, O_RDONLY | O_DIRECTORY);
  if (place.value() < 0) fail(folder, std::string("cannot be opened: ") + std::strerror(errno));
  std::string warning = lock(place.value(), shared ? LOCK_SH : LOCK_EX, folder);
  return {place.release(), std::move(warning), false};
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  if (signed_) forget_holder(descriptor_);
  ::close(descriptor_);
}

RunLock::RunLock(RunLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      warning_(std::move(other.warning_)),
      writer_(std::move(other.writer_)),
      signed_(std::exchange(other.signed_, false)) {}

RunLock& RunLock::operator=(RunLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(warning_, other.warning_);
  std::swap(writer_, other.writer_);
  std::swap(signed_, other.signed_);
  return *this;
}

}  // namespace mallow::program
