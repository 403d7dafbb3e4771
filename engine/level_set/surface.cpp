#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <Eigen/Geometry>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>

#include "core/checks.h"
#include "level_set/arena.h"
#include "level_set/particle_cells.h"
#include "level_set/surface_kernel.h"
#include "mallow/level_set.h"

namespace mallow {
namespace {

using openvdb::Coord;
using openvdb::FloatTree;
using Leaf = FloatTree::LeafNodeType;
static_assert(Leaf::DIM == k_leaf_side);

/// Voxels on each side of the surface that hold a distance.
constexpr float k_half_band = 3.0f;
constexpr std::size_t k_max_leaves = (std::size_t{1} << 31) / k_leaf_voxels;
/// Voxels along an axis: keeps cell keys within 64 bits and offsets within a leaf exact.
constexpr int k_max_side = 1 << 22;

// Variance of particles about their mean that is taken for one part of a body, in squared kernel radii. A
// face of a full body has 0.19 at a fullness of 0.46, its inside 0.27; a cubic lattice of 1.3 spacings 0.32
// at 0.5. The middle of a gap of 2.2 spacings has 0.44 at 0.29, that of a pair 2.2 apart 0.30 at 0.13. With
// the default radius two faces, and a pair, part at a distance of about two spacings.
constexpr float k_spread = 0.0375f, k_extra_spread = 0.2625f;
/// The least of it, in squared spacings: a small kernel sees but few particles of a full body.
constexpr float k_least_spread = 0.15f;

/// Rows that are probed in a leaf are at most this far apart, in spacings: less than a sphere is wide at the
/// default particle radius and at most what three voxels of background bridge.
constexpr double k_probe_distance = 0.75;

void check(std::span<const Vec3> positions, float spacing, const SurfaceConfig& config, int threads) {
  Checks checks;
  checks.number("spacing", spacing, spacing > 0, "a number above 0");
  if (config.voxel_size)
    checks.number("surface.voxel_size", *config.voxel_size, *config.voxel_size > 0, "a number above 0");
  else
    checks.number("surface.voxels", config.voxels, config.voxels >= 8 && config.voxels <= 1024, "8 to 1024");
  checks.number("surface.kernel_radius", config.kernel_radius,
                config.kernel_radius >= 1 && config.kernel_radius <= 4, "1 to 4 spacings");
  checks.number("surface.particle_radius", config.particle_radius,
                config.particle_radius >= 0.1f && config.particle_radius <= 1, "0.1 to 1 spacings");
  checks.number("threads", threads, threads >= 0, "0 (all there are) or more");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].allFinite()) continue;
    checks.vector("positions[" + std::to_string(i) + "]", positions[i]);
    break;
  }
  checks.finish();
}

[[noreturn]] void refuse_size(const std::string& what, const VoxelFrame& frame) {
  std::ostringstream text;
  text << "voxels of " << frame.voxel_size << " are too small for these particles: the grid would be "
       << what;
  throw ConfigError("surface.voxel_size", text.str());
}

VoxelFrame make_frame(std::span<const Vec3> positions, double margin, const SurfaceConfig& config) {
  Eigen::Vector3d low = positions[0].cast<double>(), high = low;
  for (const Vec3& x : positions) {
    low = low.cwiseMin(x.cast<double>());
    high = high.cwiseMax(x.cast<double>());
  }
  const double longest_side = (high - low).maxCoeff() + 2 * margin;
  VoxelFrame frame;
  frame.voxel_size =
      config.voxel_size ? static_cast<double>(*config.voxel_size) : longest_side / config.voxels;
  frame.origin = (low / frame.voxel_size).array().floor() * frame.voxel_size;
  if (longest_side / frame.voxel_size > k_max_side) {
    std::ostringstream text;
    text << longest_side / frame.voxel_size << " voxels long, and " << k_max_side << " are allowed";
    refuse_size(text.str(), frame);
  }
  return frame;
}

/// How much deeper than `z` spacings x̄ lies under a flat face, `z` above the outermost layer of a full
/// lattice with a kernel of `radius` spacings. Layers are taken as sheets: (1 − d²/R²)⁴ is the kernel's
/// integral over a sheet.
double depth_of_mean(double z, double radius) {
  double weight = 0, moment = 0;
  for (int layer = 0; z + layer < radius; ++layer) {
    const double w = std::pow(1 - (z + layer) * (z + layer) / (radius * radius), 4);
    weight += w;
    moment += w * layer;
  }
  return weight > 0 ? moment / weight : 0;
}

SurfaceShape make_shape(const SurfaceConfig& config, double spacing, double voxel_size) {
  const double radius = config.kernel_radius;
  const float per_radius = 1 / config.kernel_radius;
  return {.voxel_size = static_cast<float>(voxel_size / (radius * spacing)),
          .offset = config.particle_radius * per_radius,
          .extra_offset = static_cast<float>(depth_of_mean(config.particle_radius, radius) / radius),
          .spread = std::max(k_spread, k_least_spread * per_radius * per_radius),
          .extra_spread = k_extra_spread,
          // ∫ (1 − r²)³ dV = 64π/315 for one particle per cubic spacing.
          .full_weight = static_cast<float>(64 * std::numbers::pi / 315 * radius * radius * radius),
          .background = k_half_band,
          .probe = voxel_size * (k_leaf_side / 2) <= k_probe_distance * spacing};
}

/// The farthest from all particles that a point inside can be, in kernel radii: their mean square distance,
/// which is |x − x̄|² and the variance, is what bounds it.
double farthest_inside(const SurfaceShape& shape) {
  const float r = shape.offset + shape.extra_offset;
  return std::sqrt(r * r / k_excess_share + shape.spread + shape.extra_spread);
}

/// Every leaf with a voxel within `reach` voxels of a particle, in tree order; all else is outside.
std::vector<Coord> touched_leaves(std::span<const Eigen::Vector3d> positions, double reach,
                                  const VoxelFrame& frame) {
  // A bit per leaf: the active voxels of a mask whose voxels are leaves.
  openvdb::MaskTree mask;
  openvdb::tree::ValueAccessor<openvdb::MaskTree> leaves(mask);
  std::size_t count = 0;
  const auto refuse = [&] { refuse_size("more than 2^31 voxels around the surface", frame); };
  for (const Eigen::Vector3d& x : positions) {
    const Eigen::Array3d low = ((x.array() - reach - (k_leaf_side - 1)) / k_leaf_side).ceil();
    const Eigen::Array3d high = ((x.array() + reach) / k_leaf_side).floor();
    // A ball fills more than half of its box.
    if ((high - low + 1).prod() > 2.0 * k_max_leaves) refuse();
    const Eigen::Array3i first = low.cast<int>(), last = high.cast<int>();
    for (int i = first.x(); i <= last.x(); ++i) {
      for (int j = first.y(); j <= last.y(); ++j) {
        for (int k = first.z(); k <= last.z(); ++k) {
          const Eigen::Vector3d corner = Eigen::Vector3d(i, j, k) * k_leaf_side;
          const Eigen::Vector3d nearest =
              x.cwiseMax(corner).cwiseMin((corner.array() + (k_leaf_side - 1)).matrix());
          if ((x - nearest).squaredNorm() > reach * reach || leaves.isValueOn({i, j, k})) continue;
          leaves.setValueOn({i, j, k});
          if (++count > k_max_leaves) refuse();
        }
      }
    }
  }
  std::vector<Coord> coords;
  coords.reserve(count);
  for (auto leaf = mask.cbeginValueOn(); leaf; ++leaf) coords.push_back(leaf.getCoord() << 3);
  return coords;
}

openvdb::FloatGrid::Ptr fill_level_set(const ParticleCells& cells, const std::vector<Coord>& coords,
                                       double kernel_radius, const SurfaceShape& shape) {
  const SurfaceKernels& kernels = select_surface_kernels(best_instruction_level());
  std::vector<LeafContent> contents(coords.size());
  std::vector<std::unique_ptr<Leaf>> leaves(coords.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, coords.size(), 8), [&](const auto& range) {
    Offsets near;
    std::vector<float> scratch;
    float distances[k_leaf_voxels];
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      cells.gather({coords[l].x(), coords[l].y(), coords[l].z()}, k_leaf_side, kernel_radius, near);
      scratch.resize(3 * near.x.size());
      contents[l] = kernels.fill_leaf(shape, near.x.data(), near.y.data(), near.z.data(), near.x.size(),
                                      scratch.data(), distances);
      if (contents[l] != LeafContent::surface) continue;
      leaves[l] = std::make_unique<Leaf>(coords[l], shape.background);
      std::copy_n(distances, k_leaf_voxels, leaves[l]->buffer().data());
      for (openvdb::Index v = 0; v < k_leaf_voxels; ++v)
        if (std::abs(distances[v]) < shape.background) leaves[l]->setValueOn(v);
    }
  });
  auto grid = openvdb::FloatGrid::create(shape.background);
  for (std::size_t l = 0; l < coords.size(); ++l) {
    if (contents[l] == LeafContent::surface) grid->tree().addLeaf(leaves[l].release());
    if (contents[l] == LeafContent::inside) grid->tree().addTile(1, coords[l], -shape.background, false);
  }
  return grid;
}

/// Normals of vertices: the mean of the triangles around, by area.
std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 twice_area = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    for (const std::uint32_t v : t) normals[v] += twice_area;
  }
  for (Vec3& normal : normals) normal = normal.squaredNorm() > 0 ? normal.normalized() : Vec3::UnitZ();
  return normals;
}

Mesh extract_mesh(const openvdb::FloatGrid& grid, const VoxelFrame& frame) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, 0.0, 0.0, false);
  // Normals come from voxel units, where positions are precise wherever the world's origin is.
  Mesh mesh;
  mesh.vertices.reserve(points.size());
  for (const openvdb::Vec3s& p : points) mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  mesh.triangles.reserve(triangles.size() + 2 * quads.size());
  for (const openvdb::Vec3I& t : triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
  for (const openvdb::Vec4I& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  mesh.normals = vertex_normals(mesh);
  for (Vec3& x : mesh.vertices) x = (frame.origin + frame.voxel_size * x.cast<double>()).cast<float>();
  return mesh;
}

}  // namespace

const SurfaceKernels& select_surface_kernels(InstructionLevel level) {
  return MALLOW_SELECT(level, surface_kernels);
}

Mesh surface(std::span<const Vec3> positions, float spacing, const SurfaceConfig& config, int threads) {
  check(positions, spacing, config, threads);
  if (positions.empty()) return {};
  const double h = spacing;
  const VoxelFrame frame = make_frame(positions, config.particle_radius * h, config);
  const SurfaceShape shape = make_shape(config, h, frame.voxel_size);
  const double kernel_radius = config.kernel_radius * h / frame.voxel_size;
  return run_with_threads(threads, [&] {
    const ParticleCells cells(positions, frame, std::max(h / frame.voxel_size, 0.5 * k_leaf_side));
    // A voxel more, for the edges of the grid that leave the body.
    const double reach = farthest_inside(shape) * kernel_radius + 1;
    const auto coords = touched_leaves(cells.positions(), reach, frame);
    return extract_mesh(*fill_level_set(cells, coords, kernel_radius, shape), frame);
  });
}

}  // namespace mallow
