#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "core/parallel.h"
#include "mallow/errors.h"
#include "mallow/surface.h"
#include "surface/dual_mesher.h"
#include "surface/mesh_smoothing.h"
#include "surface/particle_order.h"
#include "surface/surface_checks.h"
#include "surface/surface_field.h"
#include "surface/surfacer_access.h"

namespace mallow {
namespace {

/// Voxels along an axis: keeps the numbers of blocks within 21 bits and offsets within a block exact.
constexpr int k_max_side = 1 << 22;

/// The box of all particles and of the surface around them.
struct Extent {
  Eigen::Vector3d low;      ///< of the particles [m]
  double longest_side = 0;  ///< with the surface [m]
};

Extent extent_of(const SurfaceParticles& particles, double margin) {
  constexpr float k_far = std::numeric_limits<float>::max();
  Vec3 low = Vec3::Constant(k_far), high = -low;
  for (const SurfaceBody& body : particles.bodies) {
    const Simulation::Rows rows = rows_of(body, particles.positions.size());
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      const Vec3 x = particles.positions[row];
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  const Eigen::Vector3d corner = low.cast<double>();
  return {corner, (high.cast<double>() - corner).maxCoeff() + 2 * margin};
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
  ParticleOrder order;
  std::vector<SurfaceField> fields;  ///< one for each surface
  DualMesher mesher;
  Mesh mesh;
  MeshCounts counts;
  std::vector<float> spacings;             ///< the widest of each surface [m]
  std::vector<std::uint32_t> body_of_row;  ///< of joined surfaces
  std::vector<std::uint32_t> bodies;       ///< the same by particle, in the order of its field
  MeshSmoother smoother;

  void draw(const SurfaceParticles& particles);
  void draw_one(const SurfaceParticles& all, std::size_t surface, const Extent& extent);
  template <class Visit>
  void at_vertices(const Visit& visit);
  void find_materials(const SurfaceField& field, const SurfaceParticles& all);
  void find_velocities(const SurfaceField& field, const PickedVectors& velocities);
};

/// Calls visit(run, points, n) for the vertices of the surface drawn last, a run of them in or next to one
/// block at a time, as n points for SurfaceField::mean_at().
template <class Visit>
void Surfacer::Work::at_vertices(const Visit& visit) {
  const auto& runs = mesher.block_vertices();
  parallel_for(
      threads, runs.size(),
      [&](std::size_t begin, std::size_t end) {
        thread_local std::vector<float> points[3];
        for (std::size_t r = begin; r < end; ++r) {
          const std::size_t n = padded(runs[r].count);
          for (std::size_t a = 0; a < 3; ++a) {
            points[a].resize(n);
            // The last fills up to eights: they are to lie near each other.
            for (std::uint32_t v = 0; v < n; ++v)
              points[a][v] =
                  mesher.local(runs[r].first + std::min(v, runs[r].count - 1))[static_cast<Eigen::Index>(a)];
          }
          visit(runs[r], ConstVectors{points[0].data(), points[1].data(), points[2].data()}, n);
        }
      },
      4);
}

/// Each vertex of a joined surface belongs to the body that has the largest share of the weight there.
void Surfacer::Work::find_materials(const SurfaceField& field, const SurfaceParticles& all) {
  const auto in_body_0 = [](const SurfaceBody& body) { return body.body == 0; };
  if (std::all_of(all.bodies.begin(), all.bodies.end(), in_body_0)) return;
  body_of_row.resize(all.positions.size());
  for (const SurfaceBody& body : all.bodies) {
    const Simulation::Rows rows = rows_of(body, body_of_row.size());
    for (std::size_t row = rows.begin; row < rows.end; ++row) body_of_row[row] = body.body;
  }
  bodies.clear();
  for (const std::uint32_t row : order.rows(0)) bodies.push_back(body_of_row[row]);
  at_vertices([&](const DualMesher::BlockVertices& run, ConstVectors points, std::size_t n) {
    field.body_at(run.block, points, n, bodies, std::span(mesh.material_ids).subspan(run.first, run.count));
  });
}

void Surfacer::Work::find_velocities(const SurfaceField& field, const PickedVectors& velocities) {
  mesh.velocities.resize(mesh.vertices.size());
  at_vertices([&](const DualMesher::BlockVertices& run, ConstVectors points, std::size_t n) {
    thread_local std::vector<float> means[3];
    for (std::vector<float>& mean : means) mean.resize(n);
    field.mean_at(run.block, points, n, velocities, {means[0].data(), means[1].data(), means[2].data()});
    for (std::uint32_t v = 0; v < run.count; ++v)
      mesh.velocities[run.first + v] = Vec3(means[0][v], means[1][v], means[2][v]);
  });
}

/// Appends the surface around the particles of a body, or of all where they are joined.
void Surfacer::Work::draw_one(const SurfaceParticles& all, std::size_t surface, const Extent& extent) {
  const std::span<const std::uint32_t> rows = order.rows(surface);
  if (rows.empty()) return;
  SurfaceField& field = fields[surface];
  const std::size_t first = counts.vertices;
  const float spacing = spacings[surface];
  field.build({all.positions, rows}, spacing, config, make_frame(config, spacing, extent), threads);
  mesher.append(field, config.adaptivity, threads, counts, mesh);
  mesh.material_ids.resize(mesh.vertices.size(), static_cast<std::uint32_t>(surface));
  if (config.joined) find_materials(field, all);
  if (!all.velocities.empty()) find_velocities(field, {all.velocities, rows});
  if (config.smoothing > 0) smoother.smooth(config.smoothing, first, threads, mesh);
}

void Surfacer::Work::draw(const SurfaceParticles& particles) {
  check(particles);
  counts = {};
  mesh.velocities.clear();
  mesh.material_ids.clear();
  order.sort(particles, config.joined);
  fields.resize(order.surfaces());
  for (SurfaceField& field : fields) field.clear();
  if (order.count() == 0) {
    mesh = {};
    return;
  }
  spacings.assign(fields.size(), 0.0f);
  for (const SurfaceBody& body : particles.bodies) {
    float& widest = spacings[config.joined ? 0 : body.body];
    widest = std::max(widest, body.spacing);
  }
  const float widest = *std::max_element(spacings.begin(), spacings.end());
  const Extent extent = extent_of(particles, static_cast<double>(config.particle_radius * widest));
  for (std::size_t s = 0; s < fields.size(); ++s) draw_one(particles, s, extent);
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

std::size_t Surfacer::surface_count() const {
  return work_->fields.size();
}

std::size_t Surfacer::bytes() const {
  std::size_t bytes =
      work_->order.bytes() + work_->mesher.bytes() + work_->mesh.vertices.capacity() * 4 * sizeof(Vec3);
  for (const SurfaceField& field : work_->fields) bytes += field.bytes();
  return bytes;
}

std::span<const SurfaceField> SurfacerAccess::fields(const Surfacer& surfacer) {
  return surfacer.work_->fields;
}
const Threads& SurfacerAccess::threads(const Surfacer& surfacer) {
  return surfacer.work_->threads;
}

Mesh surface(StridedVectors positions, float spacing, const SurfaceConfig& config, int threads) {
  Surfacer surfacer(config, threads);
  return surfacer.draw({.positions = positions, .bodies = {{.spacing = spacing}}});
}

}  // namespace mallow
