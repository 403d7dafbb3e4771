// Surfaces around particles: the whole, and its stages as far as they do not live in OpenVDB. What is left of
// the whole is the tree of the level set, the mesh and its normals.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>

#include "core/parallel.h"
#include "harness/command.h"
#include "kernels/kernel_set.h"
#include "kernels/lattice.h"
#include "level_set/arena.h"
#include "level_set/particle_cells.h"
#include "level_set/surface_kernel.h"
#include "mallow/level_set.h"
#include "mallow/scene.h"

namespace mallow::bench {
namespace {

/// Leaves that a thread takes at once.
constexpr std::size_t k_leaves_per_block = 8;

struct SurfaceScene {
  std::string name;
  std::vector<Vec3> positions;
  float spacing = 1;  ///< h [m]
  SurfaceConfig config;
};

SurfaceScene cube_scene(const LatticeScene& lattice) {
  return {lattice.name,
          sample(Lattice{.count = lattice.count, .spacing = lattice.spacing}).positions,
          lattice.spacing,
          {}};
}

SurfaceScene balls_scene() {
  const Scene scene = read_scene(data_file("scenes/table1/balls_8264.toml"));
  Simulation simulation = build(scene, 1);
  return {"balls_8264", simulation.positions_by_id(), simulation.info().groups.front().spacing,
          scene.surface};
}

/// What surface() makes of a scene before it fills leaves, with the default radii (level_set/surface.cpp).
struct Leaves {
  SurfaceScene scene;
  VoxelFrame frame;
  SurfaceShape shape;
  double cell_size = 1, kernel_radius = 1;  ///< [voxels]
  std::unique_ptr<ParticleCells> cells;
  std::vector<Eigen::Vector3i> corners;
  std::vector<Offsets> near;  ///< particles of each leaf

  explicit Leaves(SurfaceScene of) : scene(std::move(of)) {
    const double h = scene.spacing;
    choose_frame(scene.config.particle_radius * h);
    const double voxels_per_spacing = h / frame.voxel_size;
    kernel_radius = scene.config.kernel_radius * voxels_per_spacing;
    cell_size = std::max(voxels_per_spacing, 0.5 * k_leaf_side);
    const float per_radius = 1 / scene.config.kernel_radius;
    shape = {.voxel_size = static_cast<float>(1 / kernel_radius),
             .offset = scene.config.particle_radius * per_radius,
             .extra_offset = 0.017f,  // of radii 0.55 and 2
             .spread = 0.0375f,
             .extra_spread = 0.2625f,
             .full_weight =
                 static_cast<float>(64 * std::numbers::pi / 315 * std::pow(scene.config.kernel_radius, 3)),
             .background = 3,
             .probe = frame.voxel_size * (k_leaf_side / 2) <= 0.75 * h};
    build_cells();
    find_corners(0.69 * kernel_radius + 1);
    near.resize(corners.size());
    gather(1);
  }
  void build_cells() { cells = std::make_unique<ParticleCells>(scene.positions, frame, cell_size); }
  void gather(int threads) {
    parallel_for(
        threads, corners.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t l = begin; l < end; ++l)
            cells->gather(corners[l], k_leaf_side, kernel_radius, near[l]);
        },
        k_leaves_per_block);
  }
  void fill(int threads, InstructionLevel level, std::vector<LeafContent>& contents) const {
    const SurfaceKernels& kernels = select_surface_kernels(level);
    contents.resize(corners.size());
    parallel_for(
        threads, corners.size(),
        [&](std::size_t begin, std::size_t end) {
          thread_local std::vector<float> scratch;
          float distances[k_leaf_voxels];
          for (std::size_t l = begin; l < end; ++l) {
            scratch.resize(3 * near[l].x.size());
            contents[l] = kernels.fill_leaf(shape, near[l].x.data(), near[l].y.data(), near[l].z.data(),
                                            near[l].x.size(), scratch.data(), distances);
          }
        },
        k_leaves_per_block);
  }
  Json about() const {
    std::size_t particles = 0;
    for (const Offsets& offsets : near) particles += offsets.x.size();
    return {{"particles", scene.positions.size()},
            {"voxels", scene.config.voxels},
            {"leaves", corners.size()},
            {"particles_per_leaf", static_cast<double>(particles) / static_cast<double>(corners.size())}};
  }

 private:
  void choose_frame(double margin) {
    Eigen::Vector3d low = scene.positions.front().cast<double>(), high = low;
    for (const Vec3& x : scene.positions) {
      low = low.cwiseMin(x.cast<double>());
      high = high.cwiseMax(x.cast<double>());
    }
    frame.voxel_size = ((high - low).maxCoeff() + 2 * margin) / scene.config.voxels;
    frame.origin = (low / frame.voxel_size).array().floor() * frame.voxel_size;
  }
  /// Leaves with a voxel within `reach` voxels of a particle, but for some at the edges of that ball.
  void find_corners(double reach) {
    std::set<std::array<int, 3>> found;
    for (const Eigen::Vector3d& x : cells->positions()) {
      const Eigen::Array3i low = ((x.array() - reach) / k_leaf_side).floor().cast<int>();
      const Eigen::Array3i high = ((x.array() + reach) / k_leaf_side).floor().cast<int>();
      for (int i = low.x(); i <= high.x(); ++i)
        for (int j = low.y(); j <= high.y(); ++j)
          for (int k = low.z(); k <= high.z(); ++k) {
            const Eigen::Vector3d corner = k_leaf_side * Eigen::Vector3d(i, j, k);
            const Eigen::Vector3d nearest =
                x.cwiseMax(corner).cwiseMin((corner.array() + (k_leaf_side - 1)).matrix());
            if ((x - nearest).squaredNorm() <= reach * reach) found.insert({i, j, k});
          }
    }
    for (const auto& [i, j, k] : found) corners.push_back(k_leaf_side * Eigen::Vector3i(i, j, k));
  }
};

using MakeScene = std::function<SurfaceScene()>;

Timed whole(const MakeScene& make, int threads) {
  const auto scene = std::make_shared<SurfaceScene>(make());
  const auto draw = [=] { return surface(scene->positions, scene->spacing, scene->config, threads); };
  return {.run = [=] { draw(); },
          .items = static_cast<double>(scene->positions.size()),
          .about = {{"particles", scene->positions.size()},
                    {"voxels", scene->config.voxels},
                    {"triangles", draw().triangles.size()}}};
}

Timed fill(const MakeScene& make, int threads, InstructionLevel level) {
  const auto leaves = std::make_shared<Leaves>(make());
  const auto contents = std::make_shared<std::vector<LeafContent>>();
  leaves->fill(threads, level, *contents);
  Json about = leaves->about();
  about["filled_share"] =
      static_cast<double>(std::count(contents->begin(), contents->end(), LeafContent::surface)) /
      static_cast<double>(contents->size());
  return {.run = [=] { leaves->fill(threads, level, *contents); },
          .items = static_cast<double>(leaves->corners.size()),
          .about = std::move(about)};
}

void add_scene(const std::string& scene, const MakeScene& make, const KernelVariants& variants, int threads,
               KernelSet& set) {
  set.add({"surface", scene, threads, "", "particle"}, [=] { return whole(make, threads); });
  set.add({"surface_cells", scene, threads, "", "particle"}, [=] {
    const auto leaves = std::make_shared<Leaves>(make());
    return Timed{.run = [=] { run_with_threads(threads, [&] { leaves->build_cells(); }); },
                 .items = static_cast<double>(leaves->scene.positions.size()),
                 .about = leaves->about()};
  });
  set.add({"surface_gather", scene, threads, "", "leaf"}, [=] {
    const auto leaves = std::make_shared<Leaves>(make());
    return Timed{.run = [=] { leaves->gather(threads); },
                 .items = static_cast<double>(leaves->corners.size()),
                 .about = leaves->about()};
  });
  for (const InstructionLevel level : variants.levels)
    set.add({"surface_fill", scene, threads, name(level), "leaf"},
            [=] { return fill(make, threads, level); });
}

}  // namespace

void add_surface(const KernelVariants& variants, KernelSet& set) {
  for (const int threads : variants.threads) {
    for (const LatticeScene& lattice : {k_cube_15, k_cube_22})
      add_scene(
          lattice.name, [=] { return cube_scene(lattice); }, variants, threads, set);
    add_scene("balls_8264", balls_scene, variants, threads, set);
  }
}

}  // namespace mallow::bench
