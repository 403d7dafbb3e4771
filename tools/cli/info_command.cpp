#include "cli/info_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "cli/messages.h"
#include "cli/run_info.h"
#include "cli/scene_options.h"
#include "mallow/scene.h"
#include "program/machine.h"
#include "program/threads_option.h"
#include "program/units.h"

namespace mallow::cli {
namespace {

struct InfoOptions {
  SceneOptions scene;
  int threads = 0;
  bool print = false;
};

/// What a scene gives, or what follows where it gives nothing: that is marked.
std::string given_or(bool is_given, float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g%s", static_cast<double>(value), is_given ? "" : "*");
  return text;
}

const Material& material_of(const Scene& scene, const BodyInfo& body) {
  return std::ranges::find(scene.materials, body.material, &SceneMaterial::name)->material;
}

void print_bodies(const Scene& scene, const SimulationInfo& info) {
  std::printf("\n%-16s %-16s %10s %10s %10s %12s %12s %12s %12s %12s %10s  %s\n", "body", "material",
              "particles", "spacing", "mass", "rest density", "threshold", "pressure", "viscosity",
              "neighbours", "regions", "shape matching");
  bool any_is_left_out = false;
  for (const BodyInfo& body : info.bodies) {
    char neighbors[32] = "-";
    if (body.average_neighbors > 0)
      std::snprintf(neighbors, sizeof neighbors, "%.2f", body.average_neighbors);
    const Material& material = material_of(scene, body);
    const bool gives_viscosity = material.viscosity || material.viscosity_by_temperature;
    any_is_left_out =
        any_is_left_out || !material.update_threshold || !material.pressure_coefficient || !gives_viscosity;
    std::printf("%-16s %-16s %10zu %10.5g %10.5g %12.5g %12s %12s %12s %12s %10zu  %s\n", body.name.c_str(),
                body.material.c_str(), body.particles, static_cast<double>(body.spacing),
                static_cast<double>(body.particle_mass), static_cast<double>(body.rest_density),
                given_or(material.update_threshold.has_value(), body.update_threshold).c_str(),
                given_or(material.pressure_coefficient.has_value(), body.pressure_coefficient).c_str(),
                given_or(gives_viscosity, body.viscosity).c_str(), neighbors, body.regions,
                body.shape_matching ? "on" : "off");
  }
  if (any_is_left_out)
    std::printf(
        "* is left out: threshold, 40 times gravity or never where it flows by plastic_yield; pressure, as "
        "stiff "
        "as a step carries; viscosity, by spacing and gravity\n");
}

/// One number, or the least and the most of some.
std::string range_text(float least, float most) {
  char text[48];
  const auto low = static_cast<double>(least), high = static_cast<double>(most);
  if (least == most)
    std::snprintf(text, sizeof text, "%.4g", low);
  else
    std::snprintf(text, sizeof text, "%.4g to %.4g", low, high);
  return text;
}

/// Least and most of what `value` gives for rows of a body that is not empty.
template <class Value>
std::string range_of(const Simulation::Rows& rows, const Value& value) {
  float least = value(rows.begin), most = least;
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    least = std::min(least, value(row));
    most = std::max(most, value(row));
  }
  return range_text(least, most);
}

/// How stiff bodies with a shape are, and how stiff they could be. Where particles differ, from the softest
/// to the stiffest.
void print_stiffness(const Simulation& simulation, const SimulationInfo& info) {
  const std::vector<BodyId> ids = simulation.bodies();
  const std::span<const float> alphas = simulation.alphas(), factors = simulation.stiffnesses();
  std::printf("\n%-16s %20s %16s %12s %16s %14s\n", "body", "E [Pa]", "E, alpha 0 [Pa]", "E most [Pa]",
              "elastic step [s]", "region radius");
  for (std::size_t k = 0; k < info.bodies.size(); ++k) {
    const BodyInfo& body = info.bodies[k];
    if (!body.shape_matching) continue;
    const float modulus = body.youngs_modulus;
    const std::string moduli = alphas.empty() || body.particles == 0
                                   ? range_text((1 - body.alpha) * modulus, (1 - body.alpha) * modulus)
                                   : range_of(simulation.rows(ids[k]), [&](std::size_t row) {
                                       const float factor = factors.empty() ? 1.0f : factors[row];
                                       return (1 - alphas[row]) * factor * modulus;
                                     });
    std::printf("%-16s %20s %16.4g %12.4g %16.4g %12.3g h\n", body.name.c_str(), moduli.c_str(),
                static_cast<double>(modulus), static_cast<double>(body.most_youngs_modulus),
                static_cast<double>(body.elastic_time_step),
                static_cast<double>(body.region_radius / body.spacing));
  }
}

/// How warm bodies are that carry heat, what they are at that, and where it changes.
void print_heat(const Scene& scene, const Simulation& simulation, const SimulationInfo& info) {
  const std::vector<BodyId> ids = simulation.bodies();
  const std::span<const float> temperatures = simulation.temperatures(), alphas = simulation.alphas();
  if (temperatures.empty()) return;
  std::printf("\n%-16s %16s %14s %20s %22s\n", "body", "temperature [K]", "alpha at it",
              "alpha changes at [K]", "conductivity [W/(m K)]");
  for (std::size_t k = 0; k < info.bodies.size(); ++k) {
    const BodyInfo& body = info.bodies[k];
    const Material& material = material_of(scene, body);
    if (!material.temperature || body.particles == 0) continue;
    const Simulation::Rows rows = simulation.rows(ids[k]);
    const auto of = [](std::span<const float> all) { return [all](std::size_t row) { return all[row]; }; };
    const auto& melts = material.alpha_by_temperature;
    std::printf(
        "%-16s %16s %14s %20s %22.4g\n", body.name.c_str(), range_of(rows, of(temperatures)).c_str(),
        alphas.empty() ? range_text(body.alpha, body.alpha).c_str() : range_of(rows, of(alphas)).c_str(),
        melts ? range_text(melts->keys().front().time, melts->keys().back().time).c_str() : "-",
        static_cast<double>(material.conductivity));
  }
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
  const bool gives_period = scene.solver.update_period || scene.solver.update_interval;
  std::printf("shape checks     every %g s, %s\n", info.update_period,
              gives_period ? "as given" : "60 time steps");
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

/// How slow bodies are before they fall asleep, and for how long.
void print_sleep(const Scene& scene, const SimulationInfo& info) {
  double least_speed = 0, most_speed = 0, least_time = 0, most_time = 0;
  std::size_t sleepers = 0;
  for (const BodyInfo& body : info.bodies) {
    if (body.sleep_speed == 0) continue;
    least_speed = sleepers == 0 ? body.sleep_speed : std::min(least_speed, body.sleep_speed);
    least_time = sleepers == 0 ? body.sleep_time : std::min(least_time, body.sleep_time);
    most_speed = std::max(most_speed, body.sleep_speed);
    most_time = std::max(most_time, body.sleep_time);
    ++sleepers;
  }
  const auto text = [](double least, double most) {
    return range_text(static_cast<float>(least), static_cast<float>(most));
  };
  const auto source = [](bool is_given, const char* rule) { return is_given ? "as given" : rule; };
  if (sleepers == 0)
    std::printf("sleep            never\n");
  else
    std::printf("sleep            %zu of %zu bod%s, slower than %s m/s (%s) for %s s (%s)\n", sleepers,
                info.bodies.size(), info.bodies.size() == 1 ? "y" : "ies",
                text(least_speed, most_speed).c_str(),
                source(scene.solver.sleep_speed.has_value(), "0.005 spacings in a time step"),
                text(least_time, most_time).c_str(),
                source(scene.solver.sleep_time.has_value(), "60 time steps or more"));
}

/// Where matter comes from and where it goes.
void print_sources(const Scene& scene) {
  std::printf("emitters         %zu\n", scene.emitters.size());
  std::printf("sinks            %zu", scene.sinks.size());
  const char* before = ", taking";
  for (const SceneSink& sink : scene.sinks) {
    const auto number = [](float value) { return static_cast<double>(value); };
    const Vec3 &min = sink.box.min, &max = sink.box.max;
    std::printf("%s what comes %s [%g, %g, %g] to [%g, %g, %g]", before, sink.outside ? "out of" : "into",
                number(min.x()), number(min.y()), number(min.z()), number(max.x()), number(max.y()),
                number(max.z()));
    before = ",";
  }
  std::printf("\n");
}

void info(const InfoOptions& options) {
  if (std::error_code unknown; std::filesystem::is_directory(options.scene.file, unknown))
    return print_run(options.scene, options.print);
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
  const bool free_units = program::has_own_units(scene.solver);
  std::printf("gravity          %g %g %g%s\n", static_cast<double>(gravity.x()),
              static_cast<double>(gravity.y()), static_cast<double>(gravity.z()), free_units ? "" : " m/s2");
  if (free_units)
    std::printf(
        "units            the scene's own, as no planet has such gravity: m, s and Pa stand for them\n");
  std::printf("colliders        %zu\n", scene.colliders.size());
  std::printf("pins             %zu\n", scene.pins.size());
  print_sources(scene);
  std::printf("instructions     %s\n", name(info.instruction_level));
  std::printf("memory           %.1f MiB\n", static_cast<double>(info.bytes) / (1024.0 * 1024.0));
  std::printf("support radius   %g m, %s\n", static_cast<double>(info.support_radius),
              scene.solver.support_radius ? "as given" : "from the largest spacing");
  print_volume(scene, info);
  print_times(scene, info);
  print_sleep(scene, info);
  print_bodies(scene, info);
  if (shape_matching) print_stiffness(simulation, info);
  print_heat(scene, simulation, info);
  print_warnings(scene, info);
}

}  // namespace

void add_info_command(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand(
      "info", "Show what would run: particles, neighbours, phases, memory; or what a run did");
  add_scene_options(*command, options->scene);
  command->get_option("SCENE")->description("Scene file (TOML), or the folder of a run");
  program::add_threads_option(*command, options->threads);
  command->add_flag("--print", options->print, "Print only the scene, with every value in it, defaults too");
  command->callback([options] { info(*options); });
}

}  // namespace mallow::cli
