#include <cmath>
#include <random>
#include <vector>

#include "mallow/body.h"
#include "mallow/surface.h"
#include "meshes.h"
#include "surface/manifold.h"
#include "surface/same_meshes.h"

/// How near surfaces are, with the voxels that they have by default, to what they are of.
namespace mallow {
namespace fidelity_test {

std::vector<Vec3> lattice(int nx, int ny, int nz, float jitter = 0) {
  return sample(Lattice{.count = {nx, ny, nz}, .spacing = 1.0f, .jitter = jitter}).positions;
}

/// Faces, 0.55 beyond the outermost particles, would meet at an edge 0.778 beyond those along it.
TEST(surface_fidelity, edges_of_a_box_are_rounded_evenly_by_what_the_kernel_says) {
  struct Case {
    float kernel_radius, rounded;
  };
  for (const auto [kernel_radius, rounded] : {Case{1.5f, 0.24f}, {2, 0.40f}, {2.5f, 0.53f}, {3, 0.64f}}) {
    const Mesh mesh = surface(lattice(12, 12, 12), 1, {.kernel_radius = kernel_radius});
    int along = 0;
    for (const Vec3& x : mesh.vertices) {
      const float beyond = (x.x() - 11.5f + x.y() - 11.5f) / std::sqrt(2.0f);
      if (std::abs(x.z() - 6) > 4 || std::abs(x.x() - x.y()) > 0.2f || x.x() < 6) continue;
      ++along;
      ASSERT_NEAR(0.55f * std::sqrt(2.0f) - beyond, rounded, 0.02f) << "kernel radius " << kernel_radius;
    }
    EXPECT_GT(along, 15);
  }
}

/// A shaken, stretched sheet of one layer, askew to the voxels.
std::vector<Vec3> sheet(float jitter, float stretch) {
  std::mt19937 random(1);
  std::vector<Vec3> points = lattice(20, 20, 1);
  for (Vec3& x : points) {
    x *= stretch;
    for (float& c : x) c += jitter * (2 * static_cast<float>(random()) / 4294967296.0f - 1);
    x = Eigen::AngleAxisf(0.5f, Vec3(1, 2, 3).normalized()) * x;
  }
  return points;
}

TEST(surface_fidelity, thin_sheets_are_whole_and_have_no_holes) {
  for (const float kernel_radius : {2.0f, 2.5f, 3.0f})
    for (const float jitter : {0.0f, 0.3f})
      for (const float stretch : {1.0f, 1.2f}) {
        SCOPED_TRACE(testing::Message() << kernel_radius << ", jitter " << jitter << ", stretch " << stretch);
        const Mesh mesh = surface(sheet(jitter, stretch), 1, {.kernel_radius = kernel_radius});
        EXPECT_EQ(why_not_manifold(mesh), "");
        EXPECT_EQ(component_count(mesh), 1u);
        // A hole would take two from Euler's number.
        EXPECT_EQ(static_cast<long>(mesh.vertices.size()) - static_cast<long>(mesh.triangles.size() / 2), 2);
        if (stretch > 1) continue;
        const double thick = signed_volume(mesh) / 400;
        EXPECT_NEAR(thick, kernel_radius == 2 ? 1.1 : 1.25, 0.05);
      }
}

/// 0.017 spacings in the mean, as SurfaceConfig::voxels_per_spacing says.
TEST(surface_fidelity, surfaces_are_where_fine_voxels_show_them) {
  std::vector<Vec3> ball;
  for (const Vec3& x : lattice(9, 9, 9, 0.3f))
    if ((x - Vec3::Constant(4.5f)).norm() < 4.4f) ball.push_back(x);
  for (const float kernel_radius : {2.0f, 2.5f})
    for (const std::vector<Vec3>& points : {lattice(8, 8, 8, 0.3f), sheet(0.3f, 1), ball}) {
      const Mesh mesh = surface(points, 1, {.kernel_radius = kernel_radius});
      const Mesh fine = surface(points, 1, {.voxel_size = 0.07f, .kernel_radius = kernel_radius});
      double sum = 0;
      int count = 0;
      for (std::size_t v = 0; v < mesh.vertices.size(); v += 20, ++count) {
        const float off = height_above(fine, mesh.vertices[v]);
        sum += static_cast<double>(off);
        ASSERT_LT(off, 0.09f) << kernel_radius;
      }
      EXPECT_LT(sum / count, 0.017) << kernel_radius;
    }
}

}  // namespace fidelity_test
}  // namespace mallow
