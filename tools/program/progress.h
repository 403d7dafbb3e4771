#pragma once

#include <chrono>
#include <string>

namespace mallow::program {

/// How far a job is, with rate and time left, on stderr: one line with a bar on a terminal, a plain line
/// every two seconds in a pipe.
class Progress {
 public:
  /// "simulating", 240, "frames"; so many of them were done before, and took no time now.
  Progress(std::string verb, long long total, std::string unit, long long done_before = 0);
  ~Progress();  ///< ends the line on a terminal
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total are done. Cheap where nothing is due.
  void show(long long done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string verb_;
  long long total_;
  long long done_before_;
  std::string unit_;
  bool terminal_;
  Clock::time_point started_;
  Clock::time_point shown_;
  long long shown_done_ = -1;
};

/// "1 h 02 min", "3 min 20 s", "12 s".
std::string duration_text(double seconds);

}  // namespace mallow::program
