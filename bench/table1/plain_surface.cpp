#include "table1/plain_surface.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/ParticlesToLevelSet.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "level_set/arena.h"

namespace mallow::bench {
namespace {

/// Radius of the spheres in spacings: half of a cell's diagonal.
constexpr double k_sphere_radius = 0.87;

/// What ParticlesToLevelSet wants to know.
class Spheres {
 public:
  using PosType = openvdb::Vec3R;

  Spheres(std::span<const Vec3> positions, double radius) : positions_(positions), radius_(radius) {}
  std::size_t size() const { return positions_.size(); }
  void getPos(std::size_t n, openvdb::Vec3R& x) const {
    x = {static_cast<double>(positions_[n].x()), static_cast<double>(positions_[n].y()),
         static_cast<double>(positions_[n].z())};
  }
  void getPosRad(std::size_t n, openvdb::Vec3R& x, openvdb::Real& radius) const {
    getPos(n, x);
    radius = radius_;
  }

 private:
  std::span<const Vec3> positions_;
  double radius_;
};

}  // namespace

Mesh plain_surface(std::span<const Vec3> positions, float spacing, double voxel_size, int threads) {
  openvdb::initialize();
  return run_with_threads(threads, [&] {
    const auto h = static_cast<double>(spacing);
    auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(voxel_size);
    openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*grid);
    raster.rasterizeSpheres(Spheres(positions, k_sphere_radius * h));
    raster.finalize(true);
    openvdb::tools::Filter<openvdb::FloatGrid>(*grid).gaussian(1, 1);
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, triangles, quads, 0.0, 0.0, false);
    Mesh mesh;
    for (const openvdb::Vec3s& p : points) mesh.vertices.emplace_back(p.x(), p.y(), p.z());
    for (const openvdb::Vec3I& t : triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
    for (const openvdb::Vec4I& q : quads) {
      mesh.triangles.push_back({q[0], q[1], q[2]});
      mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
  });
}

}  // namespace mallow::bench
