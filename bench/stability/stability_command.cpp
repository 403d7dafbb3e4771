#include "stability/stability_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <numeric>
#include <sstream>

#include "core/parallel.h"
#include "harness/command.h"
#include "program/failure.h"
#include "stability/extremes.h"
#include "stability/grid.h"
#include "stability/hypercube.h"
#include "stability/panels.h"
#include "stability/stability_map.h"

namespace mallow::bench {
namespace {

struct StabilityOptions : CommonOptions {
  int steps = 300;
  int long_steps = 1'000'000;
  bool thin = false;
  bool panels = false;
  std::size_t hypercube = 0;  ///< mixtures of it; alone if there are any
  std::string extremes;       ///< a part of the names of those to run, without the grid; empty: all
};

/// Trials that run before the command looks whether it was asked to stop.
constexpr std::size_t k_at_once = 64;
constexpr std::uint32_t k_seed = 1;

/// Trials side by side, each on one thread, in the order of their numbers.
template <class TrialOf>
std::vector<Outcome> run_all(const char* what, std::size_t count, int threads, const Results& results,
                             const TrialOf& trial) {
  std::vector<Outcome> outcomes(count);
  for (std::size_t begin = 0; begin < count; begin += k_at_once) {
    const std::size_t n = std::min(k_at_once, count - begin);
    parallel_for(
        threads, n,
        [&](std::size_t first, std::size_t last) {
          for (std::size_t i = first; i < last; ++i) outcomes[begin + i] = run(trial(begin + i));
        },
        1);
    std::fprintf(stderr, "\rstability: %s %zu of %zu", what, begin + n, count);
    stop_if_interrupted(results);
  }
  std::fputc('\n', stderr);
  return outcomes;
}

Json to_json(const Outcome& outcome) {
  return {{"verdict", name(outcome.verdict)},
          {"steps", outcome.steps},
          {"limited_share", outcome.limited_share},
          {"energy", outcome.energy},
          {"end_energy", outcome.end_energy},
          {"end_speed", outcome.end_speed},
          {"momentum_drift", outcome.momentum_drift},
          {"angular_drift", outcome.angular_drift},
          {"message", outcome.message}};
}

/// Runs them and adds a row for each.
std::vector<Outcome> run_extremes(const char* what, const std::vector<Extreme>& list, int threads,
                                  Results& results) {
  std::vector<Outcome> ends =
      run_all(what, list.size(), threads, results, [&](std::size_t i) { return list[i].trial; });
  for (std::size_t i = 0; i < list.size(); ++i) {
    Json row{{"kind", "extreme"}, {"name", list[i].name}, {"alpha", list[i].alpha}};
    row.update(to_json(ends[i]));
    results.add(row);
  }
  return ends;
}

/// How often each verdict was given, over one value of an axis.
struct Counts {
  std::array<int, 4> of{};
  void add(const Outcome& outcome) { ++of[static_cast<std::size_t>(outcome.verdict)]; }
};
Json count_row(const std::string& axis, float value, const Counts& counts) {
  Json row{{"kind", "grid"}, {"axis", axis}, {"value", value}};
  for (std::size_t v = 0; v < counts.of.size(); ++v) row[name(static_cast<Verdict>(v))] = counts.of[v];
  return row;
}

void add_grid(const StabilityGrid& grid, const std::vector<Outcome>& outcomes, Results& results) {
  const auto add_axis = [&](const std::string& axis, const std::vector<float>& values,
                            float GridPoint::*member) {
    for (const float value : values) {
      Counts counts;
      for (std::size_t i = 0; i < outcomes.size(); ++i)
        if (grid_point(grid, i).*member == value) counts.add(outcomes[i]);
      results.add(count_row(axis, value, counts));
    }
  };
  add_axis("alpha", grid.alphas, &GridPoint::alpha);
  add_axis("time_step", grid.time_steps, &GridPoint::time_step);
  add_axis("pressure_coefficient", grid.pressures, &GridPoint::pressure);
  add_axis("viscosity", grid.viscosities, &GridPoint::viscosity);
  add_axis("restitution", grid.restitutions, &GridPoint::restitution);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i].verdict != Verdict::unstable) continue;
    const GridPoint point = grid_point(grid, i);
    Json row{{"kind", "unstable"},           {"alpha", point.alpha},
             {"time_step", point.time_step}, {"pressure", point.pressure},
             {"viscosity", point.viscosity}, {"restitution", point.restitution}};
    row.update(to_json(outcomes[i]));
    results.add(row);
  }
}

Json rows_of(const Results& results, const std::string& kind) {
  Json rows = Json::array();
  for (const Json& row : results.rows())
    if (row["kind"] == kind) rows.push_back(row);
  return rows;
}

/// Runs the panels of bodies, draws their map and adds a row for each trial.
void run_panels(const StabilityOptions& options, Results& results) {
  std::vector<Panel> list = panels();
  if (options.thin)
    for (Panel& panel : list) panel.values = {panel.values.front(), panel.values[3], panel.values.back()};
  const std::vector<float> alphas = panel_alphas(options.thin);
  std::vector<Extreme> trials;
  for (const Panel& panel : list)
    for (const float value : panel.values) {
      std::ostringstream name;
      name << panel.name << ": " << value;
      for (const float alpha : alphas) trials.push_back({name.str(), alpha, panel.trial(alpha, value)});
    }
  write_panels(results.file("_bodies.svg"), list, alphas,
               run_extremes("panel", trials, options.threads, results));
}

/// Runs the mixtures, draws their map and adds a row for each.
void run_hypercube(const StabilityOptions& options, Results& results) {
  const std::vector<Mixture> mixtures = hypercube(options.hypercube, k_seed);
  const std::vector<Outcome> ends = run_all("hypercube", mixtures.size(), options.threads, results,
                                            [&](std::size_t i) { return mixtures[i].trial; });
  for (std::size_t i = 0; i < mixtures.size(); ++i) {
    Json row{{"kind", "hypercube"}, {"number", i}};
    row.update(to_json(ends[i]));
    for (const TurnedKnob& knob : mixtures[i].knobs)
      row["knobs"][knob.name.substr(0, knob.name.find(':'))] = knob.value;
    results.add(row);
  }
  write_hypercube(results.file("_hypercube.svg"), mixtures, ends);
}

void run_stability(const StabilityOptions& options) {
  StabilityGrid grid = options.thin ? thin_grid() : full_grid();
  if (!options.extremes.empty() || options.panels || options.hypercube > 0) grid.alphas.clear();
  Results results("stability", options.output, options.threads,
                  {{"steps", options.steps},
                   {"long_steps", options.long_steps},
                   {"trials", options.hypercube > 0 ? options.hypercube : grid.size()}});
  std::vector<Extreme> list = extremes(options.long_steps);
  std::erase_if(list,
                [&](const Extreme& one) { return one.name.find(options.extremes) == std::string::npos; });
  if (options.panels || options.hypercube > 0) list.clear();
  run_extremes("extreme", list, options.threads, results);
  if (options.extremes.empty() && options.hypercube == 0) run_panels(options, results);
  if (options.hypercube > 0) run_hypercube(options, results);
  const std::vector<Outcome> outcomes =
      run_all("grid", grid.size(), options.threads, results,
              [&](std::size_t i) { return falling_cube(grid_point(grid, i), options.steps); });
  if (grid.size() > 0) add_grid(grid, outcomes, results);
  results.close();
  if (grid.size() > 0) write_map(results.file(".svg"), grid, outcomes);

  const std::vector<TableColumn> verdicts = {
      {"stable", "stable"}, {"limited", "limited"}, {"refused", "refused"}, {"unstable", "unstable"}};
  std::vector<TableColumn> counts = {{"axis", "axis"}, {"value", "value", 4}};
  counts.insert(counts.end(), verdicts.begin(), verdicts.end());
  std::printf("%s\n%s", markdown_table(rows_of(results, "grid"), counts).c_str(),
              markdown_table(rows_of(results, "extreme"), {{"name", "extreme"},
                                                           {"alpha", "alpha", 1},
                                                           {"verdict", "verdict"},
                                                           {"steps", "steps"},
                                                           {"limited_share", "limited"},
                                                           {"energy", "energy", 3},
                                                           {"end_speed", "h a step at the end", 5},
                                                           {"momentum_drift", "momentum", 7},
                                                           {"angular_drift", "spin", 7}})
                  .c_str());
  const auto broken = std::count_if(results.rows().begin(), results.rows().end(), [](const Json& row) {
    return row["kind"] != "grid" && row["verdict"] == "unstable";
  });
  if (broken > 0) throw program::RunFailure(std::to_string(broken) + " trials are unstable");
}

}  // namespace

void add_stability_command(CLI::App& app) {
  const auto options = std::make_shared<StabilityOptions>();
  CLI::App* command =
      add_command(app, "stability", "Settings turned to the stop: what stays bounded, and what is refused",
                  *options, [options] { run_stability(*options); });
  command->add_option("--steps", options->steps, "Steps of each trial of the grid")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--long-steps", options->long_steps, "Steps of the cube that rests")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  command->add_option("--extremes", options->extremes,
                      "Only extremes whose names have this in them, and no grid");
  command->add_flag("--panels", options->panels,
                    "Only the panels of bodies that touch, rest, come and are pushed");
  command->add_option("--hypercube", options->hypercube,
                      "Only so many bodies whose knobs are all turned together, at random");
  command->add_flag("--thin", options->thin, "A grid of few values, for a look");
}

}  // namespace mallow::bench
