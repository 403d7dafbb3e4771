#include "cli/render_command.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "cli/film_options.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "mallow/files.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/input_files.h"
#include "program/stills.h"

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

void render_cache(const RenderOptions& options) {
  check_film(options.film);
  program::CachedRun run = program::open_cached_run(options, "render");
  print_warning(run.cache.lock_warning());
  const program::Cache& cache = run.cache;
  program::InputFiles(run.scene).refuse(options.film.file, "--film");
  const ParticleFrame first = read_particles(cache.particles_file(cache.particle_frames().front()));
  program::Stills stills(run.scene, first, run.spacings, run.threads);
  const std::vector<int> frames = frames_to_show(cache);
  const bool surfaces = !cache.surface_frames().empty();
  program::StageTimes seconds{};
  std::size_t count = 0;
  try {
    std::filesystem::create_directories(cache.images_folder());
    cache.remove_images_but(frames);
    count = for_each_frame(frames, "rendering", [&](int number) {
      const program::StageTimer timer(seconds, program::Stage::pictures);
      stills.take(read_particles(cache.particles_file(number)),
                  surfaces ? read_mesh(cache.surface_file(number)) : Mesh{}, cache.image_file(number));
    });
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
