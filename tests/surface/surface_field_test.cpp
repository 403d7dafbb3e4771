#include "surface/surface_field.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <random>

#include "mallow/body.h"
#include "surface/particle_order.h"

namespace mallow {
namespace surface_field_test {

/// Calls visit(distance [m], point [m]) for every voxel of every surface block.
template <class Visit>
void for_each_voxel(const SurfaceField& field, const Visit& visit) {
  for (std::uint32_t b = 0; b < field.blocks().size(); ++b) {
    if (field.kind(b) != BlockKind::surface) continue;
    for (int v = 0; v < static_cast<int>(k_block_voxels); ++v) {
      const Eigen::Vector3d voxel =
          (k_block_side * field.blocks().blocks()[b] + Eigen::Vector3i(v / 64, v / 8 % 8, v % 8))
              .cast<double>();
      visit(static_cast<double>(field.distances(b)[v]) * field.frame().voxel_size,
            Eigen::Vector3d(field.frame().origin + field.frame().voxel_size * voxel));
    }
  }
}

SurfaceField build_field(const std::vector<Vec3>& positions, double voxel_size, const SurfaceConfig& config) {
  SurfaceField field;
  const Eigen::Vector3d low = positions[0].cast<double>();
  ParticleOrder order;
  order.sort({.positions = positions, .bodies = {{.spacing = 1}}}, false);
  field.build({positions, order.rows(0)}, 1, config,
              {(low / voxel_size).array().floor() * voxel_size, voxel_size}, 2);
  return field;
}

TEST(surface_field, of_a_sphere_is_its_distance_at_every_voxel) {
  const Vec3 center(0.3f, -0.2f, 5);
  for (const double voxel_size : {0.3, 0.1, 0.03}) {
    const SurfaceField field = build_field({center}, voxel_size, {.kind = SurfaceKind::spheres});
    const double cut = 3 * voxel_size;
    int checked = 0;
    for_each_voxel(field, [&](double distance, const Eigen::Vector3d& x) {
      const double exact = (x - center.cast<double>()).norm() - 0.55;
      ASSERT_NEAR(distance, std::clamp(exact, -cut, cut), 1e-5);
      ++checked;
    });
    EXPECT_GT(checked, 500);
  }
}

/// Zhu & Bridson's distance in double precision, over all particles; lengths in spacings.
class LiteralDistance {
 public:
  LiteralDistance(const std::vector<Vec3>& positions, double radius)
      : positions_(positions), radius_(radius) {
    double weight = 0, moment = 0;
    for (int layer = 0; 0.55 + layer < radius; ++layer) {
      const double w = std::pow(1 - (0.55 + layer) * (0.55 + layer) / (radius * radius), 4);
      weight += w;
      moment += w * layer;
    }
    extra_offset_ = moment / weight / radius;
    full_weight_ = 64 * std::numbers::pi / 315 * std::pow(radius, 3);
  }
  double operator()(const Eigen::Vector3d& x) const {
    double weight = 0, square = 0;
    Eigen::Vector3d mean(0, 0, 0);
    for (const Vec3& position : positions_) {
      const Eigen::Vector3d d = (position.cast<double>() - x) / radius_;
      const double w = std::pow(std::max(0.0, 1 - d.squaredNorm()), 3);
      weight += w;
      mean += w * d;
      square += w * d.squaredNorm();
    }
    if (weight < 0.02) return 99;
    mean /= weight;
    const double full = std::min(1.0, 2 * weight / full_weight_);
    const double excess = std::max(0.0, square / weight - mean.squaredNorm() - 0.0375 - 0.2625 * full);
    return radius_ * (std::sqrt(mean.squaredNorm() + 0.5 * excess) - 0.55 / radius_ - extra_offset_ * full);
  }

 private:
  const std::vector<Vec3>& positions_;
  double radius_, extra_offset_, full_weight_;
};

std::vector<Vec3> shaken_ball(float radius) {
  Body ball = sample(sphere_shape({0, 0, 0}, radius), {.spacing = 1.0f, .jitter = 0.3f});
  return ball.positions;
}

/// Probes at each voxel (0.45), sums at each (0.3), at every second (as few as are allowed at 0.219, 0.15)
/// and at every fourth one (0.08).
TEST(surface_field, near_the_surface_is_the_formula_of_its_source_also_where_sums_are_interpolated) {
  const std::vector<Vec3> positions = shaken_ball(4);
  const LiteralDistance literal(positions, 2);
  for (const double voxel_size : {0.45, 0.3, 0.219, 0.15, 0.08}) {
    const SurfaceField field = build_field(positions, voxel_size, {});
    double worst = 0, sum = 0;
    int checked = 0, k = 0;
    for_each_voxel(field, [&](double distance, const Eigen::Vector3d& x) {
      if (std::abs(distance) > voxel_size || ++k % 7 != 0) return;
      const double error = std::abs(distance - literal(x)) / voxel_size;
      worst = std::max(worst, error);
      sum += error;
      ++checked;
    });
    ASSERT_GT(checked, 100);
    EXPECT_LT(worst, voxel_size > 0.22 ? 1e-4 : 0.15) << voxel_size;
    EXPECT_LT(sum / checked, voxel_size > 0.22 ? 1e-5 : 0.02) << voxel_size;
  }
}

TEST(surface_field, blocks_without_distances_are_on_one_side) {
  const std::vector<Vec3> positions = shaken_ball(6);
  const LiteralDistance literal(positions, 2);
  const SurfaceField field = build_field(positions, 0.15, {});
  int inside = 0;
  for (std::uint32_t b = 0; b < field.blocks().size(); ++b) {
    if (field.kind(b) == BlockKind::surface) continue;
    inside += field.kind(b) == BlockKind::inside;
    for (const int corner : {0, 3, 7}) {
      const Eigen::Vector3d x =
          field.frame().origin +
          field.frame().voxel_size *
              (k_block_side * field.blocks().blocks()[b].cast<double>() + Eigen::Vector3d::Constant(corner));
      ASSERT_EQ(literal(x) < 0, field.kind(b) == BlockKind::inside);
    }
  }
  EXPECT_GT(inside, 20);
}

/// A body's field among particles far away, which move the cells of the search, and among others of its own.
TEST(surface_field, keeps_its_bits_whatever_is_far_away) {
  const std::vector<Vec3> ball = shaken_ball(4);
  for (const double voxel_size : {0.45, 0.3, 0.15, 0.08}) {
    for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::anisotropic, SurfaceKind::spheres}) {
      if (voxel_size == 0.08 && kind != SurfaceKind::blended) continue;
      std::vector<Vec3> more = ball;
      for (const Vec3& x : ball) more.emplace_back(0.7f * x + Vec3(40.3f, 31.1f, 7.7f));
      const SurfaceField alone = build_field(ball, voxel_size, {.kind = kind});
      const SurfaceField beside = build_field(more, voxel_size, {.kind = kind});
      std::map<std::array<int, 3>, std::uint32_t> numbers;
      for (std::uint32_t b = 0; b < beside.blocks().size(); ++b) {
        const BlockMap::Coord& at = beside.blocks().blocks()[b];
        numbers[{at.x(), at.y(), at.z()}] = b;
      }
      for (std::uint32_t b = 0; b < alone.blocks().size(); ++b) {
        const BlockMap::Coord& at = alone.blocks().blocks()[b];
        const auto other = numbers.find({at.x(), at.y(), at.z()});
        ASSERT_NE(other, numbers.end());
        ASSERT_EQ(alone.kind(b), beside.kind(other->second));
        if (alone.kind(b) != BlockKind::surface) continue;
        ASSERT_EQ(
            std::memcmp(alone.distances(b), beside.distances(other->second), k_block_voxels * sizeof(float)),
            0);
      }
    }
  }
}

TEST(surface_field, memory_follows_the_surface_and_not_the_box_around_it) {
  const SurfaceField near = build_field({{0, 0, 0}, {4, 0, 0}}, 0.25, {});
  const SurfaceField far = build_field({{0, 0, 0}, {40000, 30000, 20000}}, 0.25, {});
  EXPECT_LE(far.blocks().size(), 2 * near.blocks().size());
  EXPECT_LT(far.bytes(), near.bytes() + (1u << 19));  // the cells of the search, which are bounded
}

}  // namespace surface_field_test
}  // namespace mallow
