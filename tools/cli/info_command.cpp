#include "cli/info_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/messages.h"
#include "cli/scene_options.h"
#include "mallow/scene.h"
#include "program/machine.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct InfoOptions {
  SceneOptions scene;
  int threads = 0;
  bool print = false;
};

void print_bodies(const SimulationInfo& info) {
  std::printf("\n%-16s %-16s %10s %10s %10s %12s %12s %12s %12s %12s %10s  %s\n", "body", "material",
              "particles", "spacing", "mass", "rest density", "threshold", "pressure", "viscosity",
              "neighbours", "regions", "shape matching");
  for (const BodyInfo& body : info.bodies) {
    char neighbors[32] = "-";
    if (body.average_neighbors > 0)
      std::snprintf(neighbors, sizeof neighbors, "%.2f", body.average_neighbors);
    std::printf("%-16s %-16s %10zu %10.5g %10.5g %12.5g %12.5g %12.5g %12.5g %12s %10zu  %s\n",
                body.name.c_str(), body.material.c_str(), body.particles, static_cast<double>(body.spacing),
                static_cast<double>(body.particle_mass), static_cast<double>(body.rest_density),
                static_cast<double>(body.update_threshold), static_cast<double>(body.pressure_coefficient),
                static_cast<double>(body.viscosity), neighbors, body.regions,
                body.shape_matching ? "on" : "off");
  }
}

/// How stiff bodies with a shape are, and how stiff they could be.
void print_stiffness(const SimulationInfo& info) {
  std::printf("\n%-16s %12s %16s %12s %16s %14s\n", "body", "E [Pa]", "E, alpha 0 [Pa]", "E most [Pa]",
              "elastic step [s]", "region radius");
  for (const BodyInfo& body : info.bodies)
    if (body.shape_matching)
      std::printf("%-16s %12.4g %16.4g %12.4g %16.4g %12.3g h\n", body.name.c_str(),
                  static_cast<double>((1 - body.alpha) * body.youngs_modulus),
                  static_cast<double>(body.youngs_modulus), static_cast<double>(body.most_youngs_modulus),
                  static_cast<double>(body.elastic_time_step),
                  static_cast<double>(body.region_radius / body.spacing));
}

const char* source_of(TimeStepSource source) {
  switch (source) {
    case TimeStepSource::given:
      return "as given";
    case TimeStepSource::gravity:
      return "from spacing and gravity";
    case TimeStepSource::speed:
      return "from spacing and the fastest body";
    case TimeStepSource::modulus:
      return "from youngs_modulus, as spacing and gravity would have longer ones";
  }
  return "";
}

/// How long steps and frames are, and why.
void print_times(const Scene& scene, const SimulationInfo& info) {
  const double longest = static_cast<double>(info.longest_step);
  const double frame = frame_time(scene, info);
  const char* source = source_of(info.time_step_source);
  std::printf("time step        %g s, %s\n", static_cast<double>(info.time_step), source);
  if (info.longest_step != info.time_step) std::printf("longest step     %g s\n", longest);
  if (std::isfinite(info.unlimited_step))
    std::printf("step limit       %g s, as things are now\n", info.unlimited_step);
  else
    std::printf("step limit       none\n");
  std::printf("shape checks     every %g s\n", info.update_period);
  const double steps = std::max(1.0, std::ceil(frame / std::min(longest, info.unlimited_step) - 1e-6));
  std::printf("frames           %d of %g s, %g step%s each or more, %g s in all\n", scene.run.frames, frame,
              steps, steps == 1 ? "" : "s", scene.run.frames * frame);
}

/// How many iterations keep matter from being pressed together, and why.
void print_volume(const Scene& scene, const SimulationInfo& info) {
  if (info.volume_iterations > 0)
    std::printf("volume           kept by %d iteration%s a step%s, %s\n", info.volume_iterations,
                info.volume_iterations == 1 ? "" : "s", scene.solver.volume_tolerance > 0 ? " at most" : "",
                scene.solver.volume_iterations ? "as given" : "as a body flows by plastic_yield");
  else
    std::printf("volume           by pressure alone\n");
}

void info(const InfoOptions& options) {
  const Scene scene = read_scene(options.scene);
  if (options.print) {
    std::fputs(print_scene(scene).c_str(), stdout);
    return;
  }
  std::vector<std::string> notes;
  Simulation simulation = build(scene, program::resolve_threads(options.threads), &notes);
  print_notes(notes);
  const SimulationInfo info = simulation.info();
  const bool shape_matching = std::any_of(info.bodies.begin(), info.bodies.end(),
                                          [](const BodyInfo& body) { return body.shape_matching; });
  const auto on_off = [](bool on) { return on ? "on" : "off"; };
  std::printf("scene            %s\n", options.scene.file.c_str());
  std::printf("particles        %zu in %zu bod%s\n", info.particles, info.bodies.size(),
              info.bodies.size() == 1 ? "y" : "ies");
  std::printf("shape matching   %s\n", on_off(shape_matching));
  std::printf("SPH              %s\n", on_off(info.sph));
  std::printf("viscosity        %s\n", on_off(info.viscosity));
  std::printf("body contact     %s\n", on_off(info.cross_group));
  const Vec3& gravity = scene.solver.gravity;
  std::printf("gravity          %g %g %g m/s2\n", static_cast<double>(gravity.x()),
              static_cast<double>(gravity.y()), static_cast<double>(gravity.z()));
  std::printf("colliders        %zu\n", scene.colliders.size());
  std::printf("pins             %zu\n", scene.pins.size());
  std::printf("instructions     %s\n", name(info.instruction_level));
  std::printf("memory           %.1f MiB\n", static_cast<double>(info.bytes) / (1024.0 * 1024.0));
  std::printf("support radius   %g m, %s\n", static_cast<double>(info.support_radius),
              scene.solver.support_radius ? "as given" : "from the largest spacing");
  print_volume(scene, info);
  print_times(scene, info);
  print_bodies(info);
  if (shape_matching) print_stiffness(info);
  print_warnings(scene, info);
}

}  // namespace

void add_info_command(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      app.add_subcommand("info", "Show what would run: particles, neighbours, phases, memory");
  add_scene_options(*command, options->scene);
  program::add_threads_option(*command, options->threads);
  command->add_flag("--print", options->print, "Print only the scene, with every value in it, defaults too");
  command->callback([options] { info(*options); });
}

}  // namespace mallow::cli
