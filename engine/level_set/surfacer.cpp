#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "core/checks.h"
#include "core/parallel.h"
#include "level_set/dual_mesher.h"
#include "level_set/level_set_vdb.h"
#include "level_set/mesh_smoothing.h"
#include "level_set/surface_field.h"
#include "mallow/level_set.h"

namespace mallow {
namespace {

/// Voxels along an axis: keeps the numbers of blocks within 21 bits and offsets within a block exact.
constexpr int k_max_side = 1 << 22;

void check(const SurfaceConfig& config, int threads) {
  Checks checks;
  if (config.voxel_size)
    checks.number("surface.voxel_size", *config.voxel_size, *config.voxel_size > 0, "a number above 0");
  else if (config.voxels)
    checks.number("surface.voxels", *config.voxels, *config.voxels >= 8 && *config.voxels <= 1024,
                  "8 to 1024");
  else
    checks.number("surface.voxels_per_spacing", config.voxels_per_spacing,
                  config.voxels_per_spacing >= 0.5f && config.voxels_per_spacing <= 16, "0.5 to 16");
  checks.number("surface.kernel_radius", config.kernel_radius,
                config.kernel_radius >= 1 && config.kernel_radius <= 4, "1 to 4 spacings");
  if (config.kind == SurfaceKind::anisotropic)
    checks.number("surface.kernel_radius", config.kernel_radius, config.kernel_radius >= 2,
                  "2 to 4 spacings for anisotropic kernels: fewer neighbours do not tell a shape");
  checks.number("surface.particle_radius", config.particle_radius,
                config.particle_radius >= 0.1f && config.particle_radius <= 1, "0.1 to 1 spacings");
  checks.number("surface.adaptivity", config.adaptivity, config.adaptivity >= 0 && config.adaptivity <= 1,
                "0 to 1 voxels");
  checks.number("surface.smoothing", config.smoothing, config.smoothing >= 0 && config.smoothing <= 100,
                "0 to 100 rounds");
  checks.number("surface.memory_limit", config.memory_limit, config.memory_limit > 0, "a number above 0");
  checks.number("threads", threads, threads >= 0, "0 (all there are) or more");
  checks.finish();
}

void check(const SurfaceParticles& particles) {
  Checks checks;
  const std::size_t n = particles.positions.size();
  for (std::size_t g = 0; g < particles.spacings.size(); ++g)
    checks.number("spacings[" + std::to_string(g) + "]", particles.spacings[g], particles.spacings[g] > 0,
                  "a number above 0");
  const auto each = [&](const char* name, std::size_t count) {
    if (count != 0 && count != n)
      checks.problem(name, std::to_string(count) + " are not allowed: none, or one for each of " +
                               std::to_string(n) + " positions");
  };
  each("velocities", particles.velocities.size());
  each("groups", particles.groups.size());
  if (n > 0 && particles.spacings.empty()) checks.problem("spacings", "there is none for group 0");
  for (std::size_t i = 0; i < n; ++i) {
    if (particles.positions[i].allFinite()) continue;
    checks.vector("positions[" + std::to_string(i) + "]", particles.positions[i]);
    break;
  }
  for (std::size_t i = 0; i < particles.velocities.size(); ++i) {
    if (particles.velocities[i].allFinite()) continue;
    checks.vector("velocities[" + std::to_string(i) + "]", particles.velocities[i]);
    break;
  }
  for (std::size_t i = 0; i < particles.groups.size(); ++i) {
    if (particles.groups[i] < particles.spacings.size()) continue;
    checks.problem("groups[" + std::to_string(i) + "]",
                   std::to_string(particles.groups[i]) + " is not allowed: below the number of spacings, " +
                       std::to_string(particles.spacings.size()));
    break;
  }
  checks.finish();
}

/// The box of all particles and of the surface around them.
struct Extent {
  Eigen::Vector3d low;      ///< of the particles [m]
  double longest_side = 0;  ///< with the surface [m]
};

Extent extent_of(std::span<const Vec3> positions, double margin) {
  Eigen::Vector3d low = positions[0].cast<double>(), high = low;
  for (const Vec3& x : positions) {
    low = low.cwiseMin(x.cast<double>());
    high = high.cwiseMax(x.cast<double>());
  }
  return {low, (high - low).maxCoeff() + 2 * margin};
}

/// Side of the voxels of a surface [m]. A float, where it does not follow the box: a whole number of such
/// sides is exact in double, and so are places on the grid wherever its origin is.
double voxel_size(const SurfaceConfig& config, float spacing, const Extent& extent) {
  if (config.voxel_size) return static_cast<double>(*config.voxel_size);
  if (config.voxels) return extent.longest_side / *config.voxels;
  return static_cast<double>(spacing / config.voxels_per_spacing);
}

/// The grid of a surface. Its origin is a corner of a fixed lattice, a cube of BlockMap wide: voxels, blocks
/// and the order of blocks stay where they are while particles come and go.
VoxelFrame make_frame(const SurfaceConfig& config, float spacing, const Extent& extent) {
  constexpr int k_lattice = BlockMap::k_cube_side * k_block_side;
  VoxelFrame frame;
  frame.voxel_size = voxel_size(config, spacing, extent);
  const double side = k_lattice * frame.voxel_size;
  frame.origin = (extent.low / side).array().floor() * side;
  if (extent.longest_side / frame.voxel_size > k_max_side) {
    std::ostringstream text;
    text << "voxels of " << frame.voxel_size << " m are too small for these particles: the grid would be "
         << extent.longest_side / frame.voxel_size << " voxels long, and " << k_max_side << " are allowed";
    throw ConfigError("surface.voxel_size", text.str());
  }
  return frame;
}

}  // namespace

struct Surfacer::Work {
  SurfaceConfig config;
  std::shared_ptr<Executor> executor;  ///< that `threads` points to
  Threads threads = 1;
  std::vector<SurfaceField> fields;  ///< one for each surface
  DualMesher mesher;
  Mesh mesh;
  MeshCounts counts;
  std::vector<Vec3> positions, velocities, shares;  ///< of the particles of one surface
  MeshSmoother smoother;

  void draw(const SurfaceParticles& particles);
  void draw_one(const SurfaceParticles& all, std::size_t surface, float spacing, const VoxelFrame& frame);
  template <class Write>
  void at_vertices(const SurfaceField& field, std::span<const Vec3> values, const Write& write);
  void find_materials(const SurfaceField& field, const SurfaceParticles& all);
};

/// Calls write(vertex, mean) for the vertices of the surface drawn last, with the mean of the particles'
/// values there.
template <class Write>
void Surfacer::Work::at_vertices(const SurfaceField& field, std::span<const Vec3> values,
                                 const Write& write) {
  const auto& runs = mesher.block_vertices();
  parallel_for(
      threads, runs.size(),
      [&](std::size_t begin, std::size_t end) {
        thread_local std::vector<float> points[3], means[3];
        for (std::size_t r = begin; r < end; ++r) {
          const std::size_t n = padded(runs[r].count);
          for (std::size_t a = 0; a < 3; ++a) {
            points[a].assign(n, 0.0f);
            means[a].resize(n);
            for (std::uint32_t v = 0; v < runs[r].count; ++v)
              points[a][v] = mesher.local(runs[r].first + v)[static_cast<Eigen::Index>(a)];
          }
          field.mean_at(runs[r].block, {points[0].data(), points[1].data(), points[2].data()}, n, values,
                        {means[0].data(), means[1].data(), means[2].data()});
          for (std::uint32_t v = 0; v < runs[r].count; ++v)
            write(runs[r].first + v, Vec3(means[0][v], means[1][v], means[2][v]));
        }
      },
      4);
}

/// Each vertex of a joined surface belongs to the group that has the largest share of the weight there.
void Surfacer::Work::find_materials(const SurfaceField& field, const SurfaceParticles& all) {
  std::vector<float> largest(mesh.vertices.size(), 0.0f);
  for (std::size_t first = 0; first < all.spacings.size(); first += 3) {
    shares.assign(all.positions.size(), Vec3(0, 0, 0));
    for (std::size_t i = 0; i < all.groups.size(); ++i)
      if (all.groups[i] >= first && all.groups[i] < first + 3)
        shares[i][static_cast<Eigen::Index>(all.groups[i] - first)] = 1;
    at_vertices(field, shares, [&](std::uint32_t vertex, const Vec3& share) {
      Eigen::Index which = 0;
      if (!(share.maxCoeff(&which) > largest[vertex])) return;
      largest[vertex] = share[which];
      mesh.material_ids[vertex] = static_cast<std::uint8_t>(first + static_cast<std::size_t>(which));
    });
  }
}

/// Appends the surface around the particles of a group, or of all where they are joined.
void Surfacer::Work::draw_one(const SurfaceParticles& all, std::size_t surface, float spacing,
                              const VoxelFrame& frame) {
  std::span<const Vec3> x = all.positions, v = all.velocities;
  if (!config.joined && !all.groups.empty()) {
    positions.clear();
    velocities.clear();
    for (std::size_t i = 0; i < all.positions.size(); ++i) {
      if (all.groups[i] != surface) continue;
      positions.push_back(all.positions[i]);
      if (!all.velocities.empty()) velocities.push_back(all.velocities[i]);
    }
    x = positions;
    v = velocities;
  }
  SurfaceField& field = fields[surface];
  const std::size_t first = counts.vertices;
  field.build(x, spacing, config, frame, threads);
  mesher.append(field, config.adaptivity, threads, counts, mesh);
  if (!all.groups.empty()) mesh.material_ids.resize(mesh.vertices.size(), static_cast<std::uint8_t>(surface));
  if (config.joined && !all.groups.empty()) find_materials(field, all);
  if (!all.velocities.empty()) {
    mesh.velocities.resize(mesh.vertices.size());
    at_vertices(field, v, [&](std::uint32_t vertex, const Vec3& mean) { mesh.velocities[vertex] = mean; });
  }
  if (config.smoothing > 0) smoother.smooth(config.smoothing, first, threads, mesh);
}

void Surfacer::Work::draw(const SurfaceParticles& particles) {
  check(particles);
  counts = {};
  mesh.velocities.clear();
  mesh.material_ids.clear();
  const std::size_t surfaces = config.joined || particles.groups.empty() ? 1 : particles.spacings.size();
  fields.resize(surfaces);
  for (SurfaceField& field : fields) field.clear();
  if (particles.positions.empty()) {
    mesh = {};
    return;
  }
  const float widest = *std::max_element(particles.spacings.begin(), particles.spacings.end());
  const Extent extent = extent_of(particles.positions, static_cast<double>(config.particle_radius * widest));
  for (std::size_t s = 0; s < surfaces; ++s) {
    const float spacing = config.joined ? widest : particles.spacings[s];
    draw_one(particles, s, spacing, make_frame(config, spacing, extent));
  }
}

Surfacer::Surfacer(const SurfaceConfig& config, int threads, std::shared_ptr<Executor> executor) {
  check(config, threads);
  work_ = std::make_unique<Work>();
  work_->config = config;
  work_->executor = std::move(executor);
  work_->threads = Threads(threads, work_->executor);
}
Surfacer::~Surfacer() = default;
Surfacer::Surfacer(Surfacer&&) noexcept = default;
Surfacer& Surfacer::operator=(Surfacer&&) noexcept = default;

const Mesh& Surfacer::draw(const SurfaceParticles& particles) {
  work_->draw(particles);
  return work_->mesh;
}

std::string Surfacer::level_set_vdb() const {
  return mallow::level_set_vdb(work_->fields, work_->threads);
}

std::size_t Surfacer::bytes() const {
  std::size_t bytes = work_->mesher.bytes() + work_->mesh.vertices.capacity() * 4 * sizeof(Vec3);
  for (const SurfaceField& field : work_->fields) bytes += field.bytes();
  return bytes;
}

Mesh surface(std::span<const Vec3> positions, float spacing, const SurfaceConfig& config, int threads) {
  Surfacer surfacer(config, threads);
  const float spacings[] = {spacing};
  return surfacer.draw({.positions = positions, .spacings = spacings});
}

}  // namespace mallow
