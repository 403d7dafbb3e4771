#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/level_set.h"

namespace mallow {
namespace points_vdb_test {

struct Points {
  std::vector<Vec3> positions;
  std::vector<Vec3> velocities;
  std::vector<std::uint32_t> bodies;
};

Points some_points() {
  Points points;
  for (int i = 0; i < 1000; ++i) {
    const auto t = static_cast<float>(i);
    points.positions.push_back({40 * std::sin(t), 40 * std::cos(1.7f * t), 0.1f * t - 3});
    points.velocities.push_back({t, -t, 0.3f * t});
    points.bodies.push_back(static_cast<std::uint32_t>(i));
  }
  return points;
}

std::string to_vdb(const Points& points, float voxel_size = 2.0f, int threads = 0) {
  return points_vdb(points.positions, points.velocities, points.bodies, voxel_size, threads);
}

/// The one grid of a file, read as other programs do.
openvdb::points::PointDataGrid::Ptr read_vdb(const std::string& bytes) {
  std::string name = (std::filesystem::temp_directory_path() / "mallow_points_XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  EXPECT_GE(descriptor, 0);
  ::close(descriptor);
  std::ofstream(name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  openvdb::initialize();
  openvdb::io::File file(name);
  file.open();
  const openvdb::GridPtrVecPtr grids = file.getGrids();
  file.close();
  std::filesystem::remove(name);
  EXPECT_EQ(grids->size(), 1u);
  return openvdb::gridPtrCast<openvdb::points::PointDataGrid>(grids->at(0));
}

/// Columns of a grid in the order of the attribute id.
Points columns_of(const openvdb::points::PointDataGrid& grid) {
  using openvdb::points::AttributeHandle;
  const std::size_t count = openvdb::points::pointCount(grid.tree());
  const float nowhere = std::numeric_limits<float>::quiet_NaN();
  Points points{std::vector<Vec3>(count, Vec3::Constant(nowhere)), std::vector<Vec3>(count),
                std::vector<std::uint32_t>(count)};
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const AttributeHandle<openvdb::Vec3f> places(leaf->constAttributeArray("P"));
    const AttributeHandle<openvdb::Vec3f> velocities(leaf->constAttributeArray("v"));
    const AttributeHandle<std::int32_t> groups(leaf->constAttributeArray("group"));
    const AttributeHandle<std::int32_t> ids(leaf->constAttributeArray("id"));
    for (auto index = leaf->beginIndexOn(); index; ++index) {
      const auto id = static_cast<std::size_t>(ids.get(*index));
      const openvdb::Vec3d x = grid.transform().indexToWorld(places.get(*index) + index.getCoord().asVec3d());
      const openvdb::Vec3f v = velocities.get(*index);
      points.positions.at(id) = Eigen::Vector3d(x.x(), x.y(), x.z()).cast<float>();
      points.velocities.at(id) = {v.x(), v.y(), v.z()};
      points.bodies.at(id) = static_cast<std::uint32_t>(groups.get(*index));
    }
  }
  return points;
}

TEST(points_vdb, openvdb_reads_the_points_that_were_written) {
  const Points written = some_points();
  const auto grid = read_vdb(to_vdb(written));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->getName(), "particles");
  EXPECT_EQ(grid->transform().voxelSize(), openvdb::Vec3d(2.0));
  const Points read = columns_of(*grid);
  ASSERT_EQ(read.positions.size(), written.positions.size());
  EXPECT_EQ(read.velocities, written.velocities);
  EXPECT_EQ(read.bodies, written.bodies);
  for (std::size_t i = 0; i < read.positions.size(); ++i) {
    // Places are kept as parts of a voxel, in single precision.
    const float error = (read.positions[i] - written.positions[i]).cwiseAbs().maxCoeff();
    EXPECT_LE(error, 2e-7f * 40) << i;
  }
}

TEST(points_vdb, the_same_points_for_any_thread_count) {
  const Points points = some_points();
  const Points one = columns_of(*read_vdb(to_vdb(points, 2.0f, 1)));
  const Points two = columns_of(*read_vdb(to_vdb(points, 2.0f, 2)));
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.velocities, two.velocities);
}

TEST(points_vdb, no_points_and_points_at_one_place_are_files_too) {
  const auto none = read_vdb(to_vdb(Points{}));
  ASSERT_TRUE(none);
  EXPECT_EQ(openvdb::points::pointCount(none->tree()), 0u);
  const Points heap{std::vector<Vec3>(70000, Vec3(1, 2, 3)), std::vector<Vec3>(70000, Vec3(0, 0, 1)),
                    std::vector<std::uint32_t>(70000, 7)};
  EXPECT_EQ(columns_of(*read_vdb(to_vdb(heap))).positions, heap.positions);
}

TEST(points_vdb, what_cannot_be_written_is_refused_by_name) {
  const auto field = [](const Points& points, float voxel_size, int threads = 0) {
    try {
      to_vdb(points, voxel_size, threads);
    } catch (const ConfigError& error) {
      return error.problems().at(0).field;
    }
    return std::string("nothing");
  };
  Points points = some_points();
  EXPECT_EQ(field(points, 0), "voxel_size");
  EXPECT_EQ(field(points, std::numeric_limits<float>::quiet_NaN()), "voxel_size");
  EXPECT_EQ(field(points, 1, -1), "threads");
  EXPECT_EQ(field(points, 1e-9f), "positions[0]");
  points.positions[5].z() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(field(points, 1), "positions[5]");
  points = some_points();
  points.velocities.pop_back();
  EXPECT_EQ(field(points, 1), "velocities");
  points = some_points();
  points.bodies.clear();
  EXPECT_EQ(field(points, 1), "bodies");
  points = some_points();
  points.bodies[7] = 0x80000000u;
  EXPECT_EQ(field(points, 1), "bodies[7]");
}

}  // namespace points_vdb_test
}  // namespace mallow
