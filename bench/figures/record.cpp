#include "figures/record.h"

#include "harness/command.h"
#include "harness/statistics.h"
#include "program/run_report.h"

namespace mallow::bench {
namespace {

Json about(const Take& take, const Scene& scene, const SimulationInfo& info) {
  const BodyInfo& body = info.bodies.front();
  return {{"take", take.name},
          {"scene", take.scene},
          {"overrides", take.overrides},
          {"particles", info.particles},
          {"spacing", body.spacing},
          {"support_radius", *scene.solver.support_radius},
          {"region_radius", body.region_radius},
          {"average_neighbors", body.average_neighbors},
          {"alpha", scene.materials.front().material.alpha.at(0)},
          {"steps", scene.run.frames}};
}

}  // namespace

Run record(const Figure& figure, const Take& take, int threads, const FrameVisitor& visit) {
  const Scene scene = read_scene(data_file("scenes/" + take.scene), take.overrides);
  Simulation simulation = build(scene, threads);
  const SimulationInfo info = simulation.info();
  const double spacing = static_cast<double>(info.bodies.front().spacing);
  Run run{.recording = {.spacing = spacing, .curves = {}}, .times = {}, .about = about(take, scene, info)};

  const std::vector<Vec3> start = simulation.positions_by_id();
  const auto look = [&](int number) {
    const ParticleFrame frame = snapshot(simulation);
    const std::vector<double> values =
        figure.measure({.start = start,
                        .now = frame.positions,
                        .spacing = spacing,
                        .support_radius = static_cast<double>(*scene.solver.support_radius),
                        .threads = threads});
    for (std::size_t q = 0; q < values.size(); ++q)
      run.recording.curves[figure.quantities[q].key].push_back(values[q]);
    run.times.push_back(frame.time);
    visit(scene, info, number, frame);
  };
  Json updates = Json::array();
  const double milliseconds_spent = milliseconds([&] {
    look(0);
    for (int number = 1; number <= scene.run.frames; ++number) {
      if (simulation.step().updated_references > 0) updates.push_back(number);
      look(number);
    }
  });
  run.about["reference_updates"] = std::move(updates);
  run.about["simulated_time"] = simulation.time();
  run.about["seconds"] = milliseconds_spent / 1000;
  run.about["state_hash"] = program::hash_text(simulation.state_hash());
  return run;
}

}  // namespace mallow::bench
