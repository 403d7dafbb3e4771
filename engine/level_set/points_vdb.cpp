#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointAttribute.h>
#include <openvdb/points/PointConversion.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "level_set/arena.h"
#include "mallow/level_set.h"

namespace mallow {
namespace {

namespace points = openvdb::points;

/// The furthest voxel, so that its neighbours still have an index.
constexpr double k_max_voxel = 1 << 30;
constexpr std::uint32_t k_max_body = 0x7fffffff;

void check(std::span<const Vec3> positions, std::span<const Vec3> velocities,
           std::span<const std::uint32_t> bodies, float voxel_size, int threads) {
  Checks checks;
  check_value("voxel_size", voxel_size, k_positive, checks);
  check_value("threads", threads, range_of(&SolverConfig::threads), checks);
  const std::string allowed = "as many as positions (" + std::to_string(positions.size()) + ')';
  const bool indexable = positions.size() <= 0x7fffffff;
  checks.number("positions", positions.size(), indexable, "at most 2^31 - 1, so that ids fit");
  checks.number("velocities", velocities.size(), velocities.size() == positions.size(), allowed.c_str());
  checks.number("bodies", bodies.size(), bodies.size() == positions.size(), allowed.c_str());
  const auto large =
      std::find_if(bodies.begin(), bodies.end(), [](std::uint32_t b) { return b > k_max_body; });
  if (large != bodies.end())
    checks.problem(
        "bodies[" + std::to_string(large - bodies.begin()) + ']',
        std::to_string(*large) + " is not allowed: at most 2^31 - 1, as OpenVDB has signed integers");
  checks.finish();
  const double furthest = k_max_voxel * static_cast<double>(voxel_size);
  const auto wrong = std::find_if(positions.begin(), positions.end(), [&](const Vec3& x) {
    return !(x.cast<double>().cwiseAbs().maxCoeff() < furthest) || !x.allFinite();
  });
  if (wrong == positions.end()) return;
  std::ostringstream text;
  text << '(' << wrong->transpose() << ") is not allowed: finite, and less than 2^30 voxels from the origin";
  throw ConfigError("positions[" + std::to_string(wrong - positions.begin()) + ']', text.str());
}

/// The columns in the types that OpenVDB stores.
template <class Target, class Source, class Convert>
std::vector<Target> converted(std::span<const Source> values, Convert&& convert) {
  std::vector<Target> result(values.size());
  std::transform(values.begin(), values.end(), result.begin(), convert);
  return result;
}

std::vector<openvdb::Vec3s> vectors(std::span<const Vec3> values) {
  return converted<openvdb::Vec3s>(values, [](const Vec3& v) { return openvdb::Vec3s(v.x(), v.y(), v.z()); });
}

template <class T>
void add_attribute(points::PointDataGrid& grid, const openvdb::tools::PointIndexGrid& order, const char* name,
                   const std::vector<T>& values) {
  points::appendAttribute<T>(grid.tree(), name);
  points::populateAttribute(grid.tree(), order.tree(), name, points::PointAttributeVector<T>(values));
}

points::PointDataGrid::Ptr point_grid(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                      std::span<const std::uint32_t> bodies, float voxel_size) {
  const auto transform = openvdb::math::Transform::createLinearTransform(static_cast<double>(voxel_size));
  const std::vector<openvdb::Vec3s> places = vectors(positions);
  const points::PointAttributeVector<openvdb::Vec3s> columns(places);
  const auto order =
      openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(columns, *transform);
  auto grid =
      points::createPointDataGrid<points::NullCodec, points::PointDataGrid>(*order, columns, *transform);
  grid->setName("particles");
  add_attribute(*grid, *order, "v", vectors(velocities));
  add_attribute(*grid, *order, "group", converted<std::int32_t>(bodies, [](std::uint32_t body) {
    return static_cast<std::int32_t>(body);
  }));
  std::vector<std::int32_t> ids(positions.size());
  std::iota(ids.begin(), ids.end(), 0);
  add_attribute(*grid, *order, "id", ids);
  return grid;
}

}  // namespace

std::string points_vdb(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                       std::span<const std::uint32_t> bodies, float voxel_size, int threads) {
  check(positions, velocities, bodies, voxel_size, threads);
  return run_with_threads(threads, [&] {
    openvdb::initialize();
    // Into memory: who writes it finds out about a full disk, and OpenVDB's own file might not.
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::Stream(bytes).write(
        openvdb::GridCPtrVec{point_grid(positions, velocities, bodies, voxel_size)});
    return std::move(bytes).str();
  });
}

}  // namespace mallow
