#include "mallow/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "contact/cubes.h"
#include "mallow/errors.h"

namespace mallow {
namespace body_contact_test {

using namespace contact_tests;

TEST(body_contact, cubes_stand_on_each_other) {
  for (const float alpha : {0.0f, 0.3f}) {
    Simulation s(solver(0.3f));
    for (const float height : {0.0f, 8.2f}) s.add_body(box({8, 8, 8}, {-4, -4, height}), material(alpha));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    run(s, 150);
    const std::vector<Vec> at = centers(s);
    EXPECT_NEAR(at[0].z(), 3.62, 0.05) << alpha;
    EXPECT_NEAR(at[1].z(), 11.15, 0.1) << alpha;
    EXPECT_LT(at[1].head<2>().norm(), 0.1) << alpha;
    EXPECT_LT(fastest(s) * 0.15, 1e-3) << alpha;
  }
}

TEST(body_contact, four_cubes_stand_where_their_weight_is_small) {
  for (const float alpha : {0.0f, 0.3f}) {
    Simulation s(solver(0.03f));
    for (int k = 0; k < 4; ++k)
      s.add_body(box({8, 8, 8}, {-4, -4, 8.2f * static_cast<float>(k)}), material(alpha));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    run(s, 150);
    const std::vector<Vec> at = centers(s);
    const double heights[] = {3.9, 11.8, 19.7, 27.7};
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(at[k].z(), heights[k], 0.3) << alpha;
      EXPECT_LT(at[k].head<2>().norm(), 0.5) << alpha;
    }
  }
}

TEST(body_contact, four_cubes_in_a_bin_come_to_rest_and_sleep_whatever_alpha) {
  for (const float alpha : {0.0f, 0.3f, 0.7f, 0.95f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver(0.3f));
    for (int k = 0; k < 4; ++k)
      s.add_body(box({8, 8, 8}, {-4, -4, 8.2f * static_cast<float>(k)}), material(alpha));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    s.add_collider({.shape = Box{{-4.6f, -4.6f, -5}, {4.6f, 4.6f, 100}, true}, .friction = 0.3f});
    run(s, 240);
    for (const BodyId body : s.bodies()) EXPECT_FALSE(s.is_awake(body));
    const std::vector<Vec> at = centers(s);
    for (std::size_t k = 1; k < at.size(); ++k) EXPECT_GT(at[k].z() - at[k - 1].z(), 5);
  }
}

TEST(body_contact, a_pyramid_of_ten_stands_and_falls_asleep) {
  Simulation s(solver(0.1f));
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  for (int level = 0; level < 4; ++level)
    for (int k = 0; k < 4 - level; ++k)
      s.add_body(box({6, 6, 6}, Vec(6.3 * k + 3.15 * level, 0, 6.1 * level).cast<float>()), material(0.3f));
  run(s, 130);
  for (const BodyId body : s.bodies()) EXPECT_FALSE(s.is_awake(body));
  const std::vector<Vec> at = centers(s);
  EXPECT_NEAR(at[9].z(), 20.4, 0.4);
  EXPECT_NEAR(at[9].x(), 12.45, 0.2);
  for (const Vec& center : at) EXPECT_NEAR(center.y(), 3, 0.2);
}

TEST(body_contact,
     of_bodies_that_meet_head_on_leaves_them_half_a_spacing_apart_keeps_momentum_and_adds_no_energy) {
  for (const float alpha : {0.0f, 1.0f})
    for (const float mass : {1.0f, 100.0f})
      for (const float speed : {1.0f, 6.0f, 40.0f}) {
        SCOPED_TRACE(testing::Message() << alpha << ' ' << mass << ' ' << speed);
        Simulation s(solver(0));
        s.add_body(box({6, 6, 6}, {-7, -3, -3}, {speed / 2, 0, 0}), material(alpha));
        Material heavy = material(alpha);
        heavy.particle_mass = mass;
        s.add_body(box({6, 6, 6}, {1.3f, -2.8f, -3.1f}, {-speed / 2, 0, 0}), heavy);
        const auto momentum = [&] {
          Vec sum = Vec::Zero();
          const std::vector<Vec3> v = s.velocities_by_id();
          for (std::size_t i = 0; i < v.size(); ++i)
            sum += static_cast<double>(i < 216 ? 1 : mass) * v[i].cast<double>();
          return sum;
        };
        const Vec before = momentum();
        const double start = s.energy().conserved,
                     scale = 216.0 * (1 + static_cast<double>(mass)) * static_cast<double>(speed) / 2;
        double least = 1e9, most = 0;
        while (s.time() < 10 / static_cast<double>(speed) + 2) {
          s.step();
          least = std::min(least, nearest(s, 216));
          most = std::max(most, s.energy().conserved);
        }
        EXPECT_GT(least, 0.5);
        EXPECT_LT((momentum() - before).norm() / scale, 1e-6);
        EXPECT_LT(most, start * (1 + 5e-5));
      }
}

// E = ρ0 m2/(Δt0 Δt_SM) is 35: the weight presses the cube together by 0.67, twice that while it swings, and
// is less than half of what would buckle it.
TEST(body_contact, a_cube_carries_another_of_a_hundred_times_its_density_as_the_spring_that_it_is) {
  for (const float alpha : {0.0f, 0.3f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver(0.01f));
    s.add_body(box({8, 8, 8}, {-4, -4, 0}), material(alpha));
    Material heavy = material(alpha);
    heavy.particle_mass = 100.0f;
    s.add_body(box({6, 6, 6}, {-3, -3, 8.2f}), heavy);
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    double lowest = 1e9, sum = 0;
    int count = 0;
    while (s.time() < 200) {
      run(s, 1);
      const Vec at = centers(s)[1];
      lowest = std::min(lowest, at.z());
      if (s.time() > 100) {
        sum += at.z();
        ++count;
      }
      ASSERT_LT(at.head<2>().norm(), 0.5);
      ASSERT_GT(nearest(s, 512), 0.7);
    }
    EXPECT_NEAR(sum / count, 10.95 - 0.67, 0.07);
    EXPECT_GT(lowest, 10.95 - 2.6 * 0.67);
  }
}

TEST(body_contact, a_fluid_does_not_leak_through_an_elastic_block) {
  Simulation s(solver(0.3f));
  s.add_body(box({14, 14, 6}, {-7, -7, 0}), material(0));
  s.add_body(box({12, 12, 6}, {-6, -6, 8}), material(1));
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  s.add_collider({.shape = Box{{-7, -7, -5}, {7, 7, 100}, true}});
  run(s, 40);
  const std::vector<Vec3> x = s.positions_by_id();
  for (std::size_t i = 14 * 14 * 6; i < x.size(); ++i) EXPECT_GT(x[i].z(), 4) << i;
}

TEST(body_contact, a_body_on_a_conveyor_of_pinned_particles_is_carried_along) {
  Simulation s(solver(0.1f));
  s.add_body(box({40, 10, 3}, {-30, -5, -3}), material(0));
  s.add_body(box({5, 5, 5}, {-2.5f, -2.5f, 0}), material(0));
  const PinId belt = s.pin(Aabb{{-100, -100, -5}, {100, 100, -0.2f}}, {0, 0, 0});
  run(s, 10);
  s.set_velocity(belt, {0.5f, 0, 0});
  run(s, 20);
  const double before = centers(s)[1].x();
  run(s, 10);
  EXPECT_NEAR(centers(s)[1].x() - before, 5, 0.1);
}

TEST(body_contact, has_the_same_bits_on_any_number_of_threads_and_after_a_restore) {
  const auto pile = [](int threads) {
    SolverConfig config = solver(0.3f);
    config.threads = threads;
    Simulation s(config);
    for (int k = 0; k < 12; ++k)
      s.add_body(box({4, 4, 4}, {2.1f * static_cast<float>(k % 3), static_cast<float>(k % 2),
                                 4.1f * static_cast<float>(k)}),
                 material(k % 2 == 0 ? 0.0f : 0.5f));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    return s;
  };
  Simulation one = pile(1), two = pile(2), three = pile(3);
  for (int step = 0; step < 150; ++step)
    for (Simulation* s : {&one, &two, &three}) s->step();
  EXPECT_EQ(one.state_hash(), two.state_hash());
  EXPECT_EQ(one.state_hash(), three.state_hash());
  Simulation restored = Simulation::restore(one.save(), 2);
  for (int step = 0; step < 20; ++step)
    for (Simulation* s : {&one, &restored}) s->step();
  EXPECT_EQ(one.state_hash(), restored.state_hash());
}

TEST(body_contact, with_what_is_no_number_ends_the_step_names_the_particle_and_leaves_the_state) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 1e38f}) {
    Simulation s(solver(0.3f));
    for (const float height : {0.0f, 4.1f}) s.add_body(box({4, 4, 4}, {0, 0, height}), material(0));
    s.add_collider({.shape = Plane{}});
    run(s, 5);
    const std::uint64_t before = s.state_hash();
    s.set_force([&](const ForceInput& in, VectorSpan a) {
      for (std::size_t i = 0; i < in.ids.size(); ++i)
        if (in.ids[i] == 70) a.x()[i] = bad;
    });
    try {
      s.step();
      ADD_FAILURE() << bad;
    } catch (const StepError& error) {
      EXPECT_EQ(error.particle_id(), 70u) << error.what();
    }
    EXPECT_EQ(s.state_hash(), before) << bad;
    s.set_force({});
    s.step();
  }
}

TEST(body_contact, between_bodies_that_are_far_apart_changes_no_bit) {
  const auto fall = [](bool beside) {
    Simulation s(solver(0.3f));
    s.add_body(box({5, 5, 5}, {0, 0, 4}, {0.1f, 0, 0}), material(0));
    if (beside) s.add_body(box({5, 5, 5}, {100, 0, 4}), material(0));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    run(s, 15);
    std::vector<Vec3> x = s.positions_by_id();
    x.resize(125);
    return x;
  };
  EXPECT_EQ(fall(false), fall(true));
}

TEST(body_contact, by_pressure_is_still_there_and_bodies_that_merge_do_not_touch) {
  SolverConfig config = solver(0.3f);
  config.contact = BodyContact::pressure;
  Simulation pressed(config);
  for (const float height : {0.0f, 5.0f}) pressed.add_body(box({5, 5, 5}, {0, 0, height}), material(0));
  pressed.step();
  EXPECT_TRUE(pressed.info().sph);

  Simulation touching(solver(0.3f));
  for (const float height : {0.0f, 5.0f}) touching.add_body(box({5, 5, 5}, {0, 0, height}), material(0));
  touching.step();
  EXPECT_FALSE(touching.info().sph) << "elastic bodies that touch need no sums over neighbours";
}

/// How far a cube has come down after 6 s that hangs under, or leans on, a block that is held. across: the
/// block is beside it.
double sunk(float adhesion, float friction, bool beside) {
  Simulation s(solver(0.1f));
  Material m = material(0);
  m.adhesion = adhesion;
  m.friction = friction;
  s.add_body(box({8, 8, 4}, {-4, -4, 0}), m);
  s.add_body(beside ? box({4, 4, 4}, {4.02f, -2, 0}) : box({4, 4, 4}, {-2, -2, -4.02f}), m);
  std::vector<ParticleId> held;
  for (ParticleId id = 0; id < 256; ++id) held.push_back(id);
  s.pin(held);
  const double before = centers(s)[1].z();
  run(s, 6);
  return before - centers(s)[1].z();
}

TEST(body_contact, sticks_up_to_its_stress_and_no_further) {
  // 64 particles of 1 kg under 0.1 m/s² on 16 m² pull with 0.4 Pa.
  EXPECT_GT(sunk(0, 0.5f, false), 1.5);
  EXPECT_GT(sunk(0.25f, 0.5f, false), 0.3);
  EXPECT_LT(sunk(2.0f, 0.5f, false), 0.3);
  EXPECT_GT(sunk(0.8f, 0.0f, true), 1.0) << "nothing rubs";
  EXPECT_LT(sunk(2.0f, 1.0f, true), 0.3);
}

TEST(collider, carries_what_lies_on_its_surface_and_stays) {
  Simulation s(solver(0.3f));
  s.add_body(box({4, 4, 4}, {-2, -2, 0}), material(0));
  const ColliderId belt = s.add_collider(
      {.shape = Box{{-100, -9, -3}, {100, 9, 0}}, .surface_velocity = {0.5f, 0, 0.7f}, .friction = 0.8f});
  run(s, 20);
  EXPECT_NEAR(s.motion(BodyId{0}).velocity.x(), 0.5, 0.04);
  EXPECT_NEAR(centers(s)[0].z(), 1.95, 0.1) << "what of it is along the normal counts nowhere";
  EXPECT_EQ(s.collider(belt).pose.translation, Eigen::Vector3d(0, 0, 0));
  EXPECT_TRUE(s.is_awake(BodyId{0}));
}

}  // namespace body_contact_test
}  // namespace mallow
