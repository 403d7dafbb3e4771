#pragma once

#include <cstddef>
#include <vector>

#include "cli/frame_loop.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "program/background_writer.h"
#include "program/cache.h"
#include "program/run_report.h"
#include "program/shared_frames.h"
#include "program/stills.h"

namespace mallow::cli {

/// What pictures ask of the run that they are of.
struct PictureRun {
  std::vector<program::SlotBody> bodies;  ///< by slot, as the run ended
  std::vector<program::PastBody> past;    ///< those that had these slots before
  double frame_time;                      ///< [s]
  int threads;
};

/// The frames of which pictures can be taken. A run that was ended early may lack the last frame's surface,
/// which gets no picture then; one without any shows its particles.
std::vector<int> frames_to_show(const program::Cache& cache);

/// Takes the pictures of a cache. A scene that says from where is seen from there; else the camera has what
/// all frames show in view. Beside the frames is noted what each picture is of.
class PictureTaker {
 public:
  /// All must outlive it.
  PictureTaker(const Scene& scene, const program::Cache& cache, const PictureRun& run);

  /// Which pictures are there: as these settings, this camera and the files of their frames make them.
  const program::SharedFrames& taken() const { return taken_; }

  enum class Existing { replace, keep };
  /// Takes the pictures of all frames. existing: what becomes of those that are taken() already. Returns how
  /// many it took. Throws Interrupted at Ctrl-C.
  std::size_t take_all(Existing existing, program::StageTimes& seconds);
  /// Takes some of these beside other processes, see for_each_frame(). Returns how many.
  std::size_t share(const std::vector<int>& chosen, bool share, program::StageTimes& seconds);

 private:
  void write(int number, const ParticleFrame& particles, const Mesh& surface, const FrameClaim& claim,
             program::BackgroundWriter& files);

  const Scene& scene_;
  const program::Cache& cache_;
  const PictureRun& run_;
  program::Stills stills_;
  program::SharedFrames taken_;
};

}  // namespace mallow::cli
