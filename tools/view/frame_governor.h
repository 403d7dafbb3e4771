#pragma once

#include <optional>
#include <span>
#include <string>

namespace mallow::view {

/// A place between realtime and accurate: factors on what the scene says.
struct Rung {
  float time_step;    ///< on the longest step
  int region_stride;  ///< on the stride of shape matching regions
  float voxels;       ///< on voxels along an edge of the surface
};

/// From accurate to realtime. Longer steps are given up first, then regions, then voxels, as bench/RESULTS.md
/// finds them to be cheapest in this order; k_as_written changes nothing.
std::span<const Rung> rungs();
inline constexpr int k_as_written = 2;

/// "steps 1.5 times as long, 1 region for 3 particles, voxels twice as wide"; empty for what changes nothing.
std::string describe(const Rung& rung);

/// Keeps a number of frames a second: goes down the rungs while frames take too long, and back up when one
/// that is more accurate would do. It never goes above what the scene says by itself.
class FrameGovernor {
 public:
  /// frames_per_second: > 0; nullopt: it keeps its hands off.
  void set_target(std::optional<double> frames_per_second) { target_ = frames_per_second; }
  std::optional<double> target() const { return target_; }
  int rung() const { return rung_; }
  /// Chosen by hand, in [0, rungs().size()).
  void set_rung(int rung);
  /// seconds: that the last frame took to step and to draw. Returns whether the rung has changed.
  bool add_frame(double seconds);

 private:
  /// Frames that are looked at together, and how many looks in a row must find room before it goes up again:
  /// what was just given up is not taken back at once.
  static constexpr int k_frames = 8, k_patience = 4;
  /// What a rung costs of the next more accurate one, at the least: going up is safe with so much room.
  static constexpr double k_room = 0.6;

  std::optional<double> target_;
  int rung_ = k_as_written;
  int frames_ = 0;
  int looks_with_room_ = 0;
  double seconds_ = 0;
};

}  // namespace mallow::view
