#include "cli/run_info.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "mallow/errors.h"
#include "mallow/scene.h"
#include "program/cached_run.h"
#include "program/shell_word.h"

namespace mallow::cli {
namespace {

/// How a run ended, and what to do where it did not come to its end.
void print_end(const program::CachedRun& run) {
  const std::string folder = program::shell_word(run.cache.folder().string());
  const std::string error = run.report.at("error").get<std::string>();
  if (run.report.at("complete").get<bool>())
    std::printf("ended            complete\n");
  else
    std::printf("ended            not complete: %s\n", error.c_str());
  if (std::error_code unknown; std::filesystem::exists(run.cache.checkpoint_file(), unknown))
    std::printf("to go on         mallow run --resume %s%s\n", folder.c_str(),
                run.report.at("complete").get<bool>() ? " --frames N" : "");
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
  std::printf("frames           %d of %d, %g s each\n", report.at("frames").get<int>(), run.scene.run.frames,
              report.at("frame_time").get<double>());
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
