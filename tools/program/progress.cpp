#include "program/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace mallow::program {
namespace {

constexpr std::chrono::milliseconds k_terminal_interval{100};
constexpr std::chrono::milliseconds k_pipe_interval{2000};
constexpr int k_bar_width = 24;

std::string bar(double share) {
  const auto filled = static_cast<std::size_t>(std::lround(share * k_bar_width));
  std::string text(k_bar_width, '.');
  text.replace(0, filled, filled, '#');
  return '[' + text + "] ";
}

}  // namespace

Progress::Progress(std::string verb, long long total, std::string unit, long long done_before)
    : verb_(std::move(verb)),
      total_(total),
      done_before_(done_before),
      unit_(std::move(unit)),
      terminal_(::isatty(STDERR_FILENO) != 0),
      started_(Clock::now()),
      shown_(started_ - k_terminal_interval) {
  if (!terminal_) shown_ = started_;
}

Progress::~Progress() {
  if (terminal_ && shown_done_ >= 0) std::fputc('\n', stderr);
}

void Progress::show(long long done) {
  const Clock::time_point now = Clock::now();
  const bool last = done >= total_;
  if (done == shown_done_ || (!last && now - shown_ < (terminal_ ? k_terminal_interval : k_pipe_interval)))
    return;
  shown_ = now;
  shown_done_ = done;

  const double seconds = std::chrono::duration<double>(now - started_).count();
  const double rate = static_cast<double>(done - done_before_) / std::max(seconds, 1e-9);
  const double share =
      total_ > 0 ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)) : 1.0;
  std::string line = verb_ + " " + (terminal_ ? bar(share) : "") + std::to_string(done) + "/" +
                     std::to_string(total_) + " " + unit_;
  if (done > done_before_) {
    char speed[64];
    std::snprintf(speed, sizeof speed, ", %.3g %s/s, ", rate, unit_.c_str());
    line += speed;
    line += last ? duration_text(seconds) + " in all"
                 : duration_text(static_cast<double>(total_ - done) / rate) + " left";
  }
  // \033[K clears what a longer line has left behind.
  std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", line.c_str());
  std::fflush(stderr);
}

std::string duration_text(double seconds) {
  char text[48];
  const auto whole = std::llround(seconds);
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%lld h %02lld min", whole / 3600, whole % 3600 / 60);
  } else if (whole >= 60) {
    std::snprintf(text, sizeof text, "%lld min %02lld s", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
  }
  return text;
}

}  // namespace mallow::program
