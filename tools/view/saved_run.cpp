// A session as it stands, in a folder, and back.
#include "mallow/files.h"
#include "program/cache.h"
#include "program/checkpoint.h"
#include "program/run_plan.h"
#include "program/run_report.h"
#include "program/shell_word.h"
#include "view/session.h"

namespace mallow::view {

void Session::save_run(const std::string& folder) {
  if (!simulation_) throw ConfigError("save", "there is no scene to save");
  const program::Cache cache = program::Cache::create(folder, false);
  std::filesystem::create_directories(cache.particles_file(0).parent_path());
  program::RunReport report;
  report.scene = scene_.file.string();
  report.threads = threads_.threads();
  report.info = simulation_->info();
  report.appearances = palette();
  report.info.bodies = bodies_;
  report.frame_time = frame_time_;
  report.frames = frame_;
  report.steps = simulation_->step_count();
  report.simulated_time = simulation_->time();
  program::RunPlan plan;
  plan.frames = scene_.run.frames;
  plan.threads = threads_.threads();
  cache.write_scene(cache.moved_here(scene_));
  // A run that goes on frames its pictures by its frame 0.
  write_particles(cache.particles_file(0), snapshot(*simulation_));
  program::Checkpoints checkpoints(scene_, plan, cache);
  write_checkpoint(cache.checkpoint_file(), checkpoints.take(*simulation_, skins_, report, nullptr));
  const std::string word = program::shell_word(folder);
  // A scene that was played for longer than it is long asks for more.
  const std::string more =
      frame_ < scene_.run.frames ? "" : " --frames " + std::to_string(frame_ + scene_.run.frames);
  say("saved in " + folder + "; it goes on with: mallow run --resume " + word + more + "  or  mallow view " +
      word);
}

void Session::open_run(const std::string& folder) {
  const program::Cache cache = program::Cache::open_to_resume(folder);
  program::CheckpointedRun saved = program::load_newest_checkpoint(cache, threads_.threads());
  take_over(std::move(saved.simulation), std::move(saved.skins), saved.report.frames);
  begin(std::move(saved.scene));
}

}  // namespace mallow::view
