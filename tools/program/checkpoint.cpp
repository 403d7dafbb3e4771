#include "program/checkpoint.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/shell_word.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

// Names of the chunks that are the program's own.
constexpr const char* k_scene = "run.scene";
constexpr const char* k_plan = "run.plan";
constexpr const char* k_progress = "run.progress";
constexpr const char* k_series = "run.series";
/// Skins are counted from 0.
std::string skin_chunk(std::size_t number) {
  return "run.skin." + std::to_string(number);
}

const std::string& require_chunk(const SavedState& state, const char* name) {
  const std::string* bytes = state.find(name);
  if (!bytes) throw ConfigError(std::string("chunk '") + name + "'", "is missing");
  return *bytes;
}

/// A path that is not UTF-8 has to pass through JSON too.
std::string dumped(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string plan_text(const RunPlan& plan) {
  nlohmann::ordered_json json = {{"surface", plan.surface},
                                 {"images", plan.images},
                                 {"checkpoint_frames", plan.checkpoints.frames},
                                 {"checkpoint_seconds", plan.checkpoints.seconds}};
  if (plan.steps) json["steps"] = *plan.steps;
  return json.dump();
}

RunPlan read_plan(const std::string& text) {
  RunPlan plan;
  const auto json = nlohmann::ordered_json::parse(text);
  json.at("surface").get_to(plan.surface);
  json.at("images").get_to(plan.images);
  json.at("checkpoint_frames").get_to(plan.checkpoints.frames);
  json.at("checkpoint_seconds").get_to(plan.checkpoints.seconds);
  if (json.contains("steps")) plan.steps = json.at("steps").get<std::int64_t>();
  return plan;
}

std::vector<Skin> restore_skins(const SavedState& state, int threads) {
  std::vector<Skin> skins;
  while (const std::string* bytes = state.find(skin_chunk(skins.size())))
    skins.push_back(Skin::restore(*bytes, threads));
  return skins;
}

CheckpointedRun load(const fs::path& file, const Cache& cache, int threads) try {
  const SavedState state = read_checkpoint(file);
  RunReport report;
  const std::string* series = state.find(k_series);
  report.set_progress(nlohmann::ordered_json::parse(require_chunk(state, k_progress)));
  return {parse_scene(require_chunk(state, k_scene), cache.scene_file(), {}, {.allow_outside_paths = true}),
          read_plan(require_chunk(state, k_plan)),
          std::move(report),
          Simulation::restore(state, threads),
          restore_skins(state, threads),
          series ? *series : std::string(),
          file,
          ""};
} catch (const ConfigError& error) {
  throw IoError({file.string(), 0, 0, "", error.what()});
} catch (const nlohmann::ordered_json::exception& error) {
  throw IoError({file.string(), 0, 0, "", error.what()});
}

bool is_complete(const Cache& cache) {
  try {
    return read_report(cache.report_file()).value("complete", false);
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

Checkpoints::Checkpoints(const Scene& scene, const RunPlan& plan, const Cache& cache)
    : interval_(plan.checkpoints), scene_(print_scene(cache.moved_here(scene))), plan_(plan_text(plan)) {}

bool Checkpoints::due_after_step() const {
  return interval_.seconds > 0 && Clock::now() - taken_ >= std::chrono::duration<double>(interval_.seconds);
}

bool Checkpoints::due_after_frame(int frame) const {
  return interval_.frames > 0 && frame % interval_.frames == 0;
}

SavedState Checkpoints::take(const Simulation& simulation, std::span<const Skin> skins,
                             const RunReport& report, const Series* series) {
  SavedState state = simulation.save();
  state.chunks.push_back({k_scene, scene_});
  state.chunks.push_back({k_plan, plan_});
  state.chunks.push_back({k_progress, dumped(report.progress())});
  if (series) state.chunks.push_back({k_series, series->saved()});
  for (std::size_t k = 0; k < skins.size(); ++k) state.chunks.push_back({skin_chunk(k), skins[k].save()});
  taken_ = Clock::now();
  return state;
}

CheckpointedRun load_newest_checkpoint(const Cache& cache, int threads) {
  const fs::path newest = cache.checkpoint_file();
  std::string refused;
  for (const fs::path& file : {newest, previous_checkpoint(newest)}) {
    if (!fs::exists(file)) continue;
    try {
      CheckpointedRun run = load(file, cache, threads);
      if (!refused.empty()) fs::remove(newest);
      run.passed_over = std::move(refused);
      return run;
    } catch (const IoError& error) {
      refused += (refused.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  const std::string folder = cache.folder().string();
  if (refused.empty() && is_complete(cache))
    throw IoError({folder, 0, 0, "--resume",
                   "holds a run that is complete, and no checkpoint of it to go on from: `mallow run "
                   "--checkpoint-every` leaves one"});
  const std::string why = refused.empty() ? "holds no checkpoint: the run ended before the first one was "
                                            "due, or while it drew (`mallow render` "
                                            "draws what is missing)"
                                          : refused;
  throw IoError({folder, 0, 0, "--resume",
                 why + "; start again with: mallow run SCENE --out " + shell_word(folder) + " --overwrite"});
}

std::optional<CheckpointPlace> place_of_checkpoint(const Cache& cache) {
  for (const fs::path& file : {cache.checkpoint_file(), previous_checkpoint(cache.checkpoint_file())}) {
    try {
      RunReport report;
      report.set_progress(nlohmann::ordered_json::parse(require_chunk(read_checkpoint(file), k_progress)));
      return CheckpointPlace{report.frames, report.steps};
    } catch (const Error&) {  // the one before may be whole
    } catch (const nlohmann::ordered_json::exception&) {
    }
  }
  return std::nullopt;
}

}  // namespace mallow::program
