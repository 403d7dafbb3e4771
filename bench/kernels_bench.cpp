// The phases of a step by themselves, on the cubes of Table 1. Arguments: particles along a side, threads.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>

#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"
#include "shape_matching/shape_matching.h"
#include "sph/sph.h"

namespace {

using namespace mallow;

constexpr float k_side = 22.0f;   // of the cube [m]
constexpr float k_radius = 2.9f;  // σ [m]

/// The lattice cube, bent a little so that no phase meets the trivial case.
VectorColumn cube(std::size_t side) {
  const float h = k_side / static_cast<float>(side);
  VectorColumn x(side * side * side);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 p = h * Vec3(static_cast<float>(i % side), static_cast<float>(i / side % side),
                            static_cast<float>(i / side / side));
    x.set(i, Eigen::AngleAxisf(0.02f * p.z(), Vec3::UnitZ()) * p);
  }
  return x;
}

struct Settings {
  std::size_t side;
  int threads;
  InstructionLevel level = best_instruction_level();
  explicit Settings(const benchmark::State& state)
      : side(static_cast<std::size_t>(state.range(0))), threads(static_cast<int>(state.range(1))) {}
};

/// Time per `items` of all threads together.
void per_item(benchmark::State& state, const char* name, double items) {
  state.counters[name] = benchmark::Counter(items * static_cast<double>(state.iterations()),
                                            benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void neighbors(benchmark::State& state) {
  const Settings s(state);
  const VectorColumn x = cube(s.side);
  CellGrid grid;
  NeighborLists lists;
  for (auto _ : state) {
    build_cell_grid(x, 0, x.size(), k_radius, s.threads, grid);
    build_neighbor_lists(grid, k_radius, s.threads, s.level, lists);
  }
  per_item(state, "per_pair", static_cast<double>(lists.total));
}

Sph prepared_sph(const Settings& s, const VectorColumn& x) {
  Sph sph;
  sph.support_radius = k_radius;
  sph.factors = kernel_factors(static_cast<double>(k_radius));
  sph.viscous = true;
  const double rho0 = lattice_density(static_cast<double>(k_radius),
                                      static_cast<double>(k_side) / static_cast<double>(s.side));
  sph.groups = {{1, static_cast<float>(rho0), static_cast<float>(1 / rho0), 16, 0.5f, 0}};
  sph.group_end = {x.size()};
  find_neighbors(x, s.threads, s.level, sph);
  return sph;
}

void density(benchmark::State& state) {
  const Settings s(state);
  Sph sph = prepared_sph(s, cube(s.side));
  for (auto _ : state) compute_density(s.threads, s.level, sph);
  per_item(state, "per_pair", static_cast<double>(sph.lists.total));
}

void accelerations(benchmark::State& state) {
  const Settings s(state);
  const VectorColumn x = cube(s.side);
  Sph sph = prepared_sph(s, x);
  compute_density(s.threads, s.level, sph);
  for (auto _ : state) compute_accelerations(x, s.threads, s.level, sph);
  per_item(state, "per_pair", static_cast<double>(sph.lists.total));
}

struct PreparedShape {
  VectorColumn x;
  ShapeMatching shape;
  explicit PreparedShape(const Settings& s) : x(cube(s.side)) {
    CellGrid grid;
    shape.region_radius = k_radius;
    update_reference(x, 0, x.size(), shape);
    build_regions(s.threads, s.level, grid, shape);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = x.get(i);
      x.set(i, Eigen::AngleAxisf(0.01f * p.x(), Vec3::UnitX()) * p);
    }
  }
};

void region_sums(benchmark::State& state) {
  const Settings s(state);
  PreparedShape p(s);
  for (auto _ : state) sum_regions(p.x, 0, s.threads, s.level, p.shape);
  per_item(state, "per_neighbor", static_cast<double>(p.shape.regions.total));
}

void rotations(benchmark::State& state) {
  const Settings s(state);
  PreparedShape p(s);
  sum_regions(p.x, 0, s.threads, s.level, p.shape);
  const std::vector<float> sums(p.shape.sums.begin(), p.shape.sums.end());
  for (auto _ : state) {
    state.PauseTiming();
    std::copy(sums.begin(), sums.end(), p.shape.sums.data());
    state.ResumeTiming();
    solve_rotations(p.x, 0, s.threads, s.level, p.shape);
  }
  per_item(state, "per_matrix", static_cast<double>(p.x.size()));
}

void goals(benchmark::State& state) {
  const Settings s(state);
  PreparedShape p(s);
  sum_regions(p.x, 0, s.threads, s.level, p.shape);
  solve_rotations(p.x, 0, s.threads, s.level, p.shape);
  for (auto _ : state) compute_goals(p.x, 0, s.threads, s.level, p.shape);
  per_item(state, "per_neighbor", static_cast<double>(p.shape.regions.total));
}

void cubes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"side", "threads"})
      ->ArgsProduct({{15, 22}, {1, 2}})
      ->UseRealTime()
      ->Unit(benchmark::kMicrosecond);
}
BENCHMARK(neighbors)->Apply(cubes);
BENCHMARK(density)->Apply(cubes);
BENCHMARK(accelerations)->Apply(cubes);
BENCHMARK(region_sums)->Apply(cubes);
BENCHMARK(rotations)->Apply(cubes);
BENCHMARK(goals)->Apply(cubes);

}  // namespace
