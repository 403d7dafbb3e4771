// The two sums over regions, beside what the machine can add at all.
#include <algorithm>
#include <memory>

#include "core/parallel.h"
#include "kernels/kernel_set.h"
#include "kernels/lattice.h"
#include "kernels/row_additions.h"
#include "shape_matching/shape_matching.h"

namespace mallow::bench {
namespace {

/// Rows that the first-level cache holds with room to spare: 16 KiB.
constexpr std::size_t k_cached_rows = 256;

/// A body that has bent since its reference shape, and what its shape matching holds then.
struct RegionScene {
  VectorColumn x;
  ShapeMatching shape;
  MatchedBodies matched;  ///< this one
  ShapeInput input;
  Column<float> sums;            ///< as the first sum leaves them
  Column<float> particle_table;  ///< of the rows of particles; that of the regions is where the shape has it

  RegionScene(const LatticeScene& scene, InstructionLevel level) : x(lattice_points(scene)) {
    RegionScratch scratch;
    shape.region_radius = scene.radius;
    shape.spacing = scene.spacing;
    update_reference(x, 0, x.size(), 1, scratch, shape);
    sort_reference({1, best_instruction_level()}, scratch.pillars, shape);
    x = reordered(x, scratch.pillars.order.span());
    build_regions({1, level}, scratch, shape);
    x = bent(x);
    matched.add(shape, 0);
    sum_regions(x, {1, level}, matched);
    sums.resize(shape.sums.size());
    std::copy(shape.sums.begin(), shape.sums.end(), sums.begin());
    particle_table.resize(shape.table.size());
    std::copy(shape.table.begin(), shape.table.end(), particle_table.begin());
    solve_rotations(k_enough_iterations, {1, level}, matched);
    compute_goals({1, level}, matched);
    input = shape_input(x, 0, shape);
  }
  const float* region_table() const {
    return shape.regions.lengths.count > 1 ? shape.table.data() : shape.sums.data();
  }
  std::size_t size() const { return x.size(); }
  double neighbors() const { return static_cast<double>(shape.regions.members); }
  Json about() const {
    return {{"particles", size()},
            {"average_neighbors", shape.average_neighbors},
            {"average_entries", static_cast<double>(shape.regions.total) / static_cast<double>(size())},
            {"table_levels", shape.regions.lengths.count}};
  }
};

/// A kernel of the table on the rows of a scene.
using OnRows = void (*)(const ShapeLanes&, RegionScene&, std::size_t begin, std::size_t end);

Timed on_rows(const LatticeScene& lattice, int threads, InstructionLevel level, bool per_neighbor,
              OnRows run) {
  const auto scene = std::make_shared<RegionScene>(lattice, level);
  const ShapeLanes& lanes = MALLOW_SELECT(level, shape_lanes);
  return {.run =
              [=, &lanes] {
                parallel_for(threads, scene->size(),
                             [&](std::size_t begin, std::size_t end) { run(lanes, *scene, begin, end); });
              },
          .items = per_neighbor ? scene->neighbors() : static_cast<double>(scene->size()),
          .about = scene->about()};
}

/// A phase of the step, whole.
template <class Phase>
Timed phase(const LatticeScene& lattice, InstructionLevel level, const Phase& run) {
  const auto scene = std::make_shared<RegionScene>(lattice, level);
  return {.run = [=] { run(*scene); }, .items = scene->neighbors(), .about = scene->about()};
}

/// As many rows as the regions of the scene have neighbours, from a table of `rows` rows, swept from its
/// first to its last again and again; threads share the sweeps.
Timed additions(const LatticeScene& lattice, std::size_t rows, int threads, InstructionLevel level) {
  const RegionScene scene(lattice, level);
  if (rows == 0) rows = scene.size();
  const auto sweeps = static_cast<std::size_t>(scene.neighbors()) / rows + 1;
  const auto table = std::make_shared<Column<float>>(rows * k_row);
  std::fill(table->begin(), table->end(), 1e-3f);
  const auto sums = std::make_shared<Column<float>>(sweeps * k_row);
  const RowAdditions& lanes = MALLOW_SELECT(level, row_additions);
  return {.run =
              [=, &lanes] {
                parallel_for(
                    threads, sweeps,
                    [&](std::size_t begin, std::size_t) {
                      lanes.add(table->data(), rows, sums->data() + begin * k_row);
                    },
                    1);
              },
          .items = static_cast<double>(rows * sweeps),
          .about = {{"rows", rows}, {"table_bytes", rows * k_row * sizeof(float)}}};
}

void add_level(const LatticeScene& scene, int threads, InstructionLevel level, KernelSet& set) {
  const auto about = [&](const char* kernel, const char* item) {
    return KernelCase{kernel, scene.name, threads, name(level), item};
  };
  const auto compared = [&](const char* kernel) {
    KernelCase result = about(kernel, "neighbor");
    result.compare_to = "row_additions";
    return result;
  };
  set.add(about("row_additions_in_cache", "row"),
          [=] { return additions(scene, k_cached_rows, threads, level); });
  set.add(about("row_additions", "row"), [=] { return additions(scene, 0, threads, level); });
  set.add(about("write_rows", "particle"), [=] {
    return on_rows(scene, threads, level, false,
                   [](const ShapeLanes& k, RegionScene& s, std::size_t begin, std::size_t end) {
                     k.write_rows(s.input, begin, end, s.sums.data() + begin * k_row);
                   });
  });
  set.add(compared("region_sums"), [=] {
    return on_rows(scene, threads, level, true,
                   [](const ShapeLanes& k, RegionScene& s, std::size_t begin, std::size_t end) {
                     k.sum_regions(s.input, begin, end, s.particle_table.data(), s.sums.data());
                   });
  });
  // With the rigid frame and the rows.
  set.add(compared("region_sums_phase"), [=] {
    return phase(scene, level, [=](RegionScene& of) { sum_regions(of.x, {threads, level}, of.matched); });
  });
  set.add(compared("goals"), [=] {
    return on_rows(scene, threads, level, true,
                   [](const ShapeLanes& k, RegionScene& s, std::size_t begin, std::size_t end) {
                     k.goals(s.input, begin, end, s.region_table(), raw(s.shape.pull));
                   });
  });
  set.add(compared("goals_phase"), [=] {
    return phase(scene, level, [=](RegionScene& of) { compute_goals({threads, level}, of.matched); });
  });
}

}  // namespace

void add_region_sums(const KernelVariants& variants, KernelSet& set) {
  for (const LatticeScene& scene : {k_cube_15, k_cube_22, k_bar})
    for (const int threads : variants.threads)
      for (const InstructionLevel level : variants.levels) add_level(scene, threads, level, set);
}

}  // namespace mallow::bench
