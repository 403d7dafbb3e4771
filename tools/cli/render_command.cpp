#include "cli/render_command.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>

#include "cli/film_options.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/pictures.h"
#include "cli/summary.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/input_files.h"

namespace mallow::cli {
namespace {

struct RenderOptions : program::CachedRunOptions {
  FilmOptions film;
};

void render_cache(const RenderOptions& options) {
  check_film(options.film);
  program::CachedRun run = program::open_cached_run(options, "render");
  print_warning(run.cache.lock_warning());
  const program::Cache& cache = run.cache;
  program::InputFiles(run.scene).refuse(options.film.file, "--film");
  program::StageTimes seconds{};
  std::size_t count = 0;
  try {
    count = take_pictures(
        run.scene, cache,
        {.spacings = run.spacings, .frame_time = run.report.value("frame_time", 0.0), .threads = run.threads},
        seconds);
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
