#include "cli/surface_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "cli/summary.h"
#include "mallow/files.h"
#include "mallow/surface.h"
#include "program/background_writer.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/frame_surface.h"

namespace mallow::cli {
namespace {

void draw_surfaces(const program::CachedRunOptions& options) {
  program::CachedRun run = program::open_cached_run(options, "surface");
  print_warning(run.cache.lock_warning());
  program::StageTimes seconds{};
  std::size_t count = 0;
  try {
    std::filesystem::create_directories(run.cache.surface_file(0).parent_path());
    Surfacer surfacer(run.scene.surface, run.threads);
    program::BackgroundWriter files;
    // Skins follow what only the run knew: they stay as they were drawn.
    const std::vector<bool> skinned = skinned_bodies(run.scene);
    const auto draw = [&](const ParticleFrame& frame, int number) {
      SurfaceParticles particles = surface_particles(frame, run.spacings);
      const std::filesystem::path earlier = run.cache.surface_file(number);
      const bool any = std::ranges::find(skinned, true) != skinned.end();
      if (!any || !std::filesystem::exists(earlier)) return surfacer.draw(particles);
      std::erase_if(particles.bodies, [&](const SurfaceBody& body) { return skinned[body.body]; });
      Mesh mesh;
      if (!particles.bodies.empty()) mesh = surfacer.draw(particles);
      program::append(program::part_of(read_mesh(earlier), skinned), mesh);
      return mesh;
    };
    count = for_each_frame(run.cache.particle_frames(), "surfacing", [&](int number) {
      const program::StageTimer timer(seconds, program::Stage::surface);
      const ParticleFrame frame = read_particles(run.cache.particles_file(number));
      const auto mesh = std::make_shared<const Mesh>(draw(frame, number));
      files.add([file = run.cache.surface_file(number), mesh] { write_mesh_ply(file, *mesh); });
    });
    {
      const program::StageTimer timer(seconds, program::Stage::surface);
      files.finish();
    }
    program::close_cached_run(run, seconds, std::array{program::Stage::surface});
    write_summary(run.cache, run.scene, run.report);
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
  std::printf("surfaces %zu\n", count);
}

}  // namespace

void add_surface_command(CLI::App& app) {
  const auto options = std::make_shared<program::CachedRunOptions>();
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
  command->add_option("--threads", options->threads, "Number of threads; 0: one for each processor")
      ->check(CLI::Range(0, 1024));
  command->callback([options] { draw_surfaces(*options); });
}

}  // namespace mallow::cli
