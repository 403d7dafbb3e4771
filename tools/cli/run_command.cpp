#include "cli/run_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/film_options.h"
#include "cli/messages.h"
#include "cli/pictures.h"
#include "cli/resumed_scene.h"
#include "cli/scene_options.h"
#include "cli/summary.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "program/body_appearances.h"
#include "program/cache.h"
#include "program/checkpoint.h"
#include "program/end_warnings.h"
#include "program/failure.h"
#include "program/input_files.h"
#include "program/interrupt.h"
#include "program/machine.h"
#include "program/output_files.h"
#include "program/progress.h"
#include "program/run_loop.h"
#include "program/run_plan.h"
#include "program/run_report.h"
#include "program/scene_changes.h"
#include "program/series.h"
#include "program/shell_word.h"
#include "program/stills.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct RunOptions {
  SceneOptions scene;
  std::optional<int> frames;
  std::optional<std::int64_t> steps;
  std::string out;
  std::string resume;
  std::optional<int> checkpoint_every;
  std::optional<double> checkpoint_seconds;
  int threads = 0;
  std::string state_out;
  std::string report;
  std::string series;
  FilmOptions film;
  bool no_surface = false;
  bool no_images = false;
  bool overwrite = false;
};

/// What a run is made of, as it begins or as it goes on.
struct Run {
  Scene scene;
  program::RunPlan plan;
  program::RunReport report;
  std::optional<Simulation> simulation;
  std::vector<Skin> skins;  ///< that are drawn
  std::optional<program::Cache> cache;
  std::optional<program::Series> series;
};

/// No output may be another one, or a file of the folder that means something else there.
void check_apart(const RunOptions& options) {
  const std::string& folder = options.out.empty() ? options.resume : options.out;
  std::map<std::filesystem::path, std::string> names;
  const auto add = [&](const std::filesystem::path& file, const std::string& name,
                       const char* may_be = nullptr) {
    if (file.empty() || is_written_in_place(file)) return;
    std::error_code unknown;
    const auto [other, is_new] = names.emplace(std::filesystem::weakly_canonical(file, unknown), name);
    if (is_new || (may_be && other->second == may_be)) return;
    throw ConfigError(name, "'" + file.string() + "' is also " + other->second + "; give another name");
  };
  if (!folder.empty())
    for (const char* name : program::Cache::k_single_files)
      add(std::filesystem::path(folder) / name, std::string("the run's ") + name);
  add(options.report, "--report", "the run's report.json");
  add(options.film.file, "--film", "the run's film.mp4");
  add(options.state_out, "--state-out");
  add(options.series, "--series");
}

/// All that can be known to be wrong before anything is read.
void check_outputs(const RunOptions& options) {
  if (!options.out.empty()) program::Cache::check(options.out, options.overwrite);
  if (!options.state_out.empty()) program::check_writable(options.state_out);
  if (!options.report.empty()) program::check_writable(options.report);
  if (!options.series.empty()) program::check_writable(options.series);
  check_film(options.film);
  check_apart(options);
}

/// Whether a file that begins so is a state as CSV.
bool is_state(std::string_view beginning) {
  return beginning.starts_with("id,x,y,z,vx,vy,vz,body");
}

/// No file that somebody may miss is replaced unasked. A series of a run that goes on is continued.
void refuse_to_replace(const RunOptions& options) {
  using program::Replace;
  const Replace replace = !options.resume.empty() ? Replace::has_no_word
                          : options.overwrite     ? Replace::overwrite
                                                  : Replace::no;
  program::refuse_to_replace(options.state_out, "--state-out", replace, is_state);
  program::refuse_to_replace(options.report, "--report", replace, program::is_report);
  if (options.resume.empty())
    program::refuse_to_replace(options.series, "--series", replace, program::is_series);
  refuse_to_replace(options.film, replace);
}

/// Nothing that is written may be what is read, or is to be kept.
void refuse_inputs(const RunOptions& options, const Scene& scene) {
  const program::InputFiles inputs(scene);
  inputs.refuse(options.state_out, "--state-out");
  inputs.refuse(options.report, "--report");
  inputs.refuse(options.series, "--series");
  inputs.refuse(options.film.file, "--film");
  refuse_to_replace(options);
  if (!options.out.empty()) program::Cache::refuse_inputs(options.out, inputs, "--out", true);
  // A run that goes on reads its own scene.toml, and writes there what of it has changed.
  if (!options.resume.empty()) program::Cache::refuse_inputs(options.resume, inputs, "--resume", false);
}

Scene scene_of(const RunOptions& options) {
  Scene scene = read_scene(options.scene);
  if (options.frames) scene.run.frames = *options.frames;
  return scene;
}

program::CheckpointInterval checkpoint_interval(const RunOptions& options,
                                                program::CheckpointInterval interval) {
  if (options.checkpoint_every) interval = {*options.checkpoint_every, 0};
  if (options.checkpoint_seconds) interval.seconds = *options.checkpoint_seconds;
  return interval;
}

/// What both kinds of runs have: a simulation, and what it says of itself.
void describe(const Scene& scene, int threads, Simulation& simulation, program::RunReport& report) {
  report.threads = threads;
  std::vector<BodyInfo> by_slot = std::move(report.info.bodies);
  report.info = simulation.info();
  program::know_bodies(simulation, by_slot);
  report.info.bodies = std::move(by_slot);
  report.appearances = program::body_appearances(scene, program::material_names(report.info.bodies));
  report.frame_time = frame_time(scene, report.info);
}

Run begin(const RunOptions& options, int threads) {
  Run run;
  run.scene = scene_of(options);
  refuse_inputs(options, run.scene);
  if (!options.out.empty()) program::Cache::check_names(options.out, run.scene);
  run.plan = {.frames = run.scene.run.frames,
              .steps = options.steps,
              .surface = !options.no_surface,
              .images = !options.no_images,
              .threads = threads,
              .checkpoints = checkpoint_interval(options, {})};
  run.report.scene = options.scene.file;
  run.report.overrides = options.scene.overrides;
  if (options.scene.quality) run.report.quality = name(*options.scene.quality);
  {
    const program::StageTimer timer(run.report.stage_seconds, program::Stage::build);
    std::vector<std::string> notes;
    // Series and reports tell of the loads; no scene file has a word for them.
    if (!options.series.empty() || !options.out.empty())
      for (Collider& collider : run.scene.colliders) collider.measure_load = true;
    run.simulation.emplace(build(run.scene, threads, &notes));
    print_notes(notes);
    if (run.plan.surface && !options.out.empty()) run.skins = skins(run.scene, *run.simulation, threads);
    describe(run.scene, threads, *run.simulation, run.report);
  }
  program::watch_for_interrupt();  // from here on files are written
  if (!options.out.empty()) {
    run.cache = program::Cache::create(options.out, options.overwrite);
    print_warning(run.cache->lock_warning());
  }
  if (!options.series.empty()) run.series.emplace(options.series, *run.simulation);
  return run;
}

/// The series of a run that goes on, behind the rows that its checkpoint knows of, or from here on.
void resume_series(const RunOptions& options, const program::CheckpointedRun& saved, Run& run) try {
  if (!saved.series.empty()) {
    run.series.emplace(saved.series, options.series, *run.simulation);
  } else if (!options.series.empty()) {
    program::refuse_to_replace(options.series, "--series", program::Replace::has_no_word, program::is_series);
    run.series.emplace(options.series, *run.simulation);
    print_warning("--series " + options.series + ": begins behind frame " +
                  std::to_string(saved.report.frames) + ", as the run was started without it");
  }
} catch (const nlohmann::json::exception& error) {
  throw IoError({saved.file.string(), 0, 0, "", error.what()});
}

/// The run in a folder as its newest whole checkpoint has it.
Run resume(const RunOptions& options, int threads) {
  const auto started = std::chrono::steady_clock::now();
  program::Cache cache = program::Cache::open_to_resume(options.resume);
  print_warning(cache.lock_warning());
  program::CheckpointedRun saved = program::load_newest_checkpoint(cache, threads);
  print_warning(saved.passed_over);
  std::fprintf(stderr, "resuming from %s: step %lld, frame %d\n", saved.file.c_str(),
               static_cast<long long>(saved.report.steps), saved.report.frames);
  refuse_inputs(options, take_scene(cache, options.scene, saved));
  if (options.frames) saved.scene.run.frames = *options.frames;

  Run run;
  run.simulation = std::move(saved.simulation);
  program::watch_for_interrupt();  // from here on files are written
  resume_series(options, saved, run);
  run.scene = std::move(saved.scene);
  run.plan = saved.plan;
  run.report = std::move(saved.report);
  run.skins = std::move(saved.skins);
  run.cache = std::move(cache);
  if (options.frames) run.plan.steps.reset();
  if (options.steps) run.plan.steps = options.steps;
  run.plan.frames = run.scene.run.frames;
  run.plan.surface = run.plan.surface && !options.no_surface;
  run.plan.images = run.plan.images && !options.no_images;
  if (run.plan.images && run.scene.render.eye) check_pictures(options.film, *run.cache, run.report.frames);
  run.plan.threads = threads;
  run.plan.checkpoints = checkpoint_interval(options, run.plan.checkpoints);
  if (const std::string said = program::nothing_left(run.plan, run.report); !said.empty())
    std::fprintf(stderr, "%s\n", said.c_str());
  describe(run.scene, threads, *run.simulation, run.report);
  run.report.resumed_after.push_back(run.report.steps);
  run.report.stage_seconds[static_cast<std::size_t>(program::Stage::build)] +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return run;
}

void write_reports(const RunOptions& options, const Scene& scene, const program::Cache* cache,
                   const program::RunReport& report) {
  const nlohmann::ordered_json document = program::to_json(report);
  if (!options.report.empty()) program::write_report(options.report, document);
  if (!cache) return;
  program::write_report(cache->report_file(), document);
  write_summary(*cache, scene, document);
}

enum class RunStop { interrupted, failed, step_failed };

/// What is left of a run that ended in its middle, where that is more than nothing, and what to do with it. A
/// step that could not be taken cannot be when it is tried again.
std::string how_to_go_on(const program::Cache* cache, const program::RunReport& report, RunStop stop) {
  std::error_code unknown;
  if (!cache || !std::filesystem::exists(cache->checkpoint_file(), unknown)) return {};
  const std::string left =
      "\n  " + (report.frames == 0 ? "frame 0 is" : std::to_string(report.frames + 1) + " frames are") +
      " whole, and a checkpoint is there; ";
  if (stop == RunStop::step_failed)
    return left +
           "--resume would fail in the same step: change what the message names and run the scene anew, or "
           "restore the checkpoint in a program and change it there";
  return left + "to go on" + (stop == RunStop::failed ? ", once what is wrong is mended" : "") +
         ": mallow run --resume " + program::shell_word(cache->folder().string());
}

/// Motion and what is made of every frame, with progress on stderr and an end at Ctrl-C.
void simulate(Run& run, const program::Cache* cache) {
  const bool by_steps = run.plan.steps.has_value();
  program::Progress progress("simulating", run.plan.steps.value_or(run.plan.frames),
                             by_steps ? "steps" : "frames", by_steps ? run.report.steps : run.report.frames);
  program::RunCallbacks callbacks{.after_step = {}, .after_frame = {}, .stop = program::interrupted};
  if (by_steps)
    callbacks.after_step = [&](const program::RunReport& report) { progress.show(report.steps); };
  else
    callbacks.after_frame = [&](const program::RunReport& report) { progress.show(report.frames); };
  const program::RunEnd end = program::run_frames(run.scene, *run.simulation, run.skins, run.plan, cache,
                                                  run.report, callbacks, run.series ? &*run.series : nullptr);
  if (end == program::RunEnd::complete) return;
  throw program::Interrupted("interrupted after " + std::to_string(run.report.steps) + " steps" +
                                 (cache ? how_to_go_on(cache, run.report, RunStop::interrupted)
                                        : "; there is nothing to go on from, as --out was not given"),
                             program::interrupted());
}

/// Motion, surfaces, pictures and film; the report says what was done, also when this throws.
void run_stages(const RunOptions& options, Run& run) {
  const program::Cache* cache = run.cache ? &*run.cache : nullptr;
  simulate(run, cache);
  if (!options.state_out.empty()) write_state_csv(options.state_out, snapshot(*run.simulation));
  if (!cache || !run.plan.images) return;
  if (!run.scene.render.eye) {
    const PictureRun pictures{program::slot_bodies(run.report.info.bodies), run.report.past_bodies,
                              run.report.frame_time, run.plan.threads};
    // A run that was ended while it drew has some already.
    try {
      PictureTaker(run.scene, *cache, pictures)
          .take_all(PictureTaker::Existing::keep, run.report.stage_seconds);
    } catch (const program::Interrupted& told) {
      throw program::Interrupted(told.what() + how_to_go_on(cache, run.report, RunStop::interrupted),
                                 program::interrupted());
    }
  }
  const program::StageTimer timer(run.report.stage_seconds, program::Stage::film);
  make_film(options.film, *cache, run.scene.render.frames_per_second);
}

void print_result(const Scene& scene, const program::Cache* cache, const program::RunReport& report) {
  std::printf("particles %zu\nframes %d\nsteps %lld\nsimulated_time %.9g\nstate_hash %s\n",
              report.info.particles, report.frames, static_cast<long long>(report.steps),
              report.simulated_time, program::hash_text(report.state_hash).c_str());
  const auto print = [](const std::string& what, std::int64_t count) {
    std::printf("%s %lld\n", what.c_str(), static_cast<long long>(count));
  };
  const program::RunReport::Events& events = report.events;
  if (events.torn > 0 || events.merged > 0) {
    print("torn", events.torn);
    print("merged", events.merged);
  }
  if (events.split > 0 || events.merged_bodies > 0) {
    print("split_bodies", events.split);
    print("merged_bodies", events.merged_bodies);
  }
  if (!scene.sinks.empty()) print("drained", report.drained());
  for (std::size_t k = 0; scene.sinks.size() > 1 && k < report.sink_drained.size(); ++k)
    print(program::sink_name(k) + ".drained", report.sink_drained[k]);
  if (cache) std::printf("summary %s\n", cache->summary_file().c_str());
}

void run(const RunOptions& options) {
  program::end_at_interrupt(options.resume.empty()
                                ? "interrupted before the run began; nothing was written"
                                : "interrupted before the run went on; its folder is as it was");
  check_outputs(options);
  const int threads = program::resolve_threads(options.threads);
  Run run = options.resume.empty() ? begin(options, threads) : resume(options, threads);
  const program::Cache* out = run.cache ? &*run.cache : nullptr;
  if (out && run.plan.images) program::check_environment(run.scene);
  print_warnings(run.scene, run.report.info);

  // From here on something is computed, so what goes wrong is a failure of the run, and is reported as far as
  // it came.
  const auto close_report = [&](const std::string& why_ended) {
    run.report.error = why_ended;
    run.report.complete = why_ended.empty();
    run.report.info.particles = run.simulation->particle_count();  // some may have come or gone
    program::count_particles(*run.simulation, run.report.info.bodies);
    run.report.sink_drained.clear();
    for (const SinkId sink : run.simulation->sink_ids())
      run.report.sink_drained.push_back(static_cast<std::int64_t>(run.simulation->drained(sink)));
    run.report.simulated_time = run.simulation->time();
    run.report.state_hash = run.simulation->state_hash();
    write_reports(options, run.scene, out, run.report);
  };
  try {
    if (out) out->write_scene(run.scene);
    close_report(program::k_not_ended_yet);
    run_stages(options, run);
    std::vector<std::string> warnings =
        program::end_warnings(run.scene, run.report.info, snapshot(*run.simulation));
    if (const auto warning = program::pressed_warning(run.report.compression)) warnings.push_back(*warning);
    for (const std::string& warning : warnings) {
      print_warning(warning);
      run.report.info.warnings.push_back(warning);
    }
    close_report("");
  } catch (const std::exception& failure) {
    try {
      close_report(failure.what());
      // The state before the step that failed: what was computed is not lost.
      if (!options.state_out.empty()) write_state_csv(options.state_out, snapshot(*run.simulation));
    } catch (const std::exception&) {
      // Where the disk is full the report written at the start stays, and it says that the run did not end.
    }
    if (dynamic_cast<const program::Interrupted*>(&failure)) throw;
    const bool in_step = dynamic_cast<const StepError*>(&failure) != nullptr;
    throw program::RunFailure(
        failure.what() + how_to_go_on(out, run.report, in_step ? RunStop::step_failed : RunStop::failed));
  }
  print_result(run.scene, out, run.report);
  require_film(options.film);
}

/// What options cannot say of each other to the parser.
void check_together(const RunOptions& options) {
  if (options.resume.empty() && options.scene.file.empty()) throw CLI::RequiredError("SCENE");
  const bool kept = !options.out.empty() || !options.resume.empty();
  if (!options.film.file.empty() && !kept) throw CLI::RequiresError("--film", "--out");
  if ((options.checkpoint_every || options.checkpoint_seconds) && !kept)
    throw CLI::RequiresError("--checkpoint-every, --checkpoint-seconds", "--out");
}

}  // namespace

/// CLI's own says of -5 that it is not in a range whose end is the largest number there is.
static CLI::Validator not_negative() {
  const auto check = [](const std::string& text) {
    double value = 0;
    return CLI::detail::lexical_cast(text, value) && value >= 0 ? std::string()
                                                                : "must be a number >= 0, is " + text;
  };
  return {check, ">= 0"};
}

void add_run_command(CLI::App& app) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command =
      app.add_subcommand("run", "Simulate a scene; write particles, surfaces, pictures and a film");
  add_scene_options(*command, options->scene);
  command->get_option("SCENE")->required(false);
  CLI::Option* frames = command
                            ->add_option("--frames", options->frames,
                                         "Number of frames after frame 0, instead of the scene's run.frames")
                            ->check(not_negative());
  command->add_option("--steps", options->steps, "Number of steps to take, instead of frames")
      ->check(not_negative())
      ->excludes(frames);
  CLI::Option* out =
      command->add_option("--out", options->out, "Folder for the frames; without it no frames are written");
  CLI::Option* resume =
      command
          ->add_option("--resume", options->resume,
                       "Continue the run in this folder; the result is the same to the last bit "
                       "as without the break. With SCENE, list what differs from it")
          ->excludes(out);
  command
      ->add_option(
          "--checkpoint-every", options->checkpoint_every,
          "Frames from one checkpoint to the next; a run can be resumed from a checkpoint. One is left at "
          "its end too")
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--checkpoint-seconds", options->checkpoint_seconds,
          "Seconds from one checkpoint to the next; 0: none by time. Default: 60, or none by time with "
          "--checkpoint-every")
      ->check(not_negative());
  program::add_threads_option(
      *command, options->threads,
      "Number of threads; 0: one for each processor. The result does not depend on it");
  command->add_option("--state-out", options->state_out,
                      "Write the state after the last step to this CSV file");
  command->add_option("--report", options->report, "Write what ran and how long it took to this JSON file");
  command->add_option(
      "--series", options->series,
      "Write a row for each frame to this CSV file: heights, volume, energies, forces and more, "
      "see below. --resume continues it; with --series where it was moved to, or, where there was none, from "
      "there on");
  command->footer(
      std::string(program::series_help()) +
      "\nExit codes: 0 done; 1 the run failed, frames so far are whole; 2 the input is wrong, "
      "nothing was written;\n130 Ctrl-C or 143 SIGTERM ended it: after the step that it is at, "
      "with all files whole and a checkpoint from\nwhich --resume goes on, or before it began, with "
      "nothing written. A second signal ends it at once.\n");
  command->add_flag("--no-surface", options->no_surface, "Make no surfaces; pictures show the particles");
  CLI::Option* no_images =
      command->add_flag("--no-images", options->no_images, "Make no pictures and no film");
  add_film_options(*command, options->film);
  // A film is made of pictures.
  command->get_option("--film")->excludes(no_images);
  command
      ->add_flag("--overwrite", options->overwrite,
                 "Replace an earlier run in the --out folder, and files that are there under the names given")
      ->excludes(resume);
  command->callback([options] {
    check_together(*options);
    run(*options);
  });
}

}  // namespace mallow::cli
