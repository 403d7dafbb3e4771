#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <memory>
#include <string>
#include <utility>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "level_set/arena.h"
#include "level_set/winding_signs.h"
#include "mallow/level_set.h"
#include "shapes/orientation.h"

namespace mallow {
namespace {

/// Voxels on each side of the surface that hold a distance; further away only the sign is known.
constexpr float k_half_band = 3.0f;

void check(const Mesh& mesh, int voxels, int threads) {
  Checks checks;
  check_value("voxels", voxels, between(8, 2048), checks);
  check_value("threads", threads, range_of(&SolverConfig::threads), checks);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (mesh.vertices[i].allFinite()) continue;
    checks.vector("mesh.vertices[" + std::to_string(i) + "]", mesh.vertices[i]);
    break;
  }
  checks.finish();
}

/// A level set in voxel units about a near origin, so that single precision holds far from the world's.
class SampledMesh {
 public:
  /// mesh: welded and closed.
  SampledMesh(const Mesh& mesh, const Orientation& orientation, const Aabb& box, double voxel_size)
      : origin_(box.min.cast<double>()), voxel_size_(voxel_size) {
    std::vector<openvdb::Vec3s> points;
    points.reserve(mesh.vertices.size());
    for (const Vec3& vertex : mesh.vertices) {
      const openvdb::Vec3d p = to_voxels(vertex);
      points.emplace_back(p);
    }
    std::vector<openvdb::Vec3I> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    // OpenVDB's own signs come from a flood fill from outside, which cavities are out of reach of.
    grid_ = openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(
        *openvdb::math::Transform::createLinearTransform(1.0), points, triangles, {}, k_half_band);
    winding_ = sign_by_winding(orientation, points, *grid_);
  }

  float distance(const Vec3& x) const {
    // An accessor that the tree does not register: made and dropped per call at no cost, by any thread.
    const openvdb::FloatGrid::ConstUnsafeAccessor accessor(grid_->tree());
    return static_cast<float>(voxel_size_ * openvdb::tools::BoxSampler::sample(accessor, to_voxels(x)));
  }

  const WindingSummary& winding() const { return winding_; }

 private:
  openvdb::Vec3d to_voxels(const Vec3& x) const {
    const Eigen::Vector3d p = (x.cast<double>() - origin_) / voxel_size_;
    return {p.x(), p.y(), p.z()};
  }

  Eigen::Vector3d origin_;
  double voxel_size_;  ///< [m]
  openvdb::FloatGrid::Ptr grid_;
  WindingSummary winding_;
};

}  // namespace

ImplicitShape mesh_shape(const Mesh& given, int voxels, int threads) {
  check(given, voxels, threads);
  const Mesh mesh = welded(given);
  const std::string open = why_not_closed(mesh);
  const Aabb box = bounds(mesh);
  const double longest_side = (box.max.cast<double>() - box.min.cast<double>()).maxCoeff();
  if (!mesh.vertices.empty() && !(longest_side > 0))
    throw ConfigError("mesh", "does not enclose a volume: all vertices are at one point");
  if (!open.empty()) throw ConfigError("mesh", "does not enclose a volume: " + open);
  Orientation orientation = orient(mesh);
  const double voxel_size = longest_side / voxels;
  const auto sampled = run_with_threads(
      threads, [&] { return std::make_shared<const SampledMesh>(mesh, orientation, box, voxel_size); });
  ImplicitShape shape{[sampled](const Vec3& x) { return sampled->distance(x); }, box, orientation.volume,
                      std::move(orientation.notes)};
  const WindingSummary& winding = sampled->winding();
  // Signed volumes of triangles add up only where no part counts twice.
  if (orientation.even_odd || winding.highest > 1 || winding.lowest < 0)
    shape.volume = static_cast<double>(winding.inside) * voxel_size * voxel_size * voxel_size;
  if (!orientation.even_odd && winding.highest > 1)
    shape.notes.emplace_back(
        "parts of the mesh overlap, or lie within each other and face the same way: filled as one");
  if (!orientation.even_odd && winding.lowest < 0)
    shape.notes.emplace_back(
        "where the mesh is inside out even so, as where cavities overlap, nothing is filled");
  return shape;
}

}  // namespace mallow
