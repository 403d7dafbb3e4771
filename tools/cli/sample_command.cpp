#include "cli/sample_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/messages.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "program/input_files.h"
#include "program/machine.h"
#include "program/output_files.h"
#include "program/threads_option.h"

namespace mallow::cli {
namespace {

struct SampleOptions {
  std::string mesh;
  std::optional<int> count;
  std::optional<float> spacing;
  std::optional<float> size;
  std::vector<float> center;
  std::optional<float> radius;
  std::string out;
  bool overwrite = false;
  int threads = 0;
};

/// Mean number of points within `radius` of a point, itself included: what a simulation would find.
double average_neighbors(const Body& body, float radius, int threads) {
  SolverConfig config;
  config.support_radius = radius;
  config.threads = threads;
  Simulation simulation(config);
  simulation.add_body(body, Material{});
  return simulation.info().bodies.at(0).average_neighbors;
}

void write_points(const Body& body, const std::filesystem::path& file) {
  const ParticleFrame frame{body.positions, std::vector<Vec3>(body.positions.size(), Vec3::Zero()),
                            std::vector<std::uint32_t>(body.positions.size(), 0), 0, 0};
  if (file.extension() == ".ply") {
    write_particles(file, frame);
  } else {
    write_state_csv(file, frame);
  }
}

void sample_mesh(const SampleOptions& options) {
  const std::filesystem::path out = options.out;
  if (!out.empty()) {
    if (out.extension() != ".csv" && out.extension() != ".ply") {
      throw ConfigError("--out", "'" + options.out + "' must end in .csv or .ply");
    }
    program::check_writable(out);
    program::InputFiles mesh;
    mesh.add(options.mesh);
    mesh.refuse(out, "--out");
    const auto is_state = [](std::string_view text) { return text.starts_with("id,x,y,z,vx,vy,vz,body"); };
    program::refuse_to_replace(out, "--out",
                               options.overwrite ? program::Replace::overwrite : program::Replace::no,
                               out.extension() == ".csv" ? is_state : program::IsOwn());
  }
  const int threads = program::resolve_threads(options.threads);
  MeshSource source{std::filesystem::absolute(options.mesh), {}, {}};
  source.sampling.count = options.count;
  source.sampling.spacing = options.spacing;
  source.placement.size = options.size;
  if (!options.center.empty())
    source.placement.center = Vec3(options.center[0], options.center[1], options.center[2]);
  const Body body = sample(SceneBody{.source = source}, "", threads);
  print_notes(body.notes);
  std::printf("points %zu\nspacing %.9g\n", body.positions.size(), static_cast<double>(body.spacing));
  if (options.radius) {
    std::printf("average_neighbors %.2f\n", average_neighbors(body, *options.radius, threads));
  }
  if (!out.empty()) write_points(body, out);
}

}  // namespace

void add_sample_command(CLI::App& app) {
  const auto options = std::make_shared<SampleOptions>();
  CLI::App* command = app.add_subcommand("sample", "Fill a closed mesh with points");
  command->add_option("MESH", options->mesh, "Mesh file (OBJ, PLY, STL or OFF)")->required();
  CLI::Option* count = command->add_option("--count", options->count, "Number of points, met within 1%");
  CLI::Option* spacing =
      command->add_option("--spacing", options->spacing, "Distance of neighbouring points");
  count->excludes(spacing);
  command->add_option("--size", options->size, "Scale the mesh so that its longest side is this long");
  command->add_option("--center", options->center, "Move the middle of its bounds there: X Y Z")->expected(3);
  command->add_option("--radius", options->radius,
                      "Print the mean number of points within this distance of a point");
  command->add_option("--out", options->out, "Write the points to this file, .csv or .ply");
  command->add_flag("--overwrite", options->overwrite, "Replace the --out file that is there");
  program::add_threads_option(*command, options->threads);
  command->callback([options] {
    if (!options->count && !options->spacing) throw ConfigError("", "--count or --spacing is needed");
    sample_mesh(*options);
  });
}

}  // namespace mallow::cli
