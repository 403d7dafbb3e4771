#include "cli/render_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <future>
#include <memory>
#include <vector>

#include "cli/film_options.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "mallow/files.h"
#include "program/background_writer.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/input_files.h"
#include "program/stills.h"
#include "program/view_bounds.h"

namespace mallow::cli {
namespace {

struct RenderOptions : program::CachedRunOptions {
  FilmOptions film;
};

/// The frames of which pictures can be taken. A run that was ended early may lack the last frame's surface,
/// which gets no picture then; one without any shows its particles.
std::vector<int> frames_to_show(const program::Cache& cache) {
  const std::vector<int> surfaces = cache.surface_frames();
  return surfaces.empty() ? cache.particle_frames() : surfaces;
}

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

/// The camera has what the film shows in view, by up to so many of its frames.
program::Stills stills_of(const program::CachedRun& run, const std::vector<int>& frames) {
  constexpr std::size_t k_looks = 32;
  if (run.scene.render.eye || frames.empty()) {
    const int first = run.cache.particle_frames().front();
    return {run.scene, read_particles(run.cache.particles_file(first)), run.spacings, run.threads};
  }
  program::FilmBounds bounds;
  const std::size_t looks = std::min(k_looks, frames.size());
  for (std::size_t k = 0; k < looks; ++k)
    bounds.add(read_particles(
        run.cache.particles_file(frames[looks > 1 ? k * (frames.size() - 1) / (looks - 1) : 0])));
  const auto box = bounds.box(run.scene, *std::ranges::min_element(run.spacings));
  return {run.scene, box.value_or(Aabb{{-1, -1, -1}, {1, 1, 1}}), run.spacings, run.threads};
}

void render_cache(const RenderOptions& options) {
  check_film(options.film);
  program::CachedRun run = program::open_cached_run(options, "render");
  print_warning(run.cache.lock_warning());
  const program::Cache& cache = run.cache;
  program::InputFiles(run.scene).refuse(options.film.file, "--film");
  const std::vector<int> frames = frames_to_show(cache);
  program::Stills stills = stills_of(run, frames);
  stills.set_frame_time(run.report.value("frame_time", 0.0));
  program::StageTimes seconds{};
  std::size_t count = 0;
  try {
    std::filesystem::create_directories(cache.images_folder());
    cache.remove_images_but(frames);
    FrameReader reader(cache, frames);
    program::BackgroundWriter files;
    count = for_each_frame(frames, "rendering", [&](int number) {
      const program::StageTimer timer(seconds, program::Stage::pictures);
      const FrameReader::Frame frame = reader.next();
      auto picture = std::make_shared<const render::Image>(stills.take(frame.particles, frame.surface));
      files.add([&cache, number, picture] { render::write_png(cache.image_file(number), *picture); });
    });
    {
      const program::StageTimer timer(seconds, program::Stage::pictures);
      files.finish();
    }
    {
      const program::StageTimer timer(seconds, program::Stage::film);
      make_film(options.film, cache, run.scene.render.frames_per_second, run.threads);
    }
    program::close_cached_run(run, seconds, std::array{program::Stage::pictures, program::Stage::film});
    write_summary(run.cache, run.scene, run.report);
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
  std::printf("pictures %zu\n", count);
  require_film(options.film);
}

}  // namespace

void add_render_command(CLI::App& app) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* command =
      app.add_subcommand("render", "Render the pictures of an earlier run again, and make its film");
  command->add_option("DIR", options->folder, "The --out folder of a run")->required();
  command
      ->add_option("--set", options->overrides,
                   "Change how pictures look: --set render.samples=16, --set collider[0].visible=false")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--threads", options->threads, "Number of threads; 0: one for each processor")
      ->check(CLI::Range(0, 1024));
  add_film_options(*command, options->film);
  command->callback([options] { render_cache(*options); });
}

}  // namespace mallow::cli
