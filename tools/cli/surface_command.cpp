#include "cli/surface_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "mallow/files.h"
#include "mallow/surface.h"
#include "program/background_writer.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/frame_range.h"
#include "program/frame_surface.h"
#include "program/shared_frames.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct SurfaceOptions : program::CachedRunOptions {
  FrameOptions frames;
};

/// Draws the surface of a frame with the settings of a run.
class Redrawer {
 public:
  explicit Redrawer(const program::CachedRun& run)
      : run_(run), surfacer_(run.scene.surface, run.threads), skinned_(skinned_bodies(run.scene)) {}

  /// Skins follow what only the run knew: they stay as they were drawn.
  Mesh draw(int number) {
    const ParticleFrame frame = read_particles(run_.cache.particles_file(number));
    SurfaceParticles particles = surface_particles(frame, program::spacings_of(run_.bodies_at(number)));
    const std::filesystem::path earlier = run_.cache.surface_file(number);
    const bool any = std::ranges::find(skinned_, true) != skinned_.end();
    if (!any || !std::filesystem::exists(earlier)) return surfacer_.draw(particles);
    std::erase_if(particles.bodies, [&](const SurfaceBody& body) {
      return body.body < skinned_.size() && skinned_[body.body];
    });
    Mesh mesh;
    if (!particles.bodies.empty()) mesh = surfacer_.draw(particles);
    program::append(program::part_of(read_mesh(earlier), skinned_), mesh);
    return mesh;
  }

 private:
  const program::CachedRun& run_;
  Surfacer surfacer_;
  std::vector<bool> skinned_;
};

/// Draws frames; shared: where other processes do so too, else null. Returns how many.
std::size_t draw_frames(const SurfaceOptions& options, const program::CachedRun& run,
                        const std::vector<int>& frames, const program::SharedFrames* shared,
                        program::StageTimes& seconds) {
  std::filesystem::create_directories(run.cache.surface_file(0).parent_path());
  Redrawer redrawer(run);
  program::BackgroundWriter files;
  const std::size_t count = for_each_frame(
      frames, shared, options.frames.share, "surfacing", [&](int number, const FrameClaim& claim) {
        const program::StageTimer timer(seconds, program::Stage::surface);
        const auto mesh = std::make_shared<const Mesh>(redrawer.draw(number));
        files.add([file = run.cache.surface_file(number), mesh, claim] {
          write_mesh_ply(file, *mesh);
          if (claim) claim->done();
        });
      });
  const program::StageTimer timer(seconds, program::Stage::surface);
  files.finish();
  return count;
}

void draw_surfaces(const SurfaceOptions& options) {
  program::CachedRun run = program::open_cached_run(options, "surface");
  print_warning(run.cache.lock_warning());
  program::StageTimes seconds{};
  const std::vector<int> frames = run.cache.particle_frames();
  const std::vector<int> chosen = program::choose_frames(options.frames.range, frames);
  const auto finish = [&] {
    program::close_cached_run(run, seconds, std::array{program::Stage::surface});
    write_summary(run.cache, run.scene, run.report);
  };
  std::size_t count = 0;
  std::optional<program::SharedFrames> shared;
  try {
    if (options.frames.shared()) {
      shared.emplace(run.cache.folder(), "surface", print_scene(run.scene),
                     [&](int frame) -> program::SharedFrames::Files {
                       return {{run.cache.particles_file(frame)}, {run.cache.surface_file(frame)}};
                     });
      count = options.frames.elsewhere.by_scheduler()
                  ? do_frames_elsewhere(options.frames, chosen, *shared, run.cache.folder(), options.threads)
                  : draw_frames(options, run, chosen, &*shared, seconds);
      shared->join(frames, {}, finish);
    } else {
      count = draw_frames(options, run, frames, nullptr, seconds);
      finish();
    }
  } catch (const program::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
  std::printf("surfaces %zu\n", count);
  if (shared) print_left(*shared, frames, "summary.html");
}

}  // namespace

void add_surface_command(CLI::App& app) {
  const auto options = std::make_shared<SurfaceOptions>();
  CLI::App* command =
      app.add_subcommand("surface", "Draw the surfaces of an earlier run again, from its particles");
  command->add_option("DIR", options->folder, "The --out folder of a run")->required();
  command
      ->add_option(
          "--set", options->overrides,
          "Change how surfaces are drawn, against how the run drew them: --set surface.kind=spheres; what "
          "an earlier call set is forgotten")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  program::add_threads_option(*command, options->threads);
  add_frame_options(*command, options->frames);
  command->callback([options] {
    check(options->frames);
    options->shared = options->frames.shared();
    draw_surfaces(*options);
  });
}

}  // namespace mallow::cli
