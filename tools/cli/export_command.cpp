#include "cli/export_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/export_animations.h"
#include "cli/export_files.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "mallow/errors.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/frame_range.h"
#include "program/input_files.h"
#include "program/run_mark.h"
#include "program/shared_frames.h"
#include "program/shell_word.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

namespace fs = std::filesystem;

void check_formats(const ExportOptions& options) {
  if (options.surface.empty() && options.particles.empty() && options.animation.empty() &&
      options.skins.empty()) {
    throw ConfigError("--surface, --particles, --animation, --skins",
                      "at least one is needed, with the formats to write");
  }
}

/// A run that was ended early may lack the last frame's surface; one without any has nothing to export.
void require_surfaces(const program::Cache& cache) {
  if (!cache.surface_frames().empty()) return;
  throw IoError({cache.folder().string(), 0, 0, "--surface",
                 "the run has no surfaces; 'mallow surface " + program::shell_word(cache.folder().string()) +
                     "' draws them"});
}

/// What plays frames is of the chosen ones alone: one of them must have a surface.
void require_chosen_surface(const program::Cache& cache, const std::string& range,
                            const std::vector<int>& chosen) {
  for (const int frame : chosen)
    if (fs::exists(cache.surface_file(frame))) return;
  throw IoError({cache.folder().string(), 0, 0, "--frames",
                 "'" + range + "' names no frame that has a surface; 'mallow surface " +
                     program::shell_word(cache.folder().string()) + "' draws them"});
}

/// A scene may name what an earlier export wrote.
void refuse_inputs(const ExportOptions& options, const program::CachedRun& run, const fs::path& out) {
  const program::InputFiles inputs(run.scene);
  const auto check = [&](const char* kind, const std::vector<std::string>& formats) {
    for (const std::string& format : formats)
      for (const int frame : run.cache.particle_frames())
        inputs.refuse(out / kind / program::frame_name(frame, format), "--out");
  };
  check("surface", options.surface);
  check("particles", options.particles);
  for (const std::string& format : options.animation) inputs.refuse(out / animation_name(format), "--out");
  if (!options.skins.empty()) inputs.refuse(out / "skins.glb", "--out");
}

/// Two exports into one folder would mix their frames.
program::RunLock lock_folder(const fs::path& out, bool shared) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw IoError({out.string(), 0, 0, "--out", "cannot be made: " + error.message()});
  program::RunLock lock = program::RunLock::for_exports(out, shared);
  if (!shared) program::forget_shared_frames(out);
  return lock;
}

/// What makes the files what they are, beside the frames that they are made of.
std::string job_of(const ExportOptions& options, const program::CachedRun& run) {
  std::string job = print_scene(run.scene) + options.up + run.report.at("groups").dump() +
                    run.report.value("past_bodies", nlohmann::ordered_json()).dump();
  for (const auto* formats : {&options.surface, &options.particles, &options.animation, &options.skins})
    for (const std::string& format : *formats) job += (format == formats->front() ? '\n' : ' ') + format;
  return job;
}

/// What plays frames, and is made of all of them.
std::vector<std::string> names_of_players(const ExportOptions& options) {
  std::vector<std::string> names;
  const auto add = [&](const char* kind, const std::vector<std::string>& formats) {
    for (const auto& [format, ending] : {std::pair{"vtp", ".pvd"}, std::pair{"usda", ".usda"}})
      if (std::ranges::count(formats, format)) names.push_back(std::string(kind) + ending);
  };
  add("surface", options.surface);
  add("particles", options.particles);
  for (const std::string& format : options.animation) names.push_back(animation_name(format));
  if (!options.skins.empty()) names.push_back("skins.glb");
  return names;
}

void add_players(const std::vector<int>& frames, Export& all) {
  for (const int number : frames) all.add_frame(number);
  all.finish();
}

/// Beside other processes. With --share the one that finds all frames of the run written adds what plays
/// them; else what plays them is of the frames that were chosen.
void share_export(const ExportOptions& options, const program::CachedRun& run, const fs::path& out,
                  const std::vector<int>& chosen, Export& all) {
  const program::SharedFrames shared(out, "export", job_of(options, run),
                                     [&](int number) { return all.files(number); });
  if (options.frames.elsewhere.by_scheduler())
    do_frames_elsewhere(options.frames, chosen, shared, out, options.threads);
  else
    for_each_frame(chosen, &shared, options.frames.share, "exporting",
                   [&](int number, const FrameClaim& claim) {
                     all.write_frame(number);
                     claim->done();
                   });
  if (!options.frames.share && !options.frames.elsewhere.by_scheduler()) return add_players(chosen, all);
  const std::vector<int> frames = run.cache.particle_frames();
  std::vector<fs::path> made;
  for (const std::string& format : options.animation) made.push_back(out / animation_name(format));
  if (!options.skins.empty()) made.push_back(out / "skins.glb");
  if (shared.join(frames, made, [&] { add_players(frames, all); }) == 0) return;
  std::string players;
  for (const std::string& name : names_of_players(options)) players += (players.empty() ? "" : ", ") + name;
  print_left(shared, frames, players);
}

void export_frames(const ExportOptions& options) {
  check_formats(options);
  const program::CachedRun run = program::open_cached_run(options, "");
  print_warning(run.cache.lock_warning());
  const program::Cache& cache = run.cache;
  if (!options.surface.empty() || !options.animation.empty() || !options.skins.empty())
    require_surfaces(cache);
  if (!options.skins.empty()) SkinAnimation{run};  // throws where there are none
  const std::vector<int> chosen = program::choose_frames(options.frames.range, cache.particle_frames());
  if (!options.frames.range.empty() && options.particles.empty())
    require_chosen_surface(cache, options.frames.range, chosen);
  const fs::path out = options.out.empty() ? cache.export_folder() : fs::path(options.out);
  refuse_inputs(options, run, out);
  const program::RunLock lock = lock_folder(out, options.frames.shared());
  print_warning(lock.warning());
  Export all(options, run, out);
  try {
    if (options.frames.shared()) return share_export(options, run, out, chosen, all);
    for_each_frame(chosen, "exporting", [&](int number) {
      all.write_frame(number);
      all.add_frame(number);
    });
    all.finish();
  } catch (const program::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
}

}  // namespace

void add_export_command(CLI::App& app) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Write the surfaces and particles of an earlier run in the formats of other programs");
  command->add_option("DIR", options->folder, "The --out folder of a run")->required();
  command
      ->add_option("--surface", options->surface,
                   "Formats of the surfaces, with commas between: obj, glb (glTF; Blender, web), "
                   "vtp (ParaView), usda (USD), vdb (level sets)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"obj", "glb", "vtp", "usda", "vdb"}));
  command
      ->add_option("--particles", options->particles,
                   "Formats of the particles: vdb (OpenVDB points; Houdini), vtp (ParaView), csv")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"vdb", "vtp", "csv"}));
  command
      ->add_option(
          "--animation", options->animation,
          "Formats of the surfaces of all frames as one file that plays them: glb (glTF; Blender, web), "
          "surface.glb; meshopt (glTF compressed with EXT_meshopt_compression; web, not Blender), "
          "surface.meshopt.glb")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glb", "meshopt"}));
  command
      ->add_option("--skins", options->skins,
                   "Formats of the skins of all frames as one animation: glb (glTF; Blender, web), skins.glb")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glb"}));
  command
      ->add_option(
          "--up", options->up,
          "The axis that points up in the files: z, as in the scene, or y; in glb it is y, as glTF has it")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for surface/ and particles/; DIR/export if left out");
  program::add_threads_option(*command, options->threads);
  command->footer(
      "Velocities: _VELOCITY in glb, Velocity in vtp, velocities in usda, v in vdb, vx vy vz in csv; "
      "an OBJ and an animation have none.\n"
      "Temperatures [K] where the scene has heat: temperature in csv, Temperature in vtp.\n"
      "Bodies of particles, counted from 0 as the groups in report.json, behind them past_bodies: Group in "
      "vtp,\n"
      "body in csv.\n"
      "Groups and materials have the names of the scene in obj (materials.mtl), glb, usda, vtp (field "
      "arrays)\n"
      "and vdb (names and metadata of grids).\n"
      "surface.pvd plays the frames at their simulated times; surface.usda plays them as the film does: a\n"
      "time code is a frame, and velocities are per second of the film.");
  add_frame_options(*command, options->frames);
  command->callback([options] {
    check(options->frames);
    export_frames(*options);
  });
}

}  // namespace mallow::cli
