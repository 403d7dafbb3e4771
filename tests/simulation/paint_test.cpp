#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mallow/mallow.h"

namespace mallow {
namespace paint_test {

SolverConfig config(int threads = 2) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .threads = threads};
}

Body block(const Vec3& corner = {-3, -3, -3}) {
  return sample(Lattice{.count = {6, 6, 6}, .corner = corner});
}

float along_x(const Vec3& x) {
  return std::clamp((x.x() + 2.5f) / 5, 0.0f, 1.0f);
}

/// Alpha 0 at one side to 1 at the other, modulus 1.5 below and 0.5 above.
Body graded(Body body) {
  for (const Vec3& x : body.positions) {
    body.alpha.push_back(along_x(x));
    body.stiffness.push_back(x.z() < 0 ? 1.5f : 0.5f);
  }
  return body;
}

/// Turning, and shaken by a pattern of no symmetry.
Body stirred(Body body, float speed, float spin) {
  for (const Vec3& x : body.positions)
    body.velocities.push_back(Vec3(0, 0, spin).cross(x) + speed * Vec3(std::sin(x.y() + 2 * x.z()),
                                                                       std::cos(x.x()), std::sin(3 * x.x())));
  return body;
}

struct Motion {
  Eigen::Vector3d momentum{0, 0, 0}, spin{0, 0, 0};
  double size = 0;  ///< Σ |v|
};
Motion motion_of(const Simulation& s) {
  Motion m;
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.momentum += v[i].cast<double>();
    m.spin += x[i].cast<double>().cross(v[i].cast<double>());
    m.size += v[i].cast<double>().norm();
  }
  return m;
}

double largest_distance(const Simulation& a, const Simulation& b) {
  double largest = 0;
  const std::vector<Vec3> x = a.positions_by_id(), y = b.positions_by_id();
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, static_cast<double>((x[i] - y[i]).norm()));
  return largest;
}

TEST(paint, of_alpha_and_stiffness_keeps_momentum_and_spin) {
  Simulation s(config());
  s.add_body(stirred(graded(block()), 0.1f, 0.05f),
             {.update_threshold = 1e6f, .cohesion = 1.0f, .deformation_damping = 0.0f});
  const Motion before = motion_of(s);
  for (int c = 0; c < 1000; ++c) s.step();
  const Motion after = motion_of(s);
  EXPECT_LT((after.momentum - before.momentum).norm() / before.size, 1e-5);
  EXPECT_LT((after.spin - before.spin).norm() / before.spin.norm(), 1e-5);
}

TEST(paint, of_one_alpha_is_that_alpha) {
  for (const float alpha : {0.0f, 0.3f, 0.7f, 1.0f}) {
    const auto run = [&](bool painted) {
      SolverConfig c = config();
      c.gravity = {0, 0, -0.3f};
      Simulation s(c);
      Body body = block({-3, -3, 0.2f});
      if (painted) body.alpha.assign(body.positions.size(), alpha);
      s.add_body(body, {.alpha = painted ? 0.5f : alpha});
      s.add_collider({.shape = Plane{}});
      for (int k = 0; k < 40; ++k) s.step();
      return s;
    };
    EXPECT_LT(largest_distance(run(true), run(false)), 2e-4) << alpha;
  }
}

/// Half stiff, half fluid, dropped; checks of the reference shape fire; rows come, go and are sorted.
Simulation busy(int threads) {
  SolverConfig c = config(threads);
  c.gravity = {0, 0, -0.3f};
  c.update_period = 1.5f;
  Simulation s(c);
  const BodyId id = s.add_body(graded(block({-3, -3, 1})), {.update_threshold = 3.0f, .region_stride = 2});
  s.add_body(block({-3, -3, 8}), {.alpha = 0.4f});
  s.extend_body(id, block({4, -3, 1}));
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.advance(2);
  s.remove_particles(std::vector<ParticleId>{3, 4, 100, 230});
  s.set_alpha(std::vector<ParticleId>{440, 441, 442}, 1.0f);
  return s;
}

TEST(paint, gives_the_same_bits_for_any_thread_count_and_over_a_save) {
  Simulation one = busy(1), four = busy(4);
  Simulation restored = Simulation::restore(one.save(), 3);
  for (int k = 0; k < 40; ++k) {
    one.step();
    four.step();
    restored.step();
  }
  EXPECT_EQ(one.state_hash(), four.state_hash());
  EXPECT_EQ(one.state_hash(), restored.state_hash());
  EXPECT_EQ(one.alpha(441), 1.0f);
}

TEST(paint, goes_with_its_particles) {
  Simulation s = busy(2);
  s.advance(6);
  const std::span<const ParticleId> ids = s.ids();
  for (std::size_t row = 0; row < ids.size(); ++row) {
    const ParticleId id = ids[row];
    const float expected = id < 216                 ? along_x(block({-3, -3, 1}).positions[id])
                           : id < 432               ? 0.4f
                           : id >= 440 && id <= 442 ? 1.0f
                                                    : s.alphas()[row];
    EXPECT_EQ(s.alphas()[row], expected) << id;
    EXPECT_TRUE(id < 216 || s.stiffnesses()[row] == 1.0f);
  }
}

/// A shell of alpha 0 around a filling of alpha 1, and what the filling is without the shell.
TEST(paint, a_shell_holds_its_filling) {
  const auto height = [](bool shell) {
    SolverConfig c = config();
    c.gravity = {0, 0, -0.1f};
    Simulation s(c);
    Body body = sample(Lattice{.count = {10, 10, 10}, .corner = {-5, -5, 0}});
    for (const Vec3& x : body.positions) {
      const float deep = 5 - (x - Vec3(0, 0, 5)).cwiseAbs().maxCoeff();
      body.alpha.push_back(shell && deep < 2 ? 0.0f : 1.0f);
    }
    s.add_body(body, Material{});
    s.add_collider({.shape = Plane{}});
    s.advance(60);
    float top = 0;
    for (const Vec3& x : s.positions_by_id()) top = std::max(top, x.z());
    return top;
  };
  EXPECT_GT(height(true), 7);
  EXPECT_LT(height(false), 5);
}

TEST(paint, a_body_rests_anew_only_where_its_particles_yield) {
  SolverConfig c = config();
  c.gravity = {0, 0, -0.3f};
  c.update_period = 0.6f;
  Simulation s(c);
  Body body = block({-3, -3, 0});
  for (const Vec3& x : body.positions) body.alpha.push_back(x.x() > 0 ? 1.0f : 0.0f);
  const BodyId id = s.add_body(body, Material{});
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.prepare();
  const auto rest = [&](ParticleId p) { return Vec3(s.rest_position(p) - s.rest_position(0)); };
  std::vector<Vec3> before;
  for (ParticleId p = 0; p < 216; ++p) before.push_back(rest(p));
  s.advance(9);
  double moved = 0;
  for (ParticleId p = 0; p < 216; ++p) {
    const double way = (rest(p) - before[p]).cast<double>().norm();
    if (body.alpha[p] == 1.0f) moved = std::max(moved, way);
    EXPECT_TRUE(way < 1e-5 || body.alpha[p] == 1.0f) << p;
  }
  EXPECT_GT(moved, 1);
  EXPECT_TRUE(s.info().bodies[0].shape_matching);
  EXPECT_EQ(s.material(id), MaterialId{0});
}

TEST(paint, is_refused_where_it_is_out_of_range_or_too_stiff) {
  Simulation s(config());
  Body body = block();
  body.alpha = {0.5f};
  EXPECT_THROW(s.add_body(body, {}), ConfigError);
  body.alpha.assign(216, 1.5f);
  EXPECT_THROW(s.add_body(body, {}), ConfigError);
  body.alpha.clear();
  body.stiffness.assign(216, 3.0f);
  EXPECT_THROW(s.add_body(body, {}), ConfigError);
  body.alpha.assign(216, 0.5f);
  s.add_body(body, Material{});
  s.step();
  const std::uint64_t hash = s.state_hash();
  EXPECT_THROW(s.set_alpha(std::vector<ParticleId>{7}, 0.0f), ConfigError);
  EXPECT_THROW(s.set_alpha(std::vector<ParticleId>{7, 999}, 1.0f), ConfigError);
  EXPECT_EQ(s.alpha(7), 0.5f);
  EXPECT_EQ(s.state_hash(), hash);
}

/// Strain that stays in the left and the right half of a bar that was pulled to 1.2 of its length and let go.
std::array<double, 2> kept_strains(const Material& material, const Body& bar) {
  SolverConfig solver = config();
  solver.sleep_speed = 0.0f;
  Simulation s(solver);
  s.add_body(bar, material);
  s.pin(Aabb{{-1, -9, -9}, {3, 9, 9}}, {0, 0, 0});
  const PinId end = s.pin(Aabb{{33, -9, -9}, {37, 9, 9}}, {0, 0, 0});
  s.move_pin(end, {6, 0, 0}, 150);
  s.advance(200);
  s.unpin(end);
  s.advance(300);
  const std::vector<Vec3> now = s.positions_by_id();
  const auto mean_x = [&](float from, float to) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      if (bar.positions[i].x() > from && bar.positions[i].x() < to) sum += double{now[i].x()}, ++count;
    return sum / count;
  };
  const auto strain = [&](float from) {
    return (mean_x(from + 8, from + 10) - mean_x(from, from + 2)) / 8 - 1;
  };
  return {strain(6), strain(20)};
}

Body bar_of(std::vector<float> Body::*column, float left, float right) {
  Body bar = sample(Lattice{.count = {36, 6, 6}});
  for (const Vec3& x : bar.positions) (bar.*column).push_back(x.x() < 18 ? left : right);
  return bar;
}

TEST(paint, of_yield_lets_flow_what_yields_less_and_no_more) {
  const Material material{.plastic_yield = 0.05f, .damping_time = 0.1f};
  const auto [left, right] = kept_strains(material, bar_of(&Body::plastic_yield, 0.05f, 1000.0f));
  EXPECT_GT(left, 0.05);
  EXPECT_NEAR(right, 0, 0.005);
  Simulation s(config());
  EXPECT_THROW(s.add_body(bar_of(&Body::plastic_yield, 0.05f, 1.0f), Material{}), ConfigError)
      << "nothing flows in it";
}

TEST(paint, of_temperature_lets_flow_what_is_warm) {
  const Material material{.plastic_yield_by_temperature = Schedule{{300, 1000}, {310, 0.05f}},
                          .damping_time = 0.1f,
                          .temperature = 300.0f};
  const auto [left, right] = kept_strains(material, bar_of(&Body::temperature, 320, 295));
  EXPECT_GT(left, 0.05);
  EXPECT_NEAR(right, 0, 0.005);
}

TEST(paint, of_yield_goes_on_with_the_same_bits_after_a_restore) {
  const auto start = [] {
    Simulation s(config());
    s.add_body(stirred(bar_of(&Body::plastic_yield, 0.01f, 1000.0f), 0.5f, 0.02f),
               {.plastic_yield = 0.02f, .plastic_creep = 0.5f});
    return s;
  };
  Simulation whole = start(), part = start();
  for (int k = 0; k < 120; ++k) whole.step();
  for (int k = 0; k < 70; ++k) part.step();
  Simulation rest = Simulation::restore(part.save(), 1);
  for (int k = 0; k < 50; ++k) rest.step();
  EXPECT_EQ(whole.state_hash(), rest.state_hash());
}

}  // namespace paint_test
}  // namespace mallow
