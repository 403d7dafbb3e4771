#include "cli/render_command.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/film_options.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/pictures.h"
#include "cli/summary.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/film.h"
#include "program/frame_range.h"
#include "program/input_files.h"
#include "program/shared_frames.h"
#include "program/stills.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct RenderOptions : program::CachedRunOptions {
  FilmOptions film;
  bool overwrite = false;
  FrameOptions frames;
};

PictureRun picture_run(const program::CachedRun& run) {
  return {.bodies = run.bodies,
          .past = run.past,
          .frame_time = run.report.value("frame_time", 0.0),
          .threads = run.threads};
}

/// Film, scene and reports, once all pictures are there.
void finish(const RenderOptions& options, program::CachedRun& run, program::StageTimes& seconds) {
  {
    const program::StageTimer timer(seconds, program::Stage::film);
    make_film(options.film, run.cache, run.scene.render.frames_per_second);
  }
  program::close_cached_run(run, seconds, std::array{program::Stage::pictures, program::Stage::film});
  write_summary(run.cache, run.scene, run.report);
}

/// Beside other processes; the one that finds all pictures taken joins the film.
void share_rendering(const RenderOptions& options, program::CachedRun& run, const std::vector<int>& chosen) {
  const program::Cache& cache = run.cache;
  const PictureRun pictures = picture_run(run);
  PictureTaker taker(run.scene, cache, pictures);
  program::StageTimes seconds{};
  const std::size_t count =
      options.frames.elsewhere.by_scheduler()
          ? do_frames_elsewhere(options.frames, chosen, taker.taken(), cache.folder(), options.threads)
          : taker.share(chosen, options.frames.share, seconds);
  std::vector<std::filesystem::path> made;
  if (!options.film.no_film && program::can_make_films())
    made.push_back(options.film.file.empty() ? cache.film_file() : std::filesystem::path(options.film.file));
  taker.taken().join(frames_to_show(cache), made, [&] { finish(options, run, seconds); });
  std::printf("pictures %zu\n", count);
  print_left(taker.taken(), frames_to_show(cache), made.empty() ? "summary.html" : "the film");
}

void render_cache(const RenderOptions& options) {
  check_film(options.film);
  program::CachedRun run = program::open_cached_run(options, "render");
  print_warning(run.cache.lock_warning());
  program::InputFiles(run.scene).refuse(options.film.file, "--film");
  refuse_to_replace(options.film, options.overwrite ? program::Replace::overwrite : program::Replace::no);
  program::check_environment(run.scene);
  const std::vector<int> chosen = program::choose_frames(options.frames.range, frames_to_show(run.cache));
  try {
    if (options.frames.shared()) {
      share_rendering(options, run, chosen);
    } else {
      program::StageTimes seconds{};
      const PictureRun pictures = picture_run(run);
      const std::size_t count =
          PictureTaker(run.scene, run.cache, pictures).take_all(PictureTaker::Existing::replace, seconds);
      finish(options, run, seconds);
      std::printf("pictures %zu\n", count);
    }
  } catch (const program::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
  require_film(options.film);
}

}  // namespace

void add_render_command(CLI::App& app) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* command =
      app.add_subcommand("render", "Render the pictures of an earlier run again, and make its film");
  command->add_option("DIR", options->folder, "The --out folder of a run")->required();
  command
      ->add_option(
          "--set", options->overrides,
          "Change how pictures look: --set render.samples=16, --set collider[0].visible=false; what an "
          "earlier call set is forgotten")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  program::add_threads_option(*command, options->threads);
  add_film_options(*command, options->film);
  command->add_flag("--overwrite", options->overwrite,
                    "Replace the file of --film where it is no film of mallow's");
  add_frame_options(*command, options->frames);
  command->callback([options] {
    check(options->frames);
    options->shared = options->frames.shared();
    render_cache(*options);
  });
}

}  // namespace mallow::cli
