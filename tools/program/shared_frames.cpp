#include "program/shared_frames.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "mallow/errors.h"
#include "mallow/version.h"
#include "program/failure.h"
#include "program/fnv.h"
#include "program/interrupt.h"
#include "program/run_report.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_lock = "lock";
constexpr const char* k_joined = "joined";
constexpr const char* k_frame = "frame_";

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw IoError({file.string(), 0, 0, "", message});
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail(folder, "cannot be made: " + error.message());
}

/// What tells a file from what it was: size and time of the last change.
std::string stamp(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "none";
  return std::to_string(status.st_size) + ' ' + std::to_string(status.st_mtim.tv_sec) + ' ' +
         std::to_string(status.st_mtim.tv_nsec);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::unique_ptr<FileLock> FileLock::try_lock(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) fail(file, std::string("cannot be written: ") + std::strerror(errno));
  std::unique_ptr<FileLock> lock(new FileLock(file, descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno != EWOULDBLOCK && errno != EINTR)
    fail(file, std::string("cannot be locked (") + std::strerror(errno) +
                   "), which those that write into one folder need, so that no two write one file");
  return nullptr;
}

std::unique_ptr<FileLock> FileLock::wait_for(const fs::path& file) {
  for (;;) {
    if (auto lock = try_lock(file)) return lock;
    if (const int signal = interrupted())
      throw Interrupted("interrupted while another mallow was at work", signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

FileLock::~FileLock() {
  ::close(descriptor_);
}

void FileLock::write(const std::string& text) const {
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::pwrite(descriptor_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    fail(file_, std::string("cannot be written: ") + std::strerror(errno));
}

std::unique_ptr<FileLock> lock_shared_folder(const fs::path& folder) {
  make_folder(folder / k_share_folder);
  return FileLock::wait_for(folder / k_share_folder / k_lock);
}

void forget_shared_frames(const fs::path& folder) {
  const fs::path share = folder / k_share_folder;
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(share, ignored))) return;
  const auto is_ours = [](const fs::path& file) {
    const std::string name = file.filename().string();
    const bool of_tasks = name == "tasks.txt" || name == "task.sh" || name == "parallel.txt" ||
                          name == "slurm.txt" || name == "queue.txt" ||
                          file.parent_path().filename() == "slurm";
    return of_tasks || name == k_lock || name == k_joined || name.starts_with(k_frame);
  };
  std::vector<fs::path> files, folders;
  for (const auto& entry : fs::recursive_directory_iterator(share, ignored))
    (entry.is_directory(ignored) ? folders : files).push_back(entry.path());
  for (const fs::path& file : files)
    if (is_ours(file)) fs::remove(file, ignored);
  for (const fs::path& empty : folders) fs::remove(empty, ignored);
  fs::remove(share, ignored);
}

SharedFrames::SharedFrames(const fs::path& folder, const std::string& command, const std::string& job,
                           std::function<Files(int)> files)
    : folder_(folder),
      notes_(folder / k_share_folder / command),
      job_(fnv(std::string(version()) + '\n' + command + '\n' + job)),
      files_(std::move(files)) {
  make_folder(notes_);
}

fs::path SharedFrames::file_of(int frame) const {
  return notes_ / (k_frame + std::to_string(frame));
}

std::string SharedFrames::note_of(int frame) const {
  std::string text;
  const Files files = files_(frame);
  for (const std::vector<fs::path>* list : {&files.read, &files.written})
    for (const fs::path& file : *list) text += file.filename().string() + ' ' + stamp(file) + '\n';
  return "done " + hash_text(fnv(text, job_)) + '\n';
}

std::shared_ptr<const SharedFrames::Claim> SharedFrames::try_claim(int frame) const {
  auto lock = FileLock::try_lock(file_of(frame));
  return lock ? std::make_shared<const Claim>(*this, frame, std::move(lock)) : nullptr;
}

void SharedFrames::Claim::done() const {
  lock_->write(frames_.note_of(frame_));
}

void SharedFrames::note(int frame) const {
  std::ofstream(file_of(frame), std::ios::binary) << note_of(frame);
}

bool SharedFrames::is_done(int frame) const {
  const Files files = files_(frame);
  return std::ranges::all_of(files.written, [](const fs::path& file) { return fs::exists(file); }) &&
         text_of(file_of(frame)) == note_of(frame);
}

std::vector<int> SharedFrames::left(const std::vector<int>& frames) const {
  std::vector<int> left = frames;
  std::erase_if(left, [&](int frame) { return is_done(frame); });
  return left;
}

std::size_t SharedFrames::count_left(const std::vector<int>& frames) const {
  return left(frames).size();
}

std::size_t SharedFrames::join(const std::vector<int>& frames, const std::vector<fs::path>& made,
                               const std::function<void()>& join) const {
  if (const std::size_t left = count_left(frames)) return left;
  const auto lock = lock_shared_folder(folder_);
  const auto note = [&] {
    std::uint64_t hash = job_;
    for (const int frame : frames) hash = fnv(note_of(frame), hash);
    for (const fs::path& file : made) hash = fnv(file.filename().string() + ' ' + stamp(file), hash);
    return "joined " + hash_text(hash) + '\n';
  };
  const auto mine = FileLock::wait_for(notes_ / k_joined);
  if (text_of(notes_ / k_joined) == note()) return 0;
  join();
  mine->write(note());
  return 0;
}

}  // namespace mallow::program
