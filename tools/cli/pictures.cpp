#include "cli/pictures.h"

#include <algorithm>
#include <filesystem>
#include <future>
#include <memory>
#include <vector>

#include "cli/frame_loop.h"
#include "mallow/files.h"
#include "program/background_writer.h"
#include "program/film_bounds.h"
#include "program/stills.h"

namespace mallow::cli {
namespace {

/// Reads the frames one after another, each while the picture of the one before is taken.
class FrameReader {
 public:
  struct Frame {
    ParticleFrame particles;
    Mesh surface;
  };
  FrameReader(const program::Cache& cache, const std::vector<int>& frames)
      : cache_(cache), frames_(frames), with_surfaces_(!cache.surface_frames().empty()) {
    start_next();
  }
  Frame next() {
    Frame frame = coming_.get();
    start_next();
    return frame;
  }

 private:
  void start_next() {
    if (next_ == frames_.size()) return;
    coming_ = std::async(std::launch::async, [this, number = frames_[next_++]]() -> Frame {
      return {read_particles(cache_.particles_file(number)),
              with_surfaces_ ? read_mesh(cache_.surface_file(number)) : Mesh{}};
    });
  }
  const program::Cache& cache_;
  const std::vector<int>& frames_;
  bool with_surfaces_;
  std::size_t next_ = 0;
  std::future<Frame> coming_;
};

/// The camera has what the run shows in view, by up to so many of its frames, whichever pictures are taken.
program::Stills stills_of(const Scene& scene, const program::Cache& cache, const PictureRun& run) {
  constexpr std::size_t k_looks = 128;
  const std::vector<int> frames = cache.particle_frames();
  const std::size_t looks = scene.render.eye ? 1 : std::min(k_looks, frames.size());
  program::FilmBounds bounds(run.spacings);
  for (std::size_t k = 0; k < looks; ++k)
    bounds.add(
        read_particles(cache.particles_file(frames[looks > 1 ? k * (frames.size() - 1) / (looks - 1) : 0])));
  return {scene, bounds, run.spacings, run.threads};
}

/// Ready for pictures of any of `frames`.
program::Stills prepare(const Scene& scene, const program::Cache& cache, const PictureRun& run,
                        const std::vector<int>& frames) {
  program::Stills stills = stills_of(scene, cache, run);
  stills.set_frame_time(run.frame_time);
  std::filesystem::create_directories(cache.images_folder());
  cache.remove_images_but(frames);
  return stills;
}

}  // namespace

std::vector<int> frames_to_show(const program::Cache& cache) {
  const std::vector<int> surfaces = cache.surface_frames();
  return surfaces.empty() ? cache.particle_frames() : surfaces;
}

std::size_t share_pictures(const Scene& scene, const program::Cache& cache, const PictureRun& run,
                           const std::vector<int>& chosen, const program::SharedFrames& shared, bool share,
                           program::StageTimes& seconds) {
  const bool with_surfaces = !cache.surface_frames().empty();
  program::Stills stills = prepare(scene, cache, run, frames_to_show(cache));
  program::BackgroundWriter files;
  const std::size_t count =
      for_each_frame(chosen, &shared, share, "rendering", [&](int number, const FrameClaim& claim) {
        const program::StageTimer timer(seconds, program::Stage::pictures);
        const ParticleFrame particles = read_particles(cache.particles_file(number));
        const Mesh surface = with_surfaces ? read_mesh(cache.surface_file(number)) : Mesh{};
        stills.set_appearances(run.appearances(number));
        auto picture = std::make_shared<const render::Image>(stills.take(particles, surface));
        files.add([&cache, number, picture, claim] {
          render::write_png(cache.image_file(number), *picture);
          claim->done();
        });
      });
  const program::StageTimer timer(seconds, program::Stage::pictures);
  files.finish();
  return count;
}

std::size_t take_pictures(const Scene& scene, const program::Cache& cache, const PictureRun& run,
                          program::StageTimes& seconds) {
  const std::vector<int> frames = frames_to_show(cache);
  program::Stills stills = prepare(scene, cache, run, frames);
  FrameReader reader(cache, frames);
  program::BackgroundWriter files;
  for_each_frame(frames, "rendering", [&](int number) {
    const program::StageTimer timer(seconds, program::Stage::pictures);
    const FrameReader::Frame frame = reader.next();
    stills.set_appearances(run.appearances(number));
    auto picture = std::make_shared<const render::Image>(stills.take(frame.particles, frame.surface));
    files.add([&cache, number, picture] { render::write_png(cache.image_file(number), *picture); });
  });
  const program::StageTimer timer(seconds, program::Stage::pictures);
  files.finish();
  return frames.size();
}

}  // namespace mallow::cli
