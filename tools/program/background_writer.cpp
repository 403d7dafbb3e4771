#include "program/background_writer.h"

#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <cstddef>
#include <utility>

namespace mallow::program {
namespace {

/// Particles and surface of one frame; each that waits is held in memory.
constexpr std::size_t k_most_jobs = 2;

/// The threads of a step wait for each other, so that one which has to share its processor holds up all. A
/// little less weight than theirs is enough; the least there is starves on a machine with other work.
void step_back() {
#ifdef __linux__
  constexpr int k_nice = 5;
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), k_nice);  // of this thread alone
#endif
}

}  // namespace

BackgroundWriter::BackgroundWriter() : thread_([this] { work(); }) {}

BackgroundWriter::~BackgroundWriter() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundWriter::add(std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.size() < k_most_jobs || error_; });
  if (error_) std::rethrow_exception(error_);
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

bool BackgroundWriter::has_room() {
  const std::lock_guard lock(mutex_);
  return jobs_.size() < k_most_jobs || error_;
}

void BackgroundWriter::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.empty(); });
  if (error_) std::rethrow_exception(error_);
}

void BackgroundWriter::work() {
  step_back();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !jobs_.empty() || closed_; });
    if (jobs_.empty()) return;
    std::function<void()>& job = jobs_.front();  // a deque leaves it where it is while others are added
    lock.unlock();
    std::exception_ptr error;
    try {
      job();
    } catch (...) {
      error = std::current_exception();
    }
    job = nullptr;  // what it holds is freed here and not under the lock
    lock.lock();
    if (error) {
      error_ = error;
      jobs_.clear();
    } else {
      jobs_.pop_front();
    }
    changed_.notify_all();
  }
}

}  // namespace mallow::program
