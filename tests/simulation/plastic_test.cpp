// Matter that flows where it is strained: model 2, section 5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "mallow/errors.h"
#include "mallow/saved_state.h"
#include "mallow/simulation.h"

namespace mallow {
namespace plastic_test {

using Vec = Eigen::Vector3d;

/// Flow alone: iterations that keep volumes leave 3e-4 of a stretch below yield.
SolverConfig solver(float update_period = 9.0f, int threads = 2) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, 0},
          .update_period = update_period,
          .volume_iterations = 0,
          .sleep_speed = 0.0f,
          .threads = threads};
}
Material dough(float yield = 0.1f, float alpha = 0.0f) {
  return {.alpha = alpha, .plastic_yield = yield, .damping_time = 0.1f, .deformation_damping = 0.0f};
}
int run(Simulation& s, int steps) {
  int updates = 0;
  for (int k = 0; k < steps; ++k) updates += s.step().updated_references;
  return updates;
}

/// Strain along one axis at which |Ê − I| is this.
double uniaxial(double yield) {
  double strain = 0;
  const auto size = [](double e) {
    const double along = std::pow(1 + e, 2.0 / 3) - 1, across = std::pow(1 + e, -1.0 / 3) - 1;
    return std::sqrt(along * along + 2 * across * across);
  };
  while (size(strain) < yield) strain += 1e-6;
  return strain;
}

/// A bar along x that is held at both ends.
class Bar {
 public:
  static constexpr float k_length = 36, k_held = 3;
  explicit Bar(const Material& material, int threads = 2) : material_(material), s(solver(9, threads)) {
    const Body body = sample(Lattice{.count = {36, 6, 6}});
    s.add_body(body, material);
    for (const Vec3& x : body.positions) rest_.push_back(static_cast<double>(x.x()));
    left_ = s.pin(Aabb{{-1, -9, -9}, {k_held, 9, 9}}, {0, 0, 0});
    right_ = s.pin(Aabb{{k_length - k_held, -9, -9}, {k_length + 1, 9, 9}}, {0, 0, 0});
  }
  /// Moves the right end, slowly.
  void pull(double way) {
    const int steps = static_cast<int>(std::abs(way) / 0.003) + 1;
    s.move_pin(right_, {static_cast<float>(way), 0, 0}, 0.15 * steps);
    run(s, steps);
  }
  /// Lets go, and waits until it lies still.
  void release() {
    material_.deformation_damping = 2.0f;
    s.set_material(MaterialId{0}, material_);
    s.unpin(left_);
    s.unpin(right_);
    run(s, 1500);
  }
  /// Of its middle, least squares.
  double stretch() const {
    const std::vector<Vec3> x = s.positions_by_id();
    double n = 0, a = 0, b = 0, aa = 0, ab = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::abs(rest_[i] - 18) > 7) continue;
      const double r = rest_[i], now = static_cast<double>(x[i].x());
      n += 1, a += r, b += now, aa += r * r, ab += r * now;
    }
    return (n * ab - a * b) / (n * aa - a * a);
  }

 private:
  Material material_;
  std::vector<double> rest_;
  PinId left_{}, right_{};

 public:
  Simulation s;
};

// What is left is the stretch over that which it bears: 0.158, 0.425 and 0.782 at yield 0.1 where the middle
// is stretched to 1.30, 1.60 and 2.0 as the ends are.
TEST(plastic, a_bar_that_is_stretched_keeps_what_is_beyond_yield) {
  for (const double to : {1.3, 1.6, 2.0}) {
    Bar bar(dough());
    for (int k = 0; k < 30 && bar.stretch() < to; ++k)
      bar.pull(std::max(0.02, 0.9 * 30 * (to - bar.stretch())));
    run(bar.s, 100);
    const double held = bar.stretch(), elastic = uniaxial(0.1);
    EXPECT_NEAR(held, to, 0.02 * to);
    bar.release();
    const double expected = held / (1 + elastic) - 1;
    EXPECT_NEAR(bar.stretch() - 1, expected, 0.05 * expected) << to;
  }
}

TEST(plastic, below_yield_nothing_stays_after_six_cycles) {
  Bar bar(dough());
  for (int cycle = 0; cycle < 6; ++cycle) {
    bar.pull(0.09 * 30);
    bar.pull(-0.09 * 30);
  }
  EXPECT_GT(uniaxial(0.1), 0.12);
  bar.release();
  EXPECT_NEAR(bar.stretch(), 1, 1e-4);
}

/// Least and largest strain between neighbouring layers of a bar along x.
std::pair<double, double> layer_strains(const Simulation& s, const Body& rest, std::size_t layers) {
  std::vector<double> middle(layers, 0);
  const std::vector<Vec3> x = s.positions_by_id();
  for (std::size_t i = 0; i < x.size(); ++i)
    middle[static_cast<std::size_t>(rest.positions[i].x())] +=
        static_cast<double>(x[i].x()) * static_cast<double>(layers) / static_cast<double>(x.size());
  double least = 9, most = -9;
  for (std::size_t k = 1; k < layers; ++k) {
    least = std::min(least, middle[k] - middle[k - 1] - 1);
    most = std::max(most, middle[k] - middle[k - 1] - 1);
  }
  return {least, most};
}

TEST(plastic, ten_thousand_reversals_at_four_fifths_of_yield_leave_nothing) {
  constexpr int k_reversals = 10000, k_steps = 12;
  constexpr std::size_t k_layers = 8;
  Simulation s(solver(3, 1));
  const Body body = sample(Lattice{.count = {k_layers, 4, 4}, .jitter = 0});
  s.add_body(body, dough());
  const PinId left = s.pin(Aabb{{-1, -1, -1}, {2, 5, 5}}, {0, 0, 0});
  const PinId right = s.pin(Aabb{{6, -1, -1}, {9, 5, 5}}, {0, 0, 0});
  const auto way = static_cast<float>(0.68 * uniaxial(0.1) * 5);
  const auto load = [&](float by) {
    s.move_pin(right, {by, 0, 0}, 0.15 * k_steps);
    return run(s, k_steps);
  };
  double least = 0, most = 0;
  int updates = load(way);
  for (int k = 0; k < k_reversals; ++k) {
    if (k % 100 < 2) {
      const auto [low, high] = layer_strains(s, body, k_layers);
      least = std::min(least, low), most = std::max(most, high);
    }
    updates += load(k % 2 == 0 ? -2 * way : 2 * way);
  }
  // With what swings beside: the ends alone strain it by 0.68.
  EXPECT_NEAR(most / uniaxial(0.1), 0.8, 0.05);
  EXPECT_NEAR(least / -uniaxial(0.1), 0.8, 0.05);
  EXPECT_EQ(updates, 0);
  s.unpin(left);
  s.unpin(right);
  Material still = dough();
  still.deformation_damping = 2.0f;
  s.set_material(MaterialId{0}, still);
  run(s, 2000);
  const std::vector<Vec3> x = s.positions_by_id();
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT((x[i] - x[0] - (body.positions[i] - body.positions[0])).norm(), 1e-4f) << i;
}

/// A ball pressed 2.5 h into a block of 12³ that is held below, and lifted.
struct Dent {
  double kept = 0;      ///< of the depth [h]
  double far = 0;       ///< how far the layer above what is held has sunk in the mean [h]
  double farthest = 0;  ///< how far that of its particles has moved that has moved most [h]
};
Dent dent(const Material& material, int volume_iterations = 0) {
  SolverConfig config = solver();
  config.volume_iterations = volume_iterations;
  Simulation s(config);
  const Body body = sample(Lattice{.count = {12, 12, 12}});
  s.add_body(body, material);
  s.pin(Aabb{{-1, -1, -1}, {13, 13, 1}}, {0, 0, 0});
  const ColliderId ball = s.add_collider({.shape = Sphere{{0, 0, 0}, 4.0f}, .friction = 0.3f});
  s.set_pose(ball, Pose{.translation = {6, 6, 16}});
  s.set_pose(ball, Pose{.translation = {6, 6, 13.5}}, 30);
  run(s, 300);
  s.set_pose(ball, Pose{.translation = {6, 6, 19}}, 60);
  run(s, 1200);
  const std::vector<Vec3> x = s.positions_by_id();
  Dent result;
  int top = 0, low = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 rest = body.positions[i];
    const double sunk = static_cast<double>(rest.z() - x[i].z());
    if (rest.z() > 11 && std::hypot(rest.x() - 6, rest.y() - 6) < 1.2f) result.kept += sunk, ++top;
    if (rest.z() < 1 || rest.z() > 2) continue;
    result.far += sunk, ++low;
    result.farthest = std::max(result.farthest, static_cast<double>((x[i] - rest).norm()));
  }
  return {result.kept / top, std::abs(result.far / low), result.farthest};
}
// The far side is the layer above the one that is held, which cannot move. Its mean is within 0.03 h, a
// single particle of it is not (bench/PHYSICS.md).
TEST(plastic, a_dent_stays_and_does_not_reach_the_far_side) {
  const Dent result = dent(dough(0.1f)), filled = dent(dough(0.1f), 2);
  EXPECT_NEAR(result.kept, 1.48, 0.02);
  EXPECT_NEAR(filled.kept, 1.48, 0.02);
  EXPECT_LT(result.far, 0.01);
  EXPECT_LT(filled.far, 0.015);
  EXPECT_LT(result.farthest, 0.04);
  EXPECT_LT(filled.farthest, 0.07);
}

TEST(plastic, a_yield_of_0_15_gives_half_of_a_dent_back) {
  for (const int volume_iterations : {0, 2})
    EXPECT_NEAR(dent(dough(0.15f), volume_iterations).kept, 1.25, 0.1) << volume_iterations;
}

TEST(plastic, what_creeps_slowly_keeps_less_of_a_short_load) {
  Material slow = dough(0.05f);
  slow.plastic_creep = 0.02f;
  EXPECT_LT(dent(slow).kept, 0.75 * dent(dough(0.05f)).kept);
}

/// A free bar that is bent and twisted so fast that it flows and gets new frames.
Simulation thrown(float alpha, int threads = 2) {
  Simulation s(solver(1.5f, threads));
  Body body = sample(Lattice{.count = {12, 5, 5}, .corner = {-6, -2.5f, -2.5f}});
  for (const Vec3& x : body.positions)
    body.velocities.push_back(4 * Vec3(0, 0.6f * std::sin(0.3f * x.x()), 0.025f * x.x() * x.x()));
  Material material = dough(0.02f, alpha);
  material.damping_time = 0;
  s.add_body(body, material);
  return s;
}
struct Moments {
  Vec momentum{0, 0, 0}, spin{0, 0, 0};
  double speeds = 0, turns = 0;
};
Moments moments(const Simulation& s) {
  Moments m;
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec p = x[i].cast<double>(), u = v[i].cast<double>();
    m.momentum += u;
    m.spin += p.cross(u);
    m.speeds += u.norm();
    m.turns += p.norm() * u.norm();
  }
  return m;
}

TEST(plastic, new_frames_keep_momentum_and_spin_and_never_add_energy) {
  Simulation s = thrown(0.0f);
  s.prepare();
  const Moments before = moments(s);
  s.step();
  const double first = s.energy().conserved;
  int frames = 0;
  for (int k = 1; k < 150; ++k) {
    const Energy last = s.energy();
    const int updates = s.step().updated_references;
    const Energy now = s.energy();
    frames += updates;
    EXPECT_LT(now.conserved, 1.0005 * first) << k;
    if (updates == 0) continue;
    EXPECT_LT(now.conserved, last.conserved) << k;
    EXPECT_NEAR(now.kinetic / last.kinetic, 1, 0.05) << k;
  }
  EXPECT_GE(frames, 2);
  const Moments after = moments(s);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-5 * before.speeds);
  EXPECT_LT((after.spin - before.spin).norm(), 1e-5 * before.turns);
}

// What a fall crushed has more particles in its new regions, and they are farther off: by the same strain
// these pulled up to three times as hard, and threw the body up again.
TEST(plastic, new_frames_of_what_a_fall_crushed_add_no_energy) {
  for (const float alpha : {0.0f, 0.9f})
    for (const std::optional<int> iterations : {std::optional<int>{}, std::optional<int>{0}}) {
      SCOPED_TRACE(alpha);
      Simulation s({.gravity = {0, 0, -9.81f}, .volume_iterations = iterations, .threads = 2});
      s.add_collider({.shape = Plane{}, .friction = 0.5f});
      s.add_body(sample(Lattice{.count = {7, 7, 7}, .spacing = 0.12f, .corner = {0, 0, 0.96f}}),
                 {.alpha = alpha,
                  .plastic_yield = 0.1f,
                  .plastic_creep = 20.0f,
                  .youngs_modulus = 8e4f,
                  .rest_density = 1000.0f});
      const double start = s.energy().conserved;
      int frames = 0;
      for (double last = start; s.time() < 2;) {
        const int updates = s.step().updated_references;
        const double now = s.energy().conserved;
        if (updates > 0) {
          EXPECT_LT(now, last + 1e-3 * start) << s.time();
        }
        frames += updates;
        last = now;
      }
      EXPECT_GE(frames, 1);
    }
}

// A soft block that a fall crushes flat, with a new frame every few steps: G has a determinant of 1, and what
// regions lost in height they got in width, to 2.2 times the energy of the whole (`mallow-bench stability
// --hypercube 1000`, number 886).
TEST(plastic, what_is_crushed_gains_nothing_by_flow) {
  SolverConfig config = solver();
  config.time_step_factor = 0.78f;
  config.support_radius = 2.436f;
  config.gravity = {0, 0, -0.3f};
  config.update_period.reset();
  config.update_interval = 3;
  config.volume_iterations = 4;
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  Body body = sample(Lattice{.count = {6, 5, 5}, .corner = {0, 0, 2}, .jitter = 0});
  const auto wave = [](float x) { return 1.1f * std::sin(1.2566f * x); };
  for (const Vec3& x : body.positions) body.velocities.emplace_back(wave(x.y()), wave(x.z()), wave(x.x()));
  s.add_body(body, {.alpha = 0.5f,
                    .plastic_yield = 0.013f,
                    .plastic_creep = 43.0f,
                    .pressure_coefficient = 500.0f,
                    .viscosity = 0.19f,
                    .youngs_modulus = 4.4f,
                    .damping_time = 0.31f,
                    .deformation_damping = 0.085f});
  s.step();
  const double first = s.energy().conserved;
  for (int k = 0; k < 150; ++k) {
    s.step();
    ASSERT_LT(s.energy().conserved, first) << k;
  }
}

TEST(plastic, same_bits_for_any_thread_count_and_over_saved_states) {
  for (const float alpha : {0.0f, 0.3f}) {
    Simulation one = thrown(alpha, 1);
    int frames = run(one, 40);
    Simulation restored = Simulation::restore(one.save(), 3);
    frames += run(one, 110);
    EXPECT_GE(frames, 2);
    run(restored, 110);
    EXPECT_EQ(restored.state_hash(), one.state_hash());
    for (const int threads : {2, 3}) {
      Simulation many = thrown(alpha, threads);
      run(many, 150);
      EXPECT_EQ(many.state_hash(), one.state_hash()) << threads;
    }
  }
}

TEST(plastic, same_bits_at_any_instruction_level) {
  std::vector<std::uint64_t> hashes;
  for (const InstructionLevel level : {InstructionLevel::baseline, best_instruction_level()}) {
    SolverConfig config = solver(1.5f);
    config.instruction_level = level;
    Simulation s(config);
    Body body = sample(Lattice{.count = {7, 7, 7}});
    for (const Vec3& x : body.positions) body.velocities.push_back(Vec3(x.y() - 3, 3 - x.x(), 0.5f * x.x()));
    s.add_body(body, dough(0.02f));
    run(s, 60);
    hashes.push_back(s.state_hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(plastic, regions_are_solved_the_same_without_newtons_method) {
  std::vector<std::vector<Vec3>> ends;
  for (const int iterations : {0, 8}) {
    SolverConfig config = solver();
    config.rotation_iterations = iterations;
    Simulation s(config);
    Body body = sample(Lattice{.count = {6, 6, 6}});
    for (const Vec3& x : body.positions) body.velocities.push_back(0.3f * Vec3(x.y() - 3, 0, 0));
    s.add_body(body, dough(0.05f));
    run(s, 40);
    ends.push_back(s.positions_by_id());
  }
  for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_LT((ends[0][i] - ends[1][i]).norm(), 1e-3f);
}

TEST(plastic, a_strand_of_it_grows_and_can_be_cut_off) {
  SolverConfig config = solver(3);
  config.gravity = {0, 0, -0.3f};
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.8f});
  s.add_material(dough(0.05f));
  s.add_emitter({.radius = 2.0f,
                 .pose = {.translation = {0, 0, 9}, .rotation = {0, 1, 0, 0}},
                 .speed = 0.8f,
                 .most_particles = 600},
                MaterialId{0});
  int updates = run(s, 250);
  Simulation restored = Simulation::restore(s.save(), 1);
  s.remove_particles(Aabb{{-20, -20, 4}, {20, 20, 5}});
  updates += run(s, 100);
  EXPECT_GE(updates, 1);
  for (const Vec3& x : s.positions_by_id()) {
    ASSERT_TRUE(x.allFinite());
    ASSERT_GT(x.z(), 0.4f);
  }
  restored.remove_particles(Aabb{{-20, -20, 4}, {20, 20, 5}});
  run(restored, 100);
  EXPECT_EQ(restored.state_hash(), s.state_hash());
}

TEST(plastic, creep_without_yield_is_refused) {
  Simulation s(solver());
  try {
    s.add_material({.plastic_creep = 1.0f});
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("material.plastic_creep"), std::string::npos) << error.what();
  }
}

TEST(plastic, warns_where_nothing_can_flow) {
  const auto warns = [](const Material& material, std::array<int, 3> count) {
    Simulation s(solver());
    s.add_body(sample(Lattice{.count = count, .jitter = 0}), material);
    const std::vector<std::string> warnings = s.info().warnings;
    return std::ranges::any_of(warnings,
                               [](const std::string& w) { return w.find("plastic_yield") != w.npos; });
  };
  EXPECT_TRUE(warns(dough(0.1f, 1.0f), {4, 4, 4}));
  EXPECT_TRUE(warns(dough(), {8, 8, 1}));
  EXPECT_FALSE(warns(dough(), {8, 8, 2}));
}

/// A cube dropped from so many spacings: twice its centre at the end, and how often it yielded.
struct Fallen {
  double height = 0;
  int updates = 0;
};
Fallen fall(float drop, const SolverConfig& config) {
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {0, 0, drop}, .jitter = 0.1f}),
             Material{.alpha = 0.7f, .update_threshold = 6.0f});
  Fallen fallen{.updates = run(s, 600)};
  for (const Vec3& x : s.positions_by_id()) fallen.height += 2 * static_cast<double>(x.z()) / 512;
  return fallen;
}
constexpr float k_drops[] = {10.0f, 10.2f, 10.4f, 10.5f, 10.6f, 10.8f, 11.0f};

TEST(update_rule, judges_the_hardest_blow_since_the_last_check) {
  SolverConfig config = solver(9);
  config.gravity = {0, 0, -0.3f};
  std::map<float, double> heights;
  for (const float drop : k_drops) {
    const Fallen fallen = fall(drop, config);
    EXPECT_GT(fallen.updates, 0) << drop;
    heights[drop] = fallen.height;
  }
  // Drops of 10.5 and 11 differ by 3.4%, neighbours by up to 8.8: in which of the blows it yields again is
  // luck (bench/PHYSICS.md).
  EXPECT_NEAR(heights[10.5f] / heights[11.0f], 1, 0.035);
  for (std::size_t k = 1; k < std::size(k_drops); ++k)
    EXPECT_NEAR(heights[k_drops[k]] / heights[k_drops[k - 1]], 1, 0.09) << k_drops[k];
}

// As the paper has it, which Table 1 keeps: what hits between two checks is not judged. With steps of another
// length there is no step "before the check", and the largest mean of the interval counts.
TEST(update_rule, judges_one_step_of_an_interval_that_is_given_in_steps) {
  SolverConfig config = solver(9);
  config.gravity = {0, 0, -0.3f};
  config.update_period.reset();
  config.update_interval = 60;
  EXPECT_EQ(fall(10.5f, config).updates, 0);
  EXPECT_EQ(fall(10.6f, config).updates, 1);
  config.time_step_factor = 0.99f;
  for (const float drop : k_drops) EXPECT_GT(fall(drop, config).updates, 0) << drop;
}

// What it rested in before it melted is not what it rests in after: it sprang apart at 1.5 m/s, in metres.
TEST(plastic, what_has_melted_sets_where_it_is) {
  Simulation s({.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .update_period = 1.5f});
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  s.add_body(sample(Lattice{.count = {8, 8, 8}}),
             {.alpha = {{0.0f, 0.0f}, {3.0f, 1.0f}, {40.0f, 1.0f}, {45.0f, 0.0f}}, .plastic_yield = 0.08f});
  s.advance(40);
  const Aabb puddle = s.bounds(s.bodies()[0]);
  double fastest = 0;
  while (s.time() < 120) {
    s.step();
    if (s.time() > 45) fastest = std::max(fastest, std::sqrt(2 * s.energy().kinetic / 512));
  }
  EXPECT_LT(fastest, 0.1);  // 0.78 when it did
  EXPECT_LT(s.bounds(s.bodies()[0]).max.x() - puddle.max.x(), 1.5f);
}

}  // namespace plastic_test
}  // namespace mallow
