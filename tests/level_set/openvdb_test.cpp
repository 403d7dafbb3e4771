#include "mallow/openvdb.h"

#include <openvdb/io/Stream.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "mallow/level_set.h"
#include "meshes.h"

namespace mallow {
namespace openvdb_test {

using Grid = openvdb::FloatGrid;

std::vector<Vec3> shaken_ball(const Vec3& center, float radius) {
  return sample(sphere_shape(center, radius), {.spacing = 1.0f, .jitter = 0.3f}).positions;
}

/// A ball drawn by ourselves, and its grid.
struct Drawing {
  Surfacer surfacer;
  Mesh mesh;
  Grid::Ptr grid;
  float voxel;

  explicit Drawing(const SurfaceConfig& config) : surfacer(config) {
    mesh = surfacer.draw({shaken_ball({0.3f, 0.2f, 0.1f}, 4), {}, {{.spacing = 1}}});
    grid = level_set(surfacer);
    voxel = static_cast<float>(grid->voxelSize().x());
  }
};

Vec3 to_vec3(const openvdb::Vec3s& x) {
  return {x.x(), x.y(), x.z()};
}

Mesh mesh_of(const Grid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  Mesh mesh;
  for (const openvdb::Vec3s& x : points) mesh.vertices.push_back(to_vec3(x));
  for (const openvdb::Vec4I& q : quads) {  // clockwise seen from outside
    mesh.triangles.push_back({q[0], q[2], q[1]});
    mesh.triangles.push_back({q[0], q[3], q[2]});
  }
  return mesh;
}

float distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const float t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0f, 1.0f);
  return (x - a - t * (b - a)).norm();
}
float distance_to_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const auto within = [&](const Vec3& p, const Vec3& q) { return (q - p).cross(x - p).dot(n) >= 0; };
  if (within(a, b) && within(b, c) && within(c, a)) return std::abs((x - a).dot(n)) / n.norm();
  return std::min({distance_to_segment(x, a, b), distance_to_segment(x, b, c), distance_to_segment(x, c, a)});
}
/// At most `far`.
float distance(const Vec3& x, const Mesh& mesh, float far) {
  float nearest = far;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    if ((p - x).squaredNorm() > 4 * far * far) continue;  // triangles are about a voxel large
    nearest = std::min(nearest, distance_to_triangle(x, p, q, r));
  }
  return nearest;
}

TEST(openvdb, mesh_that_its_own_tool_makes_is_within_a_tenth_of_a_voxel_of_ours) {
  for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::anisotropic}) {
    const Drawing ball({.kind = kind});
    const Mesh theirs = mesh_of(*ball.grid);
    EXPECT_NEAR(signed_volume(theirs), signed_volume(ball.mesh), 0.005 * signed_volume(ball.mesh));
    const float far = 2 * ball.voxel;
    float worst = 0;
    for (const Vec3& x : theirs.vertices) worst = std::max(worst, distance(x, ball.mesh, far));
    for (const Vec3& x : ball.mesh.vertices) worst = std::max(worst, distance(x, theirs, far));
    EXPECT_LT(worst, 0.1f * ball.voxel);
  }
}

TEST(openvdb, finds_a_level_set_with_a_whole_band_of_three_voxels) {
  for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::anisotropic, SurfaceKind::spheres}) {
    for (const float voxels : {2.7f, 6.0f}) {
      const Drawing ball({.voxels_per_spacing = voxels, .kind = kind});
      EXPECT_EQ(openvdb::tools::checkLevelSet(*ball.grid, 7), "");
      // Beside a voxel with a distance below two there is none without.
      int missing = 0, band = 0;
      const auto accessor = ball.grid->getConstAccessor();
      for (auto at = ball.grid->cbeginValueOn(); at; ++at) {
        if (std::abs(*at) > 2 * ball.voxel) continue;
        ++band;
        for (std::size_t a = 0; a < 3; ++a)
          for (const int step : {-1, 1}) {
            openvdb::Coord next = at.getCoord();
            next[a] += step;
            missing += !accessor.isValueOn(next);
          }
      }
      EXPECT_EQ(missing, 0);
    }
  }
}

TEST(openvdb, filter_that_offsets_moves_the_surface_by_that) {
  const Drawing ball({});
  openvdb::tools::LevelSetFilter<Grid>(*ball.grid).offset(-ball.voxel);  // outwards
  const Mesh wider = mesh_of(*ball.grid);
  float worst = 0, sum = 0;
  for (const Vec3& x : wider.vertices) {
    const float d = distance(x, ball.mesh, 3 * ball.voxel) / ball.voxel;
    worst = std::max(worst, std::abs(d - 1));
    sum += d;
  }
  EXPECT_NEAR(sum / static_cast<float>(wider.vertices.size()), 1, 0.1f);
  EXPECT_LT(worst, 0.4f);  // in the creases between particles
}

TEST(openvdb, csg_cuts_a_mesh_out_of_the_surface) {
  const Drawing ball({});
  const Mesh box = box_mesh({0.25f, -9, -9}, {9, 9, 9});
  std::vector<openvdb::Vec3s> points;
  for (const Vec3& x : box.vertices) points.emplace_back(x.x(), x.y(), x.z());
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& [a, b, c] : box.triangles) triangles.emplace_back(a, b, c);
  const auto cutter = openvdb::tools::meshToLevelSet<Grid>(ball.grid->transform(), points, triangles);
  const auto left = openvdb::tools::csgDifferenceCopy(*ball.grid, *cutter);
  const auto right = openvdb::tools::csgIntersectionCopy(*ball.grid, *cutter);
  const double whole = signed_volume(ball.mesh);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*ball.grid), whole, 0.005 * whole);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*left) + openvdb::tools::levelSetVolume(*right), whole,
              0.01 * whole);
  const Mesh half = mesh_of(*left);
  EXPECT_EQ(why_not_closed(half), "");
  int cut = 0;
  float worst = 0;
  for (const Vec3& x : half.vertices) {
    ASSERT_LT(x.x(), 0.25f + 0.1f * ball.voxel);
    if (x.x() > 0.25f - ball.voxel)
      ++cut;
    else
      worst = std::max(worst, distance(x, ball.mesh, 2 * ball.voxel));
  }
  EXPECT_GT(cut, 100);
  EXPECT_LT(worst, 0.1f * ball.voxel);
}

TEST(openvdb, grids_are_named_by_their_surface_and_there_are_no_others) {
  std::vector<Vec3> points = shaken_ball({0, 0, 0}, 2);
  const std::size_t first = points.size();
  for (const Vec3& x : shaken_ball({9, 0, 0}, 2)) points.push_back(x);
  using Rows = Simulation::Rows;
  Surfacer surfacer({});
  EXPECT_NE(config_error([&] { level_set(surfacer); }), "");
  surfacer.draw({points,
                 {},
                 {{.spacing = 1, .rows = Rows{0, first}},
                  {.spacing = 1, .body = 1, .rows = Rows{first, points.size()}}}});
  EXPECT_EQ(level_set(surfacer, 1)->getName(), "surface_1");
  expect_words(config_error([&] { level_set(surfacer, 2); }), {"surface: 2 is not allowed", "has 2"});
  surfacer.draw({points, {}, {{.spacing = 1}}});
  EXPECT_EQ(level_set(surfacer)->getName(), "surface");
}

/// Three balls, each a body of its own.
struct ThreeBalls {
  std::vector<Vec3> points;
  std::vector<SurfaceBody> bodies;

  ThreeBalls(std::string_view first, std::string_view second, std::string_view third) {
    for (const std::string_view name : {first, second, third}) {
      const std::size_t begin = points.size();
      const auto body = static_cast<std::uint32_t>(bodies.size());
      for (const Vec3& x : shaken_ball({9 * static_cast<float>(body), 0, 0}, 2)) points.push_back(x);
      bodies.push_back({.spacing = 1,
                        .body = body,
                        .rows = Simulation::Rows{begin, points.size()},
                        .name = name,
                        .material = MaterialId{body % 2}});
    }
  }
  SurfaceParticles particles() const { return {points, {}, bodies}; }
};

TEST(openvdb, grids_have_the_names_of_bodies_that_are_like_no_other) {
  const auto names_of = [](const ThreeBalls& balls) {
    Surfacer surfacer({});
    surfacer.draw(balls.particles());
    std::vector<std::string> names;
    for (std::size_t s = 0; s < surfacer.surface_count(); ++s)
      names.push_back(level_set(surfacer, s)->getName());
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_of({"dough", "knife", "2nd plate"}), (Names{"dough", "knife", "2nd plate"}));
  EXPECT_EQ(names_of({"dough", "", "dough"}), (Names{"surface_0", "surface_1", "surface_2"}));
}

TEST(openvdb, files_say_of_each_grid_which_body_and_material_it_is_of) {
  const ThreeBalls balls("dough", "", "dough");
  Surfacer surfacer({});
  surfacer.draw(balls.particles());
  const std::vector<std::string> materials = {"clay", "jelly"};
  std::istringstream bytes(level_set_vdb(surfacer, materials), std::ios::binary);
  const auto grids = openvdb::io::Stream(bytes).getGrids();
  ASSERT_EQ(grids->size(), 3u);
  for (std::uint32_t b = 0; b < 3; ++b) {
    const openvdb::GridBase& grid = *(*grids)[b];
    EXPECT_EQ(grid.metaValue<std::int64_t>("body"), b);
    EXPECT_EQ(grid.metaValue<std::int64_t>("material_id"), b % 2);
    EXPECT_EQ(grid.metaValue<std::string>("material"), materials[b % 2]);
    ASSERT_EQ(grid["body_name"] != nullptr, b != 1) << b;
    if (b != 1) {
      EXPECT_EQ(grid.metaValue<std::string>("body_name"), "dough");
    }
  }

  Surfacer joined({.joined = true});
  joined.draw(balls.particles());
  const auto grid = level_set(joined);
  EXPECT_EQ(grid->getName(), "surface");
  EXPECT_FALSE((*grid)["body"]);
}

}  // namespace openvdb_test
}  // namespace mallow
