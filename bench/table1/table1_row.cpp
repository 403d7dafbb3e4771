#include "table1/table1_row.h"

#include <optional>

#include "harness/command.h"
#include "harness/statistics.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "mallow/surface.h"
#include "program/failure.h"
#include "program/run_report.h"
#include "program/stills.h"
#include "table1/plain_surface.h"
#include "table1/rest_shape.h"
#include "textbook/from_scene.h"

namespace mallow::bench {
namespace {

/// The steps of one run [ms]. The first one is left out of what is reported: it allocates.
struct Run {
  std::vector<double> steps;
  PhaseTimes phase_seconds{};
  std::uint64_t state_hash = 0;
  SimulationInfo info;    ///< at the start, as the paper counts neighbours
  std::size_t bytes = 0;  ///< at the end

  double milliseconds() const { return mean({steps.begin() + 1, steps.end()}); }
};

Run run_steps(const Scene& scene, int count, int threads) {
  Simulation simulation = build(scene, threads);
  Run run;
  run.info = simulation.info();
  for (int step = 0; step < count; ++step) {
    StepReport report;
    run.steps.push_back(milliseconds([&] { report = simulation.step(); }));
    if (step == 0) continue;
    for (std::size_t p = 0; p < k_phase_count; ++p) run.phase_seconds[p] += report.seconds[p];
  }
  run.state_hash = simulation.state_hash();
  run.bytes = simulation.info().bytes;
  return run;
}

/// Frames whose surface OpenVDB draws too, which takes seconds.
constexpr std::size_t k_plain_frames = 2;

/// Surface extraction and rendering of frames along a run [ms each].
struct Frames {
  std::vector<double> surface, picture;
  std::vector<double> plain_surface, beside_plain;  ///< OpenVDB's, and ours of the same frames
  double triangles = 0;                             ///< mean of the surfaces
  /// Mean distance of the surface at rest from what was sampled, in spacings.
  double distance = 0, plain_distance = 0;
};

/// Side of the voxels that a surfacer with so many of them along a frame takes [m].
double voxel_size(const ParticleFrame& frame, float spacing, const SurfaceConfig& config) {
  Aabb box{frame.positions[0], frame.positions[0]};
  for (const Vec3& x : frame.positions) {
    box.min = box.min.cwiseMin(x);
    box.max = box.max.cwiseMax(x);
  }
  return static_cast<double>((box.max - box.min).maxCoeff() + 2 * config.particle_radius * spacing) /
         config.voxels.value();
}

Frames draw_frames(const Scene& scene, const Table1Settings& settings, int threads) {
  Simulation simulation = build(scene, threads);
  simulation.prepare();
  std::vector<float> spacings;
  for (const BodyInfo& body : simulation.info().bodies) spacings.push_back(body.spacing);
  Surfacer surfacer(scene.surface, threads);
  program::Stills stills(scene, snapshot(simulation), spacings, threads);
  const std::filesystem::path picture = std::filesystem::temp_directory_path() / "mallow-bench-table1.png";
  Frames frames;
  const float spacing = *std::max_element(spacings.begin(), spacings.end());
  const auto draw = [&]() -> const Mesh& {
    SurfaceParticles particles = surface_particles(simulation);
    particles.velocities = {};
    return surfacer.draw(particles);
  };
  const auto draw_plain = [&](const ParticleFrame& frame) {
    return plain_surface(frame.positions, spacing, voxel_size(frame, spacing, scene.surface), threads);
  };
  const RestShape shape(scene, threads);
  const ParticleFrame rest = snapshot(simulation);
  frames.distance = shape.mean_distance(draw()) / static_cast<double>(spacing);
  frames.plain_distance = shape.mean_distance(draw_plain(rest)) / static_cast<double>(spacing);
  for (int step = 1; step <= settings.steps; ++step) {
    simulation.step();
    if (step % settings.surface_every != 0) continue;
    const ParticleFrame frame = snapshot(simulation);
    const Mesh* mesh = nullptr;
    frames.surface.push_back(milliseconds([&] { mesh = &draw(); }));
    if (frames.plain_surface.size() < k_plain_frames) {
      frames.plain_surface.push_back(milliseconds([&] { draw_plain(frame); }));
      frames.beside_plain.push_back(frames.surface.back());
    }
    frames.triangles += static_cast<double>(mesh->triangles.size());
    frames.picture.push_back(milliseconds([&] { render::write_png(picture, stills.take(frame, *mesh)); }));
  }
  std::filesystem::remove(picture);
  frames.triangles /= static_cast<double>(std::max<std::size_t>(1, frames.surface.size()));
  return frames;
}

/// Steps of the textbook implementation from the scene's start, as many as fit into the time it is given [ms
/// each].
std::vector<double> run_textbook(const Scene& scene, const Table1Settings& settings, int threads) {
  std::vector<double> steps;
  if (settings.textbook_seconds <= 0) return steps;
  textbook::Textbook textbook = textbook::from_scene(scene, threads);
  double spent = 0;
  // At least a second step: the first one is left out.
  while (static_cast<int>(steps.size()) < settings.steps &&
         (spent < 1000 * settings.textbook_seconds || steps.size() < 2)) {
    steps.push_back(milliseconds([&] { textbook.step(); }));
    spent += steps.back();
  }
  return steps;
}

/// Both over the steps that the textbook took.
void add_textbook(const std::vector<double>& textbook, const std::vector<Run>& runs, Json& row) {
  if (textbook.size() < 2) return;
  const std::vector<double> counted(textbook.begin() + 1, textbook.end());
  std::vector<double> ours;
  for (const Run& run : runs)
    ours.push_back(
        mean({run.steps.begin() + 1, run.steps.begin() + static_cast<std::ptrdiff_t>(textbook.size())}));
  row["textbook_ms"] = mean(counted);
  row["textbook_steps"] = counted.size();
  row["ms_same_steps"] = median(ours);
  row["textbook_ratio"] = mean(counted) / median(ours);
}

}  // namespace

Json to_json(const Table1Settings& settings) {
  return {{"steps", settings.steps},
          {"repeats", settings.repeats},
          {"surface_every", settings.surface_every},
          {"textbook_seconds", settings.textbook_seconds}};
}

Json measure_row(const PaperRow& paper, const Table1Settings& settings, int threads) {
  const Scene scene = read_scene(data_file("scenes/table1/" + paper.name + ".toml"));
  const Frames frames = draw_frames(scene, settings, threads);
  // The textbook between two of ours, so that both meet the machine in the same mood.
  std::vector<Run> runs;
  std::vector<double> textbook, native_ms;
  Scene native = scene;
  native.solver.arithmetic = Arithmetic::native;
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    runs.push_back(run_steps(scene, settings.steps, threads));
    // Without SPH there is nothing for it to do.
    if (paper.alpha > 0) native_ms.push_back(run_steps(native, settings.steps, threads).milliseconds());
    if (repeat == 0) textbook = run_textbook(scene, settings, threads);
  }
  std::vector<double> step_ms;
  for (const Run& run : runs) {
    step_ms.push_back(run.milliseconds());
    if (run.state_hash != runs.front().state_hash)
      throw program::RunFailure(paper.name + ": two runs end in different states, " +
                                program::hash_text(runs.front().state_hash) + " and " +
                                program::hash_text(run.state_hash));
  }

  const double ms = median(step_ms), surface_ms = median(frames.surface), picture_ms = median(frames.picture);
  const SimulationInfo& info = runs.front().info;
  const BodyInfo& body = info.bodies.front();
  Json row = {
      {"name", paper.name},
      {"figure", paper.figure},
      {"scene", "scenes/table1/" + paper.name + ".toml"},
      {"particles", info.particles},
      {"paper_particles", paper.particles},
      {"avg_neighbors", body.average_neighbors},
      {"paper_avg_neighbors", paper.neighbors},
      {"alpha", paper.alpha},
      {"gamma_u", paper.update_threshold},
      {"v_size", std::to_string(paper.voxels[0]) + "x" + std::to_string(paper.voxels[1]) + "x" +
                     std::to_string(paper.voxels[2])},
      {"ms_per_step", ms},
      {"ms_per_step_min", minimum(step_ms)},
      {"fps1", 1000 / ms},
      {"fps1_best", 1000 / minimum(step_ms)},
      {"paper_fps1", paper.fps1},
      {"fps1_ratio", 1000 / ms / paper.fps1},
      {"surface_ms", surface_ms},
      {"triangles", frames.triangles},
      {"surface_distance", frames.distance},
      {"fps2", 1000 / (ms + surface_ms)},
      {"picture_ms", picture_ms},
      {"fps2_rendered", 1000 / (ms + surface_ms + picture_ms)},
      {"paper_fps2", paper.fps2},
      {"fps2_ratio", 1000 / (ms + surface_ms) / paper.fps2},
      {"fps2_rendered_ratio", 1000 / (ms + surface_ms + picture_ms) / paper.fps2},
      {"bytes_per_particle", static_cast<double>(runs.front().bytes) / static_cast<double>(info.particles)},
      {"state_hash", program::hash_text(runs.front().state_hash)}};
  // OpenVDB leaves out spheres of less than 1.5 voxels: then it has no surface to compare with, nor where it
  // is not built.
  if (frames.plain_distance > 0) {
    row["plain_surface_ms"] = mean(frames.plain_surface);
    row["plain_surface_ratio"] = mean(frames.plain_surface) / mean(frames.beside_plain);
    row["plain_surface_distance"] = frames.plain_distance;
  }
  if (!native_ms.empty()) {
    row["native_ms"] = median(native_ms);
    row["native_ratio"] = 1000 / median(native_ms) / paper.fps1;
  }
  add_textbook(textbook, runs, row);
  Json phases;
  for (std::size_t p = 0; p < k_phase_count; ++p) {
    std::vector<double> each;
    for (const Run& run : runs)
      each.push_back(1000 * run.phase_seconds[p] / static_cast<double>(settings.steps - 1));
    phases[name(static_cast<Phase>(p))] = median(each);
  }
  row["phases_ms"] = phases;
  return row;
}

}  // namespace mallow::bench
