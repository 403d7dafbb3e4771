#include "program/run_loop.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mallow/files.h"
#include "program/background_writer.h"
#include "program/body_appearances.h"
#include "program/checkpoint.h"
#include "program/failure.h"
#include "program/frame_surface.h"
#include "program/stills.h"

namespace mallow::program {
namespace {

using ParticleFramePointer = std::shared_ptr<const ParticleFrame>;

/// Writes particles, surface and picture of a frame, and keeps the time of each: what the run waits for, as
/// files are written by another thread while it goes on.
class FrameWriter {
 public:
  FrameWriter(const Scene& scene, std::span<Skin> skins, const RunPlan& plan, const Cache& cache,
              const ParticleFrame& first, RunReport& report, const Series* series)
      : scene_(scene),
        cache_(cache),
        report_(report),
        series_(series),
        skins_(skins),
        checkpoints_(scene, plan, cache),
        checkpointed_step_(report.steps),
        whole_frames_(report.frames) {
    if (plan.surface) {
      std::filesystem::create_directories(cache.surface_file(0).parent_path());
      surface_.emplace(scene.surface, skins, plan.threads);
    }
    if (plan.images && scene.render.eye) {  // else the camera waits for what the film will show
      std::filesystem::create_directories(cache.images_folder());
      stills_.emplace(scene, first, spacings_of(slot_bodies(report.info.bodies), report.past_bodies),
                      plan.threads);
      stills_->set_appearances(report.appearances);
      stills_->set_frame_time(report.frame_time);
    }
  }

  /// Nothing is on its way any more, and the report speaks of no frame that did not get there.
  ~FrameWriter() {
    try {
      files_.finish();
    } catch (...) {
      // The run ended with this already, or with what came before it.
    }
    report_.frames = std::min(report_.frames, whole_frames_);
  }
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// frame: the particles of the simulation as they are now. Returns the surface where there is one.
  std::shared_ptr<const Mesh> write(int number, const Simulation& simulation,
                                    const ParticleFramePointer& frame) {
    {
      const StageTimer timer(report_.stage_seconds, Stage::particles);
      files_.add([this, number, frame] {
        write_particles(cache_.particles_file(number), *frame);
        if (!surface_) whole_frames_ = number;
      });
    }
    auto mesh = std::make_shared<const Mesh>();
    if (surface_) {
      const StageTimer timer(report_.stage_seconds, Stage::surface);
      mesh = std::make_shared<const Mesh>(draw_surface(simulation));
      files_.add([this, number, mesh] {
        write_mesh_ply(cache_.surface_file(number), *mesh);
        whole_frames_ = number;
      });
    }
    const std::vector<SlotBody> before = slot_bodies(report_.info.bodies);
    if (follow_bodies(simulation, report_.info.bodies)) {
      const std::vector<SlotBody> now = slot_bodies(report_.info.bodies);
      std::ranges::copy(past_bodies(before, now, number), std::back_inserter(report_.past_bodies));
      report_.appearances = body_appearances(scene_, material_names(now));
      if (stills_) stills_->set_appearances(report_.appearances);
    }
    if (stills_) {
      const StageTimer timer(report_.stage_seconds, Stage::pictures);
      auto picture = std::make_shared<const render::Image>(stills_->take(*frame, *mesh));
      files_.add([this, number, picture] { render::write_png(cache_.image_file(number), *picture); });
    }
    return surface_ ? mesh : nullptr;
  }

  /// A checkpoint behind the files of all frames so far, so that those need not be made again.
  void write_checkpoint(const Simulation& simulation) {
    const auto state =
        std::make_shared<const SavedState>(checkpoints_.take(simulation, skins_, report_, series_));
    files_.add([this, state] { mallow::write_checkpoint(cache_.checkpoint_file(), *state); });
    checkpointed_step_ = simulation.step_count();
  }
  void after_step(const Simulation& simulation) {
    if (checkpoints_.due_after_step()) write_checkpoint(simulation);
  }
  void after_frame(const Simulation& simulation) {
    if (checkpoints_.due_after_frame(report_.frames) || checkpoints_.due_after_step())
      write_checkpoint(simulation);
  }

  /// A run that is complete can be made longer from where it ended.
  void after_run(const Simulation& simulation) {
    if (checkpoints_.are_wanted() && checkpointed_step_ != simulation.step_count())
      write_checkpoint(simulation);
  }

  /// Where a run ends in its middle: what was computed until then is kept, if it can be.
  void after_failure(const Simulation& simulation) noexcept try {
    after_run(simulation);
    finish();
  } catch (...) {
    // What ended the run is what is told of; an earlier checkpoint is still there.
  }

  /// Waits until all files are there.
  void finish() {
    const StageTimer timer(report_.stage_seconds, surface_ ? Stage::surface : Stage::particles);
    files_.finish();
  }

 private:
  Mesh draw_surface(const Simulation& simulation) try {
    return surface_->draw(simulation);
  } catch (const ConfigError& error) {
    if (skins_.empty()) throw;
    throw RunFailure(std::string(error.what()) + ", or go on with --no-surface");
  }

  const Scene& scene_;
  const Cache& cache_;
  RunReport& report_;
  const Series* series_;
  std::span<Skin> skins_;
  Checkpoints checkpoints_;
  std::int64_t checkpointed_step_;  ///< of the last checkpoint; that of the state that the run begins from
  std::optional<FrameSurface> surface_;
  std::optional<Stills> stills_;
  int whole_frames_;        ///< the last frame of which all files are there; read when none is being written
  BackgroundWriter files_;  // last: its thread uses the others
};

/// Frame 0, which every picture is framed by: as the simulation has it, or of the run that goes on.
ParticleFramePointer first_frame(const Simulation& simulation, const Cache& cache) {
  return std::make_shared<const ParticleFrame>(
      simulation.step_count() == 0 ? snapshot(simulation) : read_particles(cache.particles_file(0)));
}

/// What a run that is asked to end leaves behind.
void write_last_checkpoint(const Simulation& simulation, FrameWriter& writer, const RunReport& report) try {
  writer.write_checkpoint(simulation);
  writer.finish();
} catch (const Error& error) {
  throw RunFailure("interrupted after " + std::to_string(report.steps) +
                   " steps, and no checkpoint could be written: " + error.what());
}

/// What run_frames() does, once it has a writer where there is a cache.
RunEnd run_with(FrameWriter* writer, const ParticleFramePointer& first, Simulation& simulation,
                const RunPlan& plan, RunReport& report, const RunCallbacks& callbacks, Series* series) {
  const auto add_row = [&](int number, const Mesh* surface) {
    if (!series) return;
    series->add_row(number, simulation, surface ? std::optional(enclosed_volume(*surface)) : std::nullopt);
  };
  std::shared_ptr<const Mesh> surface;
  if (report.steps == 0) {
    if (writer) surface = writer->write(0, simulation, first);
    add_row(0, surface.get());
  }

  const auto steps_left = [&] { return !plan.steps || report.steps < *plan.steps; };
  const auto ended = [&] { return plan.steps ? !steps_left() : report.frames >= plan.frames; };
  while (!ended()) {
    const int number = report.frames + 1;
    const double frame_end = number * report.frame_time;
    while (simulation.time() < frame_end && steps_left()) {
      if (callbacks.stop && callbacks.stop()) {
        if (writer) write_last_checkpoint(simulation, *writer, report);
        return RunEnd::stopped;
      }
      {
        const StageTimer timer(report.stage_seconds, Stage::motion);
        const StepReport step = simulation.step_towards(frame_end);
        report.add(step, simulation);
        if (series) series->add_step(step, simulation);
      }
      // At the end of a frame its files and its row come first.
      if (writer && simulation.time() < frame_end) writer->after_step(simulation);
      if (callbacks.after_step) callbacks.after_step(report);
    }
    if (simulation.time() < frame_end) break;
    if (writer)
      surface =
          writer->write(number, simulation, std::make_shared<const ParticleFrame>(snapshot(simulation)));
    add_row(number, surface.get());
    report.frames = number;
    if (writer) writer->after_frame(simulation);
    if (callbacks.after_frame) callbacks.after_frame(report);
  }
  if (writer) {
    writer->after_run(simulation);
    writer->finish();
  }
  return RunEnd::complete;
}

}  // namespace

RunEnd run_frames(const Scene& scene, Simulation& simulation, std::span<Skin> skins, const RunPlan& plan,
                  const Cache* cache, RunReport& report, const RunCallbacks& callbacks, Series* series) {
  if (!cache) return run_with(nullptr, nullptr, simulation, plan, report, callbacks, series);
  const ParticleFramePointer first = first_frame(simulation, *cache);
  FrameWriter writer(scene, skins, plan, *cache, *first, report, series);
  try {
    return run_with(&writer, first, simulation, plan, report, callbacks, series);
  } catch (...) {
    writer.after_failure(simulation);
    throw;
  }
}

std::string nothing_left(const RunPlan& plan, const RunReport& report) {
  if (plan.steps ? report.steps < *plan.steps : report.frames < plan.frames) return {};
  const std::string more = plan.steps ? "--steps " + std::to_string(2 * report.steps)
                                      : "--frames " + std::to_string(report.frames + plan.frames);
  return "nothing is left to run: there are " + std::to_string(report.frames) + " frames in " +
         std::to_string(report.steps) + " steps already; to go on ask for more, as " + more;
}

}  // namespace mallow::program
