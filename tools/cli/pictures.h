#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "mallow/scene.h"
#include "program/cache.h"
#include "program/run_report.h"
#include "program/shared_frames.h"

namespace mallow::cli {

/// What pictures ask of the run that they are of.
struct PictureRun {
  std::vector<float> spacings;  ///< h of each body [m]
  /// Of each body, by the slot that it has in a frame.
  std::function<std::vector<Appearance>(int frame)> appearances;
  double frame_time;  ///< [s]
  int threads;
};

/// The frames of which pictures can be taken. A run that was ended early may lack the last frame's surface,
/// which gets no picture then; one without any shows its particles.
std::vector<int> frames_to_show(const program::Cache& cache);

/// Takes pictures of some of these frames beside other processes, see for_each_frame(). Returns how many.
std::size_t share_pictures(const Scene& scene, const program::Cache& cache, const PictureRun& run,
                           const std::vector<int>& chosen, const program::SharedFrames& shared, bool share,
                           program::StageTimes& seconds);

/// Takes the pictures of all frames of a cache, in place of those that are there, and returns how many. A
/// scene that says from where is seen from there; else the camera has what all frames show in view. Throws
/// Interrupted at Ctrl-C.
std::size_t take_pictures(const Scene& scene, const program::Cache& cache, const PictureRun& run,
                          program::StageTimes& seconds);

}  // namespace mallow::cli
