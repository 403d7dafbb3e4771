// Colliders that turn far in a step: what they never reach they leave alone, what they sweep they take along.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "colliders/one_row.h"
#include "colliders/pose.h"
#include "core/column.h"
#include "mallow/body.h"
#include "mallow/simulation.h"
#include "shapes/random_points.h"

namespace mallow {
namespace far_turn_test {

constexpr float k_offset = 0.05f;
constexpr ContactStep k_step{.time_step = 0.0083f,
                             .max_push = 1,
                             .contact_offset = k_offset,
                             .gravity = {0, 0, -10},
                             .least_bounce = 0.2f};
const float k_rates[] = {20, 50, 200, 370, 400, 500, 550, 700, 760, 1000, 2000, 5000};

/// What the shape sweeps as it turns about z is a cylinder of radius √1.25 between z = -1 and 1.
const float k_radius = std::sqrt(1.25f);
const Box k_box{{-0.5f, -1, -1}, {0.5f, 1, 1}};

std::vector<std::pair<std::string, Collider::Shape>> shapes() {
  const DistanceFunction distance = [](const Vec3& x) { return nearest(k_box, x).distance; };
  std::vector<Vec3> corners, rim;
  for (unsigned k = 0; k < 8; ++k)
    corners.emplace_back((k & 1) != 0 ? 0.5f : -0.5f, (k & 2) != 0 ? 1.0f : -1.0f,
                         (k & 4) != 0 ? 1.0f : -1.0f);
  for (int k = 0; k < 24; ++k)
    for (const float z : {-0.03f, 0.03f}) {
      const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 12;
      rim.emplace_back(k_radius * std::cos(angle), k_radius * std::sin(angle), z);
    }
  return {{"box", k_box},
          {"hull", convex_hull(corners)},
          {"saw", convex_hull(rim)},
          {"field", distance_field({distance, {k_box.min, k_box.max}}, 0.1f)},
          {"union", Union{{k_box, Sphere{{0.9f, 0, 0}, 0.2f}}}}};
}

/// Beside the saw by 0.6% of its radius at least: half is what is left of the sagitta, half how near to a
/// shape a way is near enough. And above it.
std::vector<Vec3> untouched_places() {
  std::vector<Vec3> places;
  const float margin = 0.006f * k_radius;
  for (const float beside : {margin, 0.01f, 0.1f, 0.38f, 1.0f, 5.0f})
    for (int k = 0; k < 16; ++k) {
      const float angle = 0.4f * static_cast<float>(k), far = k_radius + k_offset + beside;
      places.emplace_back(far * std::cos(angle), far * std::sin(angle), 0.06f * static_cast<float>(k) - 0.5f);
      places.emplace_back(0.07f * far * static_cast<float>(k), 0.0f, 1 + k_offset + beside);
    }
  return places;
}

Collider turning(const Collider::Shape& shape, float rate) {
  Collider collider{.shape = shape, .angular_velocity = {0, 0, rate}, .restitution = 0.5f, .friction = 0.5f};
  collider.pose = pose_of({0, 0, 0}, {0, 0, 20});
  return collider;
}

TEST(far_turn, leaves_what_is_beside_it_alone) {
  for (const auto& [name, shape] : shapes())
    for (const float rate : k_rates)
      for (const float way_round : {1.0f, -1.0f})
        for (const Vec3& x : untouched_places()) {
          const Vec3 rests(0, 0, 0),
              v = resolve_one_row(turning(shape, way_round * rate), k_step, x, rests, rests);
          ASSERT_EQ(v, rests) << name << ", " << rate << " rad/s, at " << x.transpose();
        }
}

TEST(far_turn, leaves_what_goes_along_with_it_alone) {
  const Vec3 moves(30, -20, 10);
  for (const auto& [name, shape] : shapes())
    for (const float rate : k_rates)
      for (const Vec3& x : untouched_places()) {
        Collider collider = turning(shape, rate);
        collider.velocity = moves;
        ASSERT_EQ(resolve_one_row(collider, k_step, x, moves, moves), moves)
            << name << ", " << rate << " rad/s, at " << x.transpose();
      }
}

TEST(far_turn, leaves_what_it_comes_near_to_in_the_step_alone) {
  for (const auto& [name, shape] : shapes())
    for (const float rate : k_rates) {
      Collider collider = turning(shape, rate);
      collider.velocity = {40, 0, 0};
      const float ends = k_step.time_step * 40 + k_radius + k_offset;
      for (const float y : {-0.8f, -0.2f, 0.0f, 0.5f})
        ASSERT_EQ(resolve_one_row(collider, k_step, {ends + 0.01f, y, 0}, {0, 0, 0}, {0, 0, 0}),
                  Vec3(0, 0, 0))
            << name << ", " << rate << " rad/s, at " << y;
    }
}

/// A blade from the axis along x that turns counterclockwise.
Collider blade(float turn) {
  return {.shape = Box{{0, -0.01f, -1}, {2, 0.01f, 1}}, .angular_velocity = {0, 0, turn / k_step.time_step}};
}

Vec3 end_of(const Collider& collider, const Vec3& x, const Vec3& v = {0, 0, 0}) {
  return x + k_step.time_step * resolve_one_row(collider, k_step, x, v, v);
}

TEST(far_turn, takes_what_it_sweeps_along_to_the_side_that_came_first) {
  for (const float turn : {0.5f, 1.0f, 2.0f, 3.0f})
    for (const float share : {0.3f, 0.5f, 0.7f, 0.95f})
      for (const float far : {0.4f, 1.0f, 1.5f}) {
        const float angle = share * turn;
        const Vec3 x(far * std::cos(angle), far * std::sin(angle), 0), end = end_of(blade(turn), x);
        // In the frame of the blade as it ends; what has left it along itself has gone on beyond its tip.
        const Vec3 seen = Eigen::AngleAxisf(-turn, Vec3::UnitZ()) * end;
        if (seen.x() < 2 && seen.x() > 0) {
          EXPECT_GT(seen.y(), 0.01f + 0.99f * k_offset) << turn << ", " << angle;
        }
        EXPECT_GT(seen.x(), 0.5f * far) << turn << ", " << angle << ", " << far;
        EXPECT_LT(end.norm(), 1.2f * far * std::cosh(turn)) << turn << ", " << angle << ", " << far;
      }
}

TEST(far_turn, leaves_what_is_behind_it_alone) {
  for (const float turn : {0.5f, 1.0f, 2.0f, 3.0f, 4.5f, 6.0f})
    for (const float share : {0.1f, 0.5f, 0.9f}) {
      // Between where the blade ends and where it began.
      const float gap = 0.1f, free = 2 * std::numbers::pi_v<float> - turn - 2 * gap;
      const float angle = turn + gap + share * free, far = 1.5f;
      const Vec3 x(far * std::cos(angle), far * std::sin(angle), 0);
      EXPECT_EQ(end_of(blade(turn), x), x) << turn << ", " << angle;
    }
}

TEST(far_turn, meets_all_around_it_however_many_times_it_turns) {
  for (const float turn : {6.3f, 7.0f, 12.0f, 13.0f, 41.0f, 1e4f, 1e7f})
    for (int k = 0; k < 20; ++k) {
      const float angle = 0.3f * static_cast<float>(k) + 0.1f;
      const Vec3 x(1.5f * std::cos(angle), 1.5f * std::sin(angle), 0), end = end_of(blade(turn), x);
      EXPECT_NE(end, x) << turn << ", " << angle;
      // Two turns at the speed of the tip, no more.
      EXPECT_LT((end - x).norm(), 1.2f * 4 * std::numbers::pi_v<float> * 2) << turn << ", " << angle;
    }
}

/// In one step as in a hundred, each of which turns so little that it is met as a whole.
TEST(far_turn, ends_near_where_short_steps_end) {
  constexpr int k_steps = 100;
  ContactStep part = k_step;
  part.time_step /= k_steps;
  for (const float friction : {0.0f, 0.5f})
    for (const float turn : {0.3f, 1.0f, 2.0f}) {
      Collider collider = blade(turn);
      collider.friction = friction;
      collider.velocity = {5, 0, 0};
      int met = 0;
      for (const Vec3& x : random_points(200, Vec3(-2, -2, -0.5f), Vec3(2, 2, 0.5f))) {
        if (nearest(collider, x).distance < k_offset || x.head<2>().norm() < 0.3f) continue;
        const Vec3 end = end_of(collider, x);
        Vec3 at = x, v(0, 0, 0);
        Collider moves = collider;
        for (int k = 0; k < k_steps; ++k) {
          v = resolve_one_row(moves, part, at, v, v);
          at += part.time_step * v;
          move_colliders(0, static_cast<double>(part.time_step), {&moves, 1});
        }
        EXPECT_LT((end - at).norm(), 0.02f + 0.2f * (at - x).norm())
            << turn << " rad, from " << x.transpose() << " to " << at.transpose() << ", not "
            << end.transpose();
        met += end != x;
      }
      EXPECT_GT(met, 5) << turn;
    }
}

TEST(far_turn, is_cut_into_pieces_that_end_where_it_ends_and_a_short_one_is_not) {
  const auto pieces_of = [](double turn) {
    Collider collider{.shape = k_box, .velocity = {3, 2, 1}, .angular_velocity = {1, -2, 0.5f}};
    collider.pose = pose_of({1, 2, 3}, {10, 20, 30});
    collider.angular_velocity *=
        static_cast<float>(turn) / (collider.angular_velocity.norm() * k_step.time_step);
    std::vector<PlacedCollider> placed;
    place_colliders({&collider, 1}, {0, 0, 0}, k_step.time_step, InstructionLevel::baseline, placed);
    using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    if (!placed[0].pieces.empty()) {
      EXPECT_LT((Eigen::Map<const RowMajor>(placed[0].pieces.back().turned) -
                 Eigen::Map<const RowMajor>(placed[0].surface.turned))
                    .norm(),
                1e-5f)
          << turn;
      for (std::size_t k = 1; k < placed[0].pieces.size(); ++k)
        EXPECT_TRUE(std::equal(placed[0].pieces[k].rotation, placed[0].pieces[k].rotation + 9,
                               placed[0].pieces[k - 1].turned));
    }
    return placed[0].pieces.size();
  };
  EXPECT_EQ(pieces_of(0), 0u);
  EXPECT_EQ(pieces_of(0.99 * k_most_turn), 0u);
  EXPECT_EQ(pieces_of(1.01 * k_most_turn), 2u);
  EXPECT_EQ(pieces_of(9.9 * k_most_turn), 10u);
  for (const double turn : {6.0, 12.5, 12.6, 41.0, 1e3, 1e9}) EXPECT_LE(pieces_of(turn), 84u) << turn;
}

Simulation cube_beside_a_saw(float rate, float x, int threads) {
  Simulation s({.time_step = .0083f, .support_radius = .21f, .gravity = {0, 0, 0}, .threads = threads});
  s.add_body(sample(Lattice{.count = {6, 6, 10}, .spacing = .1f}),
             {.alpha = .2f, .youngs_modulus = 5e4f, .rest_density = 1000.f});
  s.add_collider({.shape = k_box, .pose = {.translation = {x, .2, .2}}, .angular_velocity = {0, 0, rate}});
  return s;
}

TEST(far_turn, throws_no_body_beside_it) {
  for (const float rate : k_rates) {
    Simulation s = cube_beside_a_saw(rate, -1.5f, 1);
    for (int i = 0; i < 20; ++i) s.step();
    EXPECT_LT(s.velocities().eigen().rowwise().norm().maxCoeff(), 1) << rate;
  }
}

TEST(far_turn, has_the_same_bits_for_any_number_of_threads) {
  for (const float rate : {50.f, 400.f}) {
    Simulation one = cube_beside_a_saw(rate, -1.0f, 1), three = cube_beside_a_saw(rate, -1.0f, 3);
    for (int i = 0; i < 5; ++i) {
      one.step();
      three.step();
    }
    EXPECT_GT(one.velocities().eigen().rowwise().norm().maxCoeff(), 1) << rate;
    EXPECT_EQ(one.state_hash(), three.state_hash()) << rate;
  }
}

}  // namespace far_turn_test
}  // namespace mallow
