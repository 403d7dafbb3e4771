#pragma once

namespace mallow::view {

/// How many threads the simulation takes beside other programs: as many as the processors that they leave, up
/// to what it was given. The motion has the same bits with any number.
class ThreadGovernor {
 public:
  /// most: >= 1.
  explicit ThreadGovernor(int most) : most_(most), threads_(most) {}
  int most() const { return most_; }
  int threads() const { return threads_; }
  /// free: processors that others left in the mean since the last look. Returns whether the number has
  /// changed.
  bool add_look(double free);

 private:
  int most_, threads_;
  int looks_below_ = 0, looks_above_ = 0;  ///< in a row
};

/// How busy the processors of this machine are with what is not this process.
class ProcessorLoad {
 public:
  ProcessorLoad() { look(); }
  /// Processors that others left in the mean since the last look; all of this process's where the system does
  /// not say.
  double look();

 private:
  double busy_ = 0, own_ = 0, wall_ = 0;  ///< at the last look [s]
};

}  // namespace mallow::view
