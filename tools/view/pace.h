#pragma once

#include <algorithm>
#include <cmath>

namespace mallow::view {

/// How far simulated time may go: along with the wall's, at a rate. What falls behind is not caught up with
/// in a rush: then the scene is in slow motion.
class Pace {
 public:
  /// Simulated seconds in one of the wall; infinite: as fast as it goes.
  void set_rate(double rate) { rate_ = rate; }
  /// lag: by how much simulated time may be behind at most [s]. time: simulated [s].
  void add_wall(double wall, double time, double lag) {
    if (std::isfinite(rate_) && last_wall_ >= 0) allowed_ += rate_ * (wall - last_wall_);
    last_wall_ = wall;
    allowed_ = std::clamp(allowed_, time - lag, time + lag);
  }
  /// From here on, after a pause or a jump.
  void restart(double time) {
    allowed_ = time;
    last_wall_ = -1;
  }
  bool allows(double time) const { return !std::isfinite(rate_) || allowed_ > time; }

 private:
  double rate_ = 1, allowed_ = 0, last_wall_ = -1;
};

}  // namespace mallow::view
