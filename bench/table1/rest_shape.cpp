#include "table1/rest_shape.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "mallow/files.h"
#include "mallow/level_set.h"

namespace mallow::bench {
namespace {

ImplicitShape box_shape(const Lattice& lattice) {
  const Vec3 half = 0.5f * lattice.spacing *
                    Vec3(static_cast<float>(lattice.count[0]), static_cast<float>(lattice.count[1]),
                         static_cast<float>(lattice.count[2]));
  const Vec3 center = lattice.corner + half;
  return {[=](const Vec3& x) {
            const Vec3 beyond = (x - center).cwiseAbs() - half;
            return beyond.cwiseMax(0.0f).norm() + std::min(beyond.maxCoeff(), 0.0f);
          },
          {center - half, center + half}};
}

}  // namespace

RestShape::RestShape(const Scene& scene, int threads) {
  for (const SceneBody& body : scene.bodies) {
    if (const auto* box = std::get_if<Lattice>(&body.source)) bodies_.push_back(box_shape(*box));
    if (const auto* ball = std::get_if<SphereSource>(&body.source))
      bodies_.push_back(sphere_shape(ball->center, ball->radius));
    if (const auto* mesh = std::get_if<MeshSource>(&body.source))
      bodies_.push_back(
          place(mesh_shape(read_mesh(scene.file.parent_path() / mesh->file), k_mesh_voxels, threads),
                mesh->placement));
    if (const auto* named = std::get_if<ImplicitSource>(&body.source))
      bodies_.push_back(place(implicit_shape(named->shape), named->placement));
  }
}

double RestShape::mean_distance(const Mesh& mesh) const {
  double sum = 0;
  for (const Vec3& x : mesh.vertices) {
    float nearest = HUGE_VALF;
    for (const ImplicitShape& body : bodies_) nearest = std::min(nearest, std::abs(body.distance(x)));
    sum += static_cast<double>(nearest);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, mesh.vertices.size()));
}

}  // namespace mallow::bench
