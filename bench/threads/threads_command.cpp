#include "threads/threads_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <memory>

#include "harness/command.h"
#include "harness/statistics.h"
#include "mallow/level_set.h"
#include "mallow/surface.h"
#include "program/failure.h"
#include "render/renderer.h"
#include "scaling/cube.h"
#include "threads/busy_loops.h"

namespace mallow::bench {
namespace {

/// A time in which the system shares processors out several times.
constexpr double k_burst_ms = 15;

struct ThreadsOptions : CommonOptions {
  std::vector<std::size_t> particles = {500, 2000, 8000, 30000, 100000};
  std::vector<int> busy = {0, 1, 2, 4};
  std::vector<std::string> work;
  double seconds = 4;
};

const std::vector<std::string> k_work = {"step", "surface", "picture", "mesh"};

/// One way to do a piece of work.
struct Variant {
  std::string executor;
  std::function<void()> once;
  std::function<std::uint64_t()> hash = {};  ///< of what came of it
  std::vector<double> ms = {};               ///< of one piece of work, a value a burst
};

std::vector<std::pair<std::string, std::shared_ptr<Executor>>> executors() {
  return {{"team", team_executor()}, {"openmp", openmp_executor()}};
}

std::vector<Variant> steps(std::size_t particles, int threads) {
  const Cube cube = make_cube("paste", particles);
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, int count, const std::shared_ptr<Executor>& executor) {
    const auto simulation = std::make_shared<Simulation>(build(cube, count, executor));
    variants.push_back(
        {name, [simulation] { simulation->step(); }, [simulation] { return simulation->state_hash(); }});
  };
  add("one thread", 1, nullptr);
  for (const auto& [name, executor] : executors()) add(name, threads, executor);
  return variants;
}

std::vector<Variant> surfaces(const SurfaceParticles& particles, int threads) {
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, int count, const std::shared_ptr<Executor>& executor) {
    const auto surfacer = std::make_shared<Surfacer>(SurfaceConfig{.voxels = 96}, count, executor);
    variants.push_back({name, [surfacer, particles] { surfacer->draw(particles); }});
  };
  add("one thread", 1, nullptr);
  for (const auto& [name, executor] : executors()) add(name, threads, executor);
  return variants;
}

std::vector<Variant> pictures(const std::shared_ptr<const Mesh>& mesh, int threads) {
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, int count) {
    const auto renderer =
        std::make_shared<render::Renderer>(RenderConfig{.width = 320, .height = 180, .samples = 8}, count);
    variants.push_back(
        {name, [renderer, mesh] {
           const Appearance look;
           renderer->render(*mesh, {&look, 1}, {}, {.eye = {60, -60, 40}, .target = {8, 8, 8}});
         }});
  };
  add("one thread", 1);
  add("team", threads);
  return variants;
}

std::vector<Variant> meshes(const std::shared_ptr<const Mesh>& mesh, int threads) {
  return {{"one thread", [mesh] { mesh_shape(*mesh, 64, 1); }},
          {"tbb", [mesh, threads] { mesh_shape(*mesh, 64, threads); }}};
}

/// Bursts of all variants in turn, so that what disturbs the machine disturbs all of them.
void measure(double seconds, std::vector<Variant>& variants) {
  for (Variant& v : variants) v.once();
  const double once_ms = milliseconds(variants.front().once);
  for (std::size_t k = 1; k < variants.size(); ++k) variants[k].once();
  const int repeats = std::max(1, static_cast<int>(k_burst_ms / once_ms));
  double left = 1000 * seconds;
  for (int round = 0; round < 3 || left > 0; ++round)
    for (Variant& v : variants) {
      const double ms = milliseconds([&] {
        for (int k = 0; k < repeats; ++k) v.once();
      });
      v.ms.push_back(ms / repeats);
      left -= ms;
    }
  for (const Variant& v : variants)
    if (v.hash && v.hash() != variants.front().hash())
      throw program::RunFailure("threads: " + v.executor + " ends in another state than one thread");
}

Json row(const std::string& work, std::size_t particles, int busy, int threads, const Variant& variant,
         const Variant& single) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < variant.ms.size(); ++k) ratios.push_back(variant.ms[k] / single.ms[k]);
  return {{"work", work},
          {"particles", particles},
          {"busy_loops", busy},
          {"executor", variant.executor},
          {"threads", threads},
          {"one_thread_ms", median(single.ms)},
          {"ms", median(variant.ms)},
          {"ratio", median(ratios)},
          {"ratio_of_means", mean(variant.ms) / mean(single.ms)},
          {"worst_ms", *std::max_element(variant.ms.begin(), variant.ms.end())},
          {"one_thread_worst_ms", *std::max_element(single.ms.begin(), single.ms.end())},
          {"bursts", variant.ms.size()}};
}

void run_threads(const ThreadsOptions& options) {
  const std::vector<std::string> work = chosen("--work", options.work, k_work);
  Results results(
      "threads", options.output, options.threads,
      {{"particles", options.particles}, {"busy_loops", options.busy}, {"seconds", options.seconds}});
  const auto add = [&](const std::string& name, std::size_t particles, std::vector<Variant> variants) {
    for (const int busy : options.busy) {
      for (Variant& v : variants) v.ms.clear();
      {
        const BusyLoops loops(busy);
        measure(options.seconds, variants);
      }
      for (std::size_t k = 1; k < variants.size(); ++k)
        results.add(row(name, particles, busy, options.threads, variants[k], variants.front()));
      stop_if_interrupted(results);
    }
  };
  const auto asked = [&](const char* name) {
    return std::find(work.begin(), work.end(), name) != work.end();
  };
  for (const std::size_t particles : options.particles) {
    std::fprintf(stderr, "threads: %zu particles\n", particles);
    if (asked("step")) add("step", particles, steps(particles, options.threads));
  }
  const Body body = sample(Lattice{.count = {16, 16, 16}, .jitter = 0.1f});
  const SurfaceParticles particles{.positions = body.positions, .bodies = {{.spacing = body.spacing}}};
  if (asked("surface")) add("surface", body.positions.size(), surfaces(particles, options.threads));
  const auto mesh = std::make_shared<const Mesh>(surface(body.positions, body.spacing, {.voxels = 64}));
  if (asked("picture")) add("picture", body.positions.size(), pictures(mesh, options.threads));
  if (asked("mesh")) add("mesh", body.positions.size(), meshes(mesh, options.threads));
  results.close();
  std::printf("%s", markdown_table(results.rows(), {{"work", "work"},
                                                    {"particles", "particles"},
                                                    {"busy_loops", "busy loops"},
                                                    {"executor", "executor"},
                                                    {"one_thread_ms", "one thread ms", 3},
                                                    {"ms", "ms", 3},
                                                    {"ratio", "ratio", 2},
                                                    {"ratio_of_means", "of means", 2},
                                                    {"worst_ms", "worst ms", 2},
                                                    {"one_thread_worst_ms", "one thread's worst ms", 2}})
                        .c_str());
}

}  // namespace

void add_threads_command(CLI::App& app) {
  const auto options = std::make_shared<ThreadsOptions>();
  CLI::App* command =
      add_command(app, "threads", "Several threads against one beside busy loops, with every executor",
                  *options, [options] { run_threads(*options); });
  command->add_option("--particles", options->particles, "Particles of the steps")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--busy", options->busy, "Busy loops beside them")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--work", options->work, "step, surface, picture, mesh; left out: all")->delimiter(',');
  command->add_option("--seconds", options->seconds, "Time for each row of measurements")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
}

}  // namespace mallow::bench
