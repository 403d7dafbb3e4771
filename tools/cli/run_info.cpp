#include "cli/run_info.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/scene.h"
#include "program/cached_run.h"
#include "program/checkpoint.h"
#include "program/run_report.h"
#include "program/shell_word.h"

namespace mallow::cli {
namespace {

/// The report is still that of the start: the run is on, or it was killed.
bool has_no_end(const program::CachedRun& run) {
  return run.report.at("error").get<std::string>() == program::k_not_ended_yet;
}

/// Frames after frame 0 that are there.
int frames_there(const program::CachedRun& run) {
  const int told = run.report.at("frames").get<int>();
  if (!has_no_end(run)) return told;
  const std::vector<int> frames = run.cache.particle_frames();
  return frames.empty() ? told : std::max(told, frames.back());
}

/// How a run ended, and what to do where it did not come to its end.
void print_end(const program::CachedRun& run) {
  const std::string folder = program::shell_word(run.cache.folder().string());
  const std::string error = run.report.at("error").get<std::string>();
  const bool complete = run.report.at("complete").get<bool>();
  const std::string& writer = run.cache.writer();
  const bool is_on = has_no_end(run) && !writer.empty();
  if (is_on)
    std::printf("ended            not yet: %s is at work\n", writer.c_str());
  else if (complete)
    std::printf("ended            complete\n");
  else if (has_no_end(run) && run.cache.lock_warning().empty())
    std::printf("ended            not complete: the run was killed, or the machine went down\n");
  else
    std::printf("ended            not complete: %s\n", error.c_str());
  if (!writer.empty() && !is_on) std::printf("in use           by %s\n", writer.c_str());
  const auto place = complete ? std::nullopt : program::place_of_checkpoint(run.cache);
  if (place)
    std::printf("checkpoint       at frame %d of %d, step %lld\n", place->frame, run.scene.run.frames,
                static_cast<long long>(place->step));
  if (is_on) return;
  if (std::error_code unknown;
      place || (complete && std::filesystem::exists(run.cache.checkpoint_file(), unknown)))
    std::printf("to go on         mallow run --resume %s%s\n", folder.c_str(), complete ? " --frames N" : "");
  else
    std::printf("to go on         not possible, as there is no checkpoint\n");
}

void print_files(const program::Cache& cache) {
  std::printf("files            %zu of particles, %zu surfaces, %zu pictures%s\n",
              cache.particle_frames().size(), cache.surface_frames().size(), cache.image_frames().size(),
              std::filesystem::exists(cache.film_file()) ? ", film.mp4" : "");
  std::printf("summary          %s\n", cache.summary_file().c_str());
}

void print_report(const program::CachedRun& run) {
  const nlohmann::ordered_json& report = run.report;
  std::printf("run              %s\n", run.cache.folder().c_str());
  std::printf("scene            %s", report.at("scene").get<std::string>().c_str());
  for (const auto& setting : report.at("overrides"))
    std::printf(" --set %s", program::shell_word(setting.get<std::string>()).c_str());
  if (const std::string quality = report.at("quality").get<std::string>(); !quality.empty())
    std::printf(" --quality %s", quality.c_str());
  std::printf("\nmallow           %s\n", report.at("version").get<std::string>().c_str());
  const std::size_t bodies = report.at("groups").size();
  std::printf("particles        %zu in %zu bod%s\n", report.at("particles").get<std::size_t>(), bodies,
              bodies == 1 ? "y" : "ies");
  std::printf("frames           %d of %d, %g s each\n", frames_there(run), run.scene.run.frames,
              report.at("frame_time").get<double>());
  if (!has_no_end(run))
    std::printf("steps            %lld, %g s in all\n", report.at("steps").get<long long>(),
                report.at("simulated_time").get<double>());
  print_end(run);
  print_files(run.cache);
  for (const auto& warning : report.at("warnings"))
    std::printf("warning          %s\n", warning.get<std::string>().c_str());
}

}  // namespace

void print_run(const SceneOptions& options, bool prints_scene) {
  if (!options.overrides.empty() || options.quality)
    throw ConfigError(options.file,
                      "is the folder of a run, which is as it is: --set and --quality go with a scene");
  program::CachedRunOptions opened;
  opened.folder = options.file;
  opened.looks = true;
  const program::CachedRun run = program::open_cached_run(opened, "");
  if (prints_scene) {
    std::fputs(print_scene(run.scene).c_str(), stdout);
    return;
  }
  try {
    print_report(run);
  } catch (const nlohmann::json::exception& error) {
    throw IoError({run.cache.report_file().string(), 0, 0, "", error.what()});
  }
}

}  // namespace mallow::cli
