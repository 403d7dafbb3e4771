#include "surface/ellipsoids.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "mallow/body.h"
#include "mallow/surface.h"
#include "meshes.h"
#include "surface/particle_order.h"

namespace mallow {
namespace ellipsoids_test {

constexpr SurfaceConfig k_anisotropic{.voxel_size = 0.15f, .kind = SurfaceKind::anisotropic};

struct Fit {
  std::map<std::uint32_t, Vec3> centers;  ///< by particle
  std::map<std::uint32_t, Ellipsoid> shapes;
};
Fit fit(const std::vector<Vec3>& positions, const AnisotropyModel& model) {
  ParticleCells cells;
  ParticleOrder order;
  order.sort({.positions = positions, .bodies = {{.spacing = 1}}}, false);
  cells.sort({positions, order.rows(0)}, 1, 2, 2);
  Ellipsoids ellipsoids;
  ellipsoids.fit(model, 2, 2, cells);
  Fit fit;
  for (std::size_t place = 0; place < cells.count(); ++place) {
    fit.centers[cells.particle(place)] = cells.position(place);
    fit.shapes[cells.particle(place)] = ellipsoids.shapes()[place];
  }
  return fit;
}
Eigen::Matrix3f matrix(const Ellipsoid& g) {
  return (Eigen::Matrix3f() << g.xx, g.xy, g.xz, g.xy, g.yy, g.yz, g.xz, g.yz, g.zz).finished();
}
/// Shortest first [kernel radii].
Eigen::Vector3f axes(const Ellipsoid& g) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen(matrix(g));
  return eigen.eigenvalues().reverse().cwiseInverse();
}

std::vector<Vec3> lattice(int nx, int ny, int nz) {
  std::vector<Vec3> points;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) points.push_back(Eigen::Vector3i(i, j, k).cast<float>());
  return points;
}
std::vector<Vec3> shaken_ball(float radius) {
  return sample(sphere_shape({0, 0, 0}, radius), {.spacing = 1.0f, .jitter = 0.3f}).positions;
}

TEST(ellipsoids, are_round_inside_and_flat_on_faces_and_sheets) {
  const AnisotropyModel model(2, 0.55);
  const std::vector<Vec3> cube = lattice(9, 9, 9);
  const Fit body = fit(cube, model);
  const std::uint32_t middle = (4 * 9 + 4) * 9 + 4, face = (4 * 9 + 4) * 9 + 8;
  EXPECT_GT(axes(body.shapes.at(middle))[0], 0.9f);
  EXPECT_LT((body.centers.at(middle) - cube[middle]).norm(), 1e-4f);
  const Eigen::Vector3f on_face = axes(body.shapes.at(face));
  EXPECT_NEAR(on_face[0], 0.6f, 0.05f);
  EXPECT_GT(on_face[1], 0.9f);
  EXPECT_NEAR(body.centers.at(face).z(), 8 - 0.35f, 0.02f);
  EXPECT_NEAR(2 * body.shapes.at(face).reach[2], 2 * on_face[0], 1e-3f);

  const Fit sheet = fit(lattice(9, 9, 1), model);
  EXPECT_NEAR(axes(sheet.shapes.at(4 * 9 + 4))[0], 0.375f, 1e-3f);
}

TEST(ellipsoids, density_is_one_inside_of_a_body) {
  const AnisotropyModel model(2, 0.55);
  const Fit body = fit(lattice(9, 9, 9), model);
  for (const Vec3& x : {Vec3(4, 4, 4), Vec3(4.5f, 4.5f, 4.5f), Vec3(4.5f, 4, 4)}) {
    float density = 0;
    for (const auto& [i, center] : body.centers) {
      const Eigen::Vector3f q = matrix(body.shapes.at(i)) * (center - x) / 2;
      density += body.shapes.at(i).weight * std::pow(std::max(0.0f, 1 - q.squaredNorm()), 3.0f);
    }
    EXPECT_NEAR(density, 1, 0.03f);
  }
}

TEST(ellipsoids, turn_with_the_body) {
  const AnisotropyModel model(2, 0.55);
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.7f, Vec3(1, 2, 3).normalized()).matrix();
  const std::vector<Vec3> points = shaken_ball(4);
  std::vector<Vec3> turned;
  for (const Vec3& x : points) turned.push_back(turn * x);
  Fit a = fit(points, model), b = fit(turned, model);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    ASSERT_LT((turn * a.centers[i] - b.centers[i]).norm(), 1e-4f);
    ASSERT_LT((turn * matrix(a.shapes[i]) * turn.transpose() - matrix(b.shapes[i])).norm(), 2e-3f);
  }
}

TEST(anisotropic_surface, of_a_cube_has_flat_faces_at_the_particle_radius_and_its_volume) {
  for (const float kernel_radius : {2.0f, 3.0f}) {
    SurfaceConfig config = k_anisotropic;
    config.kernel_radius = kernel_radius;
    const Mesh mesh = surface(lattice(12, 12, 12), 1, config);
    EXPECT_EQ(why_not_closed(mesh), "");
    EXPECT_EQ(component_count(mesh), 1u);
    int on_top = 0;
    for (const Vec3& x : mesh.vertices) {
      if (std::abs(x.x() - 5.5f) > 2 || std::abs(x.y() - 5.5f) > 2 || x.z() < 6) continue;
      ASSERT_NEAR(x.z(), 11 + 0.55f, 0.03f) << kernel_radius;
      ++on_top;
    }
    EXPECT_GT(on_top, 100);
    EXPECT_NEAR(signed_volume(mesh), 1728, 0.02 * 1728) << kernel_radius;
  }
}

TEST(anisotropic_surface, of_one_particle_and_of_a_sheet_lies_at_the_particle_radius) {
  for (const Vec3& x : surface(std::vector<Vec3>{{1, 2, 3}}, 1, k_anisotropic).vertices)
    ASSERT_NEAR((x - Vec3(1, 2, 3)).norm(), 0.55f, 0.03f);
  const Mesh sheet = surface(lattice(17, 17, 1), 1, k_anisotropic);
  EXPECT_EQ(component_count(sheet), 1u);
  for (const Vec3& x : sheet.vertices) {
    if ((x - Vec3(8, 8, x.z())).norm() > 5) continue;
    ASSERT_NEAR(std::abs(x.z()), 0.55f, 0.04f);
  }
}

/// Mean square distance of the vertices from the sphere that fits best.
double unevenness(const Mesh& mesh) {
  double sum = 0, squares = 0;
  for (const Vec3& x : mesh.vertices) {
    sum += static_cast<double>(x.norm());
    squares += static_cast<double>(x.squaredNorm());
  }
  const double n = static_cast<double>(mesh.vertices.size());
  return squares / n - sum * sum / (n * n);
}

TEST(anisotropic_surface, of_a_shaken_ball_is_smoother_than_a_blended_one_and_in_one_piece) {
  const std::vector<Vec3> points = shaken_ball(8);
  const Mesh mesh = surface(points, 1, k_anisotropic);
  EXPECT_EQ(why_not_closed(mesh), "");
  EXPECT_EQ(component_count(mesh), 1u);
  EXPECT_LT(unevenness(mesh), 0.85 * unevenness(surface(points, 1, {.voxel_size = 0.15f})));
}

TEST(anisotropic_surface, of_a_crowd_in_one_point_is_drawn_like_a_few) {
  const Mesh mesh = surface(std::vector<Vec3>(20000, Vec3(1, 2, 3)), 1, k_anisotropic);
  EXPECT_EQ(why_not_closed(mesh), "");
  for (const Vec3& x : mesh.vertices) ASSERT_NEAR((x - Vec3(1, 2, 3)).norm(), 0.7f, 0.25f);
}

TEST(anisotropic_surface, refuses_kernels_too_small_to_tell_a_shape) {
  SurfaceConfig config = k_anisotropic;
  config.kernel_radius = 1.5f;
  expect_words(config_error([&] { surface(lattice(3, 3, 3), 1, config); }),
               {"surface.kernel_radius", "1.5", "a number in [2, 4] for anisotropic kernels"});
}

}  // namespace ellipsoids_test
}  // namespace mallow
