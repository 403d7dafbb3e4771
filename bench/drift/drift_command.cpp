#include "drift/drift_command.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "drift/flight.h"
#include "harness/command.h"

namespace mallow::bench {
namespace {

struct DriftOptions : CommonOptions {
  int steps = 10'000;
};

/// Powers of ten, and the last step.
std::vector<int> times(int steps) {
  std::vector<int> list;
  for (int at = 10; at < steps; at *= 10) list.push_back(at);
  list.push_back(steps);
  return list;
}

double relative(double value, double reference) {
  return reference > 0 ? value / reference : value;
}

/// What is kept where nothing acts from outside, over a whole flight, relative to mean |v| and |x| |v|.
Json conserved(const std::vector<Snapshot>& flight, const DriftScene& scene) {
  const Eigen::Vector3d gravity = scene.config.gravity.cast<double>();
  const Eigen::Vector3d from = balance(flight.front(), Eigen::Vector3d::Zero(), gravity).center;
  const Balance start = balance(flight.front(), from, gravity), end = balance(flight.back(), from, gravity);
  return {{"momentum", relative((end.momentum - start.momentum).norm(), start.speed)},
          {"spin", relative((end.spin - start.spin).norm(), start.moment)}};
}

Json drift_row(const DriftScene& scene, const std::vector<int>& steps) {
  const double h = static_cast<double>(scene.body.spacing);
  const Eigen::Vector3d gravity = scene.config.gravity.cast<double>();
  const std::vector<Snapshot> single = fly(scene, steps), twice = fly_in_double(scene, steps),
                              other = fly_in_double(nudged(scene), steps);
  Json apart, own;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::string key = std::to_string(steps[k]);
    apart[key] = distance(single[k + 1], twice[k + 1]) / h;
    own[key] = distance(other[k + 1], twice[k + 1]) / h;
  }
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Balance a = balance(single.back(), origin, gravity), b = balance(twice.back(), origin, gravity);
  Json row{
      {"scene", scene.name},
      {"apart", apart},
      {"nudged_apart", own},
      {"center", (a.center - b.center).norm() / h},
      {"energy", relative(std::abs(a.energy - b.energy), balance(twice.front(), origin, gravity).energy)}};
  if (gravity.isZero()) {
    row["single"] = conserved(single, scene);
    row["double"] = conserved(twice, scene);
  }
  return row;
}

void run_drift(const DriftOptions& options) {
  Results results("drift", options.output, options.threads, {{"steps", options.steps}});
  const std::vector<int> steps = times(options.steps);
  for (const DriftScene& scene : drift_scenes()) {
    std::fprintf(stderr, "drift: %s\n", scene.name.c_str());
    results.add(drift_row(scene, steps));
    stop_if_interrupted(results);
  }
  results.close();

  std::vector<TableColumn> columns = {{"scene", "scene"}};
  for (const int at : steps)
    columns.push_back({"apart." + std::to_string(at), "apart at " + std::to_string(at) + " [h]", 7});
  const std::string last = std::to_string(steps.back());
  columns.insert(columns.end(), {{"nudged_apart." + last, "two of double [h]", 7},
                                 {"center", "centre [h]", 7},
                                 {"energy", "energy", 7},
                                 {"single.momentum", "momentum", 7},
                                 {"double.momentum", "of double", 7},
                                 {"single.spin", "spin", 7},
                                 {"double.spin", "of double", 7}});
  std::printf("%s", markdown_table(results.rows(), columns).c_str());
}

}  // namespace

void add_drift_command(CLI::App& app) {
  const auto options = std::make_shared<DriftOptions>();
  CLI::App* command = add_command(app, "drift", "Single precision against double over many steps", *options,
                                  [options] { run_drift(*options); });
  command->add_option("--steps", options->steps, "Steps of each motion")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
}

}  // namespace mallow::bench
