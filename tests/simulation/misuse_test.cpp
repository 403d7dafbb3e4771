#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "mallow/mallow.h"

namespace mallow {
namespace misuse_test {

Simulation scene(int threads = 2) {
  SolverConfig config;
  config.support_radius = 2.0f;
  config.update_interval = 10;
  config.threads = threads;
  Simulation s(config);
  s.add_body(sample(Lattice{.count = {6, 6, 6}, .corner = {0, 0, 1}, .jitter = 0}),
             Material{.alpha = 0.5f, .update_threshold = 0.1f});
  s.add_collider({.shape = Plane{}});
  return s;
}

/// What a ConfigError thrown by `act` says; empty where none was thrown.
std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(misuse, an_empty_simulation_with_a_time_step_lets_time_pass_until_it_is_filled) {
  const auto run = [](bool waits) {
    Simulation s({.time_step = 0.15f});
    if (waits) {
      s.set_gravity({0, 0, -0.3f});
      s.add_collider({.shape = Plane{}});
      const MaterialId material = s.add_material({.alpha = 0.3f});
      EXPECT_EQ(s.advance(1.5).steps, 10);
      EXPECT_EQ(s.time(), 1.5);
      EXPECT_EQ(s.info().particles, 0u);
      s = Simulation::restore(s.save(), 1);
      EXPECT_EQ(s.step().time_step, static_cast<double>(0.15f));
      s.add_body(sample(Lattice{.count = {4, 4, 4}, .corner = {0, 0, 1}, .jitter = 0}), material);
    } else {
      s.set_gravity({0, 0, -0.3f});
      s.add_collider({.shape = Plane{}});
      s.add_body(sample(Lattice{.count = {4, 4, 4}, .corner = {0, 0, 1}, .jitter = 0}),
                 Material{.alpha = 0.3f});
    }
    for (int k = 0; k < 40; ++k) s.step();
    return s.positions_by_id();
  };
  EXPECT_EQ(run(true), run(false)) << "what comes then moves as what was there at first";
}

TEST(misuse, an_empty_simulation_without_a_time_step_cannot_be_stepped_and_can_be_filled_later) {
  Simulation s({.support_radius = 2.0f});
  EXPECT_NE(refusal([&] { s.step(); }).find("no particles"), std::string::npos);
  const MaterialId material = s.add_material({});
  EXPECT_NE(refusal([&] { s.step(); }).find("no particles"), std::string::npos);
  s.add_body(sample(Lattice{.count = {2, 2, 2}, .jitter = 0}), material);
  s.step();
  EXPECT_EQ(s.step_count(), 1);
}

TEST(misuse, a_body_that_overlaps_is_refused_at_once_and_nothing_changes) {
  Simulation s = scene();
  for (int step = 0; step < 5; ++step) s.step();
  const std::uint64_t before = s.state_hash();
  const Body there{.positions = {s.positions_by_id()[100]}, .spacing = 1};
  const Body touches = sample(Lattice{.count = {2, 2, 2}, .corner = {6.5f, 0, 3}, .jitter = 0});
  Body twice = touches;
  twice.positions.push_back(twice.positions[3] + Vec3(0, 0.09f, 0));
  const auto expect_refused = [&](const std::string& text, const char* says, const char* particles) {
    EXPECT_NE(text.find(says), std::string::npos) << text;
    EXPECT_NE(text.find(particles), std::string::npos) << text;
    EXPECT_NE(text.find("at least a tenth of the spacing (0.1 m)"), std::string::npos) << text;
    EXPECT_EQ(s.state_hash(), before);
    EXPECT_EQ(s.particle_count(), 216u);
    EXPECT_EQ(s.info().bodies.size(), 1u);
  };
  expect_refused(refusal([&] { s.extend_body(BodyId{0}, there); }), "body 'body 0' overlaps itself at (",
                 "particles 100 and 216 are 0 m apart");
  expect_refused(refusal([&] { s.add_body(there, Material{}, "late"); }),
                 "bodies 'late' and 'body 0' overlap at (", "particles 100 and 216 are 0 m apart");
  expect_refused(refusal([&] { s.extend_body(BodyId{0}, twice); }), "body 'body 0' overlaps itself at (",
                 "particles 219 and 224 are 0.09");
  expect_refused(refusal([&] { s.add_body(twice, Material{}, "own"); }), "body 'own' overlaps itself at (",
                 "particles 219 and 224 are 0.09");
  s.step();
  s.extend_body(BodyId{0}, touches);
  s.step();
  EXPECT_EQ(s.particle_count(), 224u);
}

TEST(misuse, a_body_so_far_away_that_floats_cannot_tell_its_points_apart_is_refused) {
  const auto at = [](const Vec3& place, float spacing) {
    Simulation s({.support_radius = 2 * spacing});
    const Body pair{.positions = {place, place + Vec3(0, 0, spacing)}, .spacing = spacing};
    return refusal([&] { s.add_body(pair, Material{}); });
  };
  EXPECT_EQ(at({1e5f, -1e5f, 0}, 0.1f), "");
  const std::string far = at({5e5f, 4.5e6f, 100}, 0.1f);
  for (const char* word : {"body.positions[", "(500000 4500000 100", "spacing of 0.1", "steps of 0.5 there"})
    EXPECT_NE(far.find(word), std::string::npos) << far;
  EXPECT_EQ(at({5e5f, 4.5e6f, 100}, 4.0f), "");
}

TEST(misuse, names_that_do_not_exist_are_refused) {
  Simulation s = scene();
  const std::uint64_t before = s.state_hash();
  EXPECT_NE(refusal([&] { s.set_alpha(MaterialId{1}, 0.1f); }).find("no material 1"), std::string::npos);
  EXPECT_NE(refusal([&] { s.add_body(sample(Lattice{}), MaterialId{7}); }).find("no material 7"),
            std::string::npos);
  EXPECT_NE(refusal([&] { s.extend_body(BodyId{7}, sample(Lattice{})); }).find("no body 7"),
            std::string::npos);
  EXPECT_NE(refusal([&] { s.rows(BodyId{1}); }).find("no body 1"), std::string::npos);
  EXPECT_NE(refusal([&] { s.material(BodyId{1}); }).find("no body 1"), std::string::npos);
  EXPECT_NE(refusal([&] {
              s.set_velocity(ColliderId{1}, {0, 0, 0});
            }).find("no collider 1"),
            std::string::npos);
  EXPECT_NE(refusal([&] { s.set_velocity(PinId{0}, {0, 0, 0}); }).find("no pin 0"), std::string::npos);
  const std::vector<ParticleId> ids{0, 216};
  EXPECT_NE(refusal([&] { s.pin(ids); }).find("no particle 216"), std::string::npos);
  EXPECT_EQ(s.state_hash(), before);
}

TEST(misuse, a_force_callback_may_not_change_or_step_what_calls_it) {
  Simulation s = scene(), undisturbed = scene();
  std::vector<std::string> refusals;
  s.set_force([&](const ForceInput&, VectorSpan) {
    refusals = {refusal([&] { s.step(); }),
                refusal([&] { s.prepare(); }),
                refusal([&] {
                  s.add_body(sample(Lattice{.corner = {50, 0, 0}, .jitter = 0}), MaterialId{0});
                }),
                refusal([&] {
                  s.extend_body(BodyId{0}, sample(Lattice{.corner = {50, 0, 0}, .jitter = 0}));
                }),
                refusal([&] { s.add_material({}); }),
                refusal([&] { s.add_collider({}); }),
                refusal([&] { s.pin(std::vector<ParticleId>{0}); }),
                refusal([&] { s.set_alpha(MaterialId{0}, 1.0f); }),
                refusal([&] {
                  s.set_velocity(ColliderId{0}, {1, 0, 0});
                }),
                refusal([&] { s.set_force({}); })};
  });
  for (int k = 0; k < 15; ++k) {
    s.step();
    undisturbed.step();
    ASSERT_EQ(refusals.size(), 10u);
    for (const std::string& text : refusals)
      EXPECT_NE(text.find("callback may not"), std::string::npos) << text;
  }
  EXPECT_EQ(s.state_hash(), undisturbed.state_hash());
  s.set_alpha(MaterialId{0}, 1.0f);  // between steps it may
}

TEST(misuse, what_a_force_callback_throws_comes_through_and_the_state_stays) {
  Simulation s = scene(), undisturbed = scene();
  for (int k = 0; k < 5; ++k) {
    s.step();
    undisturbed.step();
  }
  s.set_force([](const ForceInput&, VectorSpan) { throw std::runtime_error("out of forces"); });
  EXPECT_THROW(s.step(), std::runtime_error);
  EXPECT_EQ(s.state_hash(), undisturbed.state_hash());
  s.set_force({});
  for (int k = 0; k < 10; ++k) {
    s.step();
    undisturbed.step();
  }
  EXPECT_EQ(s.state_hash(), undisturbed.state_hash());
}

TEST(misuse, two_simulations_on_two_threads_do_not_know_of_each_other) {
  Simulation alone = scene();
  for (int k = 0; k < 40; ++k) alone.step();
  Simulation a = scene(), b = scene();
  std::thread one([&] {
    for (int k = 0; k < 40; ++k) a.step();
  });
  for (int k = 0; k < 40; ++k) b.step();
  one.join();
  EXPECT_EQ(a.state_hash(), alone.state_hash());
  EXPECT_EQ(b.state_hash(), alone.state_hash());
}

TEST(misuse, a_simulation_that_was_moved_from_can_be_assigned_to) {
  Simulation a = scene(), undisturbed = scene();
  a.step();
  Simulation b = std::move(a);
  undisturbed.step();
  EXPECT_EQ(b.state_hash(), undisturbed.state_hash());
  a = scene();
  a.step();
  EXPECT_EQ(a.state_hash(), undisturbed.state_hash());
  b = std::move(a);
  EXPECT_EQ(b.state_hash(), undisturbed.state_hash());
}

}  // namespace misuse_test
}  // namespace mallow
