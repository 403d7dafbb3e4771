#include "mallow/run_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mallow/cache.h"
#include "mallow/failure.h"
#include "mallow/files.h"
#include "mallow/film.h"
#include "mallow/interrupt.h"
#include "mallow/machine.h"
#include "mallow/run_loop.h"
#include "mallow/run_report.h"
#include "mallow/scene.h"
#include "mallow/scene_options.h"
#include "mallow/summary.h"

namespace mallow::cli {
namespace {

struct RunOptions {
  SceneOptions scene;
  std::optional<int> frames;
  std::optional<std::int64_t> steps;
  std::string out;
  int threads = 0;
  std::string state_out;
  std::string report;
  FilmOptions film;
  bool no_surface = false;
  bool no_images = false;
  bool overwrite = false;
};

/// All that can be known to be wrong before anything is computed.
void check_outputs(const RunOptions& options) {
  if (!options.out.empty()) Cache::check(options.out, options.overwrite);
  if (!options.state_out.empty()) check_writable(options.state_out);
  if (!options.report.empty()) check_writable(options.report);
  check_film(options.film);
}

Scene scene_of(const RunOptions& options) {
  Scene scene = read_scene(options.scene);
  if (options.frames) scene.run.frames = *options.frames;
  return scene;
}

RunReport open_report(const RunOptions& options, const Scene& scene, int threads) {
  RunReport report;
  report.scene = options.scene.file;
  report.overrides = options.scene.overrides;
  if (options.scene.quality) report.quality = name(*options.scene.quality);
  report.threads = threads;
  for (const std::size_t material : group_materials(scene)) {
    report.group_materials.push_back(scene.materials[material].name);
  }
  return report;
}

void write_reports(const RunOptions& options, const Scene& scene, const Cache* cache,
                   const RunReport& report) {
  const nlohmann::ordered_json document = to_json(report);
  if (!options.report.empty()) write_report(options.report, document);
  if (!cache) return;
  write_report(cache->report_file(), document);
  write_summary(*cache, scene, document);
}

/// Motion, surfaces, pictures and film; `report` says what was done, also when this throws.
void run_stages(const RunOptions& options, const Scene& scene, Simulation& simulation, const Cache* cache,
                RunReport& report) {
  const RunPlan plan{scene.run.frames, options.steps, !options.no_surface, !options.no_images,
                     report.threads};
  run_frames(scene, simulation, plan, cache, report);
  if (!options.state_out.empty()) write_state_csv(options.state_out, snapshot(simulation));
  if (!cache || options.no_images) return;
  const StageTimer timer(report.stage_seconds, Stage::film);
  make_film(options.film, *cache, scene.render.frames_per_second, report.threads);
}

void print_result(const Cache* cache, const RunReport& report) {
  std::printf("particles %zu\nframes %d\nsteps %lld\nsimulated_time %.9g\nstate_hash %s\n",
              report.info.particles, report.frames, static_cast<long long>(report.steps),
              report.simulated_time, hash_text(report.state_hash).c_str());
  if (cache) std::printf("summary %s\n", cache->summary_file().c_str());
}

void run(const RunOptions& options) {
  check_outputs(options);
  const int threads = resolve_threads(options.threads);
  const Scene scene = scene_of(options);
  RunReport report = open_report(options, scene, threads);
  std::optional<Simulation> simulation;
  {
    const StageTimer timer(report.stage_seconds, Stage::build);
    simulation.emplace(build(scene, threads));
    report.info = simulation->info();
  }
  std::optional<Cache> cache;
  if (!options.out.empty()) cache = Cache::create(options.out, options.overwrite);
  const Cache* out = cache ? &*cache : nullptr;

  // From here on something is computed, so what goes wrong is a failure of the run, and is reported as far as
  // it came.
  watch_for_interrupt();
  const auto close_report = [&](const std::string& why_ended) {
    report.error = why_ended;
    report.complete = why_ended.empty();
    report.simulated_time = simulation->time();
    report.state_hash = simulation->state_hash();
    write_reports(options, scene, out, report);
  };
  try {
    if (cache) cache->write_scene(scene);
    close_report("the run has not ended yet");
    run_stages(options, scene, *simulation, out, report);
    close_report("");
  } catch (const std::exception& failure) {
    try {
      close_report(failure.what());
      // The state before the step that failed: what was computed is not lost.
      if (!options.state_out.empty()) write_state_csv(options.state_out, snapshot(*simulation));
    } catch (const std::exception&) {
      // Where the disk is full the report written at the start stays, and it says that the run did not end.
    }
    throw RunFailure(failure.what());
  }
  print_result(out, report);
  require_film(options.film);
}

}  // namespace

void add_run_command(CLI::App& app) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command =
      app.add_subcommand("run", "Simulate a scene; write particles, surfaces, pictures and a film");
  add_scene_options(*command, options->scene);
  CLI::Option* frames =
      command
          ->add_option("--frames", options->frames, "Frames after frame 0, instead of the scene's run.frames")
          ->check(CLI::NonNegativeNumber);
  command->add_option("--steps", options->steps, "Exactly this many steps, instead of frames")
      ->check(CLI::NonNegativeNumber)
      ->excludes(frames);
  CLI::Option* out =
      command->add_option("--out", options->out, "Folder for the frames; without it none are written");
  command
      ->add_option("--threads", options->threads,
                   "Threads; 0 takes all there are. The result does not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_option("--state-out", options->state_out, "CSV file for the state after the last step");
  command->add_option("--report", options->report, "JSON file for what ran and how long it took");
  command->add_flag("--no-surface", options->no_surface, "No surfaces; pictures show the particles");
  CLI::Option* no_images = command->add_flag("--no-images", options->no_images, "No pictures and no film");
  add_film_options(*command, options->film);
  // A film is made of pictures, and those are kept in the folder.
  command->get_option("--film")->needs(out)->excludes(no_images);
  command->add_flag("--overwrite", options->overwrite, "Replace an earlier run in the --out folder");
  command->callback([options] { run(*options); });
}

}  // namespace mallow::cli
