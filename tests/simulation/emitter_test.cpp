#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace emitter_test {

SolverConfig solver(float gravity) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -gravity}, .threads = 2};
}
/// A round nozzle at a height that points down.
Emitter nozzle(double height, float speed = 1) {
  Emitter emitter{.radius = 2.0f, .spacing = 1, .speed = speed};
  emitter.pose.translation = {0, 0, height};
  emitter.pose.rotation = {1, 0, 0, 0};
  return emitter;
}
/// Pieces of particles that are nearer than this to one of their own.
std::size_t pieces(const Simulation& s, float distance) {
  const std::size_t n = s.particle_count();
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((s.positions()[i] - s.positions()[j]).norm() < distance) parent[root(i)] = root(j);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) count += root(i) == i;
  return count;
}

TEST(emitter, lets_a_strand_out_at_its_speed_without_strain) {
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver(0));
    const EmitterId id =
        s.add_emitter(nozzle(0, 0.8f), s.add_material({.alpha = alpha, .viscosity = 0.5f}), "strand");
    EXPECT_EQ(s.find_body("strand"), s.body(id));
    const std::size_t before = s.particle_count();
    s.advance(40);
    const Aabb box = s.bounds(s.body(id));
    EXPECT_NEAR(box.min.z(), -32 + 0.5, 0.7);
    EXPECT_EQ(pieces(s, 1.6f), 1u);
    const double each = 13;
    EXPECT_NEAR(static_cast<double>(s.particle_count() - before), 32 * each, 9 * each);
    EXPECT_LT(s.energy().elastic, alpha < 0.1f ? 1e-3 : 10.0) << "layers rest where they are put";
  }
}

TEST(emitter, pours_what_its_area_times_its_speed_says) {
  const auto poured_share = [](Emitter emitter, double area) {
    emitter.spacing = 1;
    Simulation s(solver(0));
    s.add_emitter(emitter, s.add_material({.alpha = 1.0f}));
    const std::size_t before = s.particle_count();
    s.advance(80);  // ten times eight layers
    return static_cast<double>(s.particle_count() - before) / (80 * area);
  };
  for (const float radius : {2.0f, 2.5f, 3.0f, 4.0f, 5.0f})
    EXPECT_NEAR(poured_share({.radius = radius}, std::acos(-1.0) * static_cast<double>(radius * radius)), 1,
                0.1)
        << radius;
  EXPECT_NEAR(poured_share({.width = 2.5f, .height = 2.5f}, 6.25), 1, 0.1);
  EXPECT_NEAR(poured_share({.width = 5.5f, .height = 2.5f}, 13.75), 1, 0.1);
  EXPECT_NEAR(poured_share({.width = 0.5f, .height = 1.2f}, 1), 1, 0.1) << "one particle at least";
}

TEST(emitter, that_stops_before_it_starts_is_refused) {
  Simulation s(solver(0));
  const MaterialId material = s.add_material({});
  EXPECT_THROW(s.add_emitter({.radius = 2.0f, .start = 2.0, .stop = 1.0}, material), ConfigError);
  EXPECT_THROW(s.add_emitter({.radius = 2.0f, .start = 1.0, .stop = 1.0}, material), ConfigError);
}

TEST(emitter, of_an_elastic_strand_that_moves_lays_down_one_strand) {
  Simulation s(solver(0.1f));
  Emitter emitter = nozzle(8, 1);
  emitter.velocity = {0.9f, 0, 0};
  const EmitterId id = s.add_emitter(emitter, s.add_material({.alpha = 0.5f}), "strand");
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  s.advance(40);
  EXPECT_EQ(pieces(s, 2.0f), 1u);
  EXPECT_GT(s.bounds(s.body(id)).max.x() - s.bounds(s.body(id)).min.x(), 25);
  EXPECT_NEAR(s.emitter(id).pose.translation.x(), 36, 1e-3);
}

TEST(emitter, starts_stops_and_ends) {
  Simulation s(solver(0));
  Emitter emitter = nozzle(0, 1);
  emitter.start = 2;
  emitter.stop = 5;
  const EmitterId id = s.add_emitter(emitter, s.add_material({}));
  const double top = s.motion(s.body(id)).center_of_mass.z();
  s.advance(2);
  EXPECT_EQ(s.motion(s.body(id)).center_of_mass.z(), top);
  s.advance(3);
  const double out = s.bounds(s.body(id)).min.z();
  EXPECT_NEAR(out, -3, 1);
  s.advance(3);
  EXPECT_NEAR(s.bounds(s.body(id)).min.z(), out - 3, 0.1) << "nothing holds it, so that it flies on";
  EXPECT_NEAR(s.bounds(s.body(id)).max.z(), -3.5, 0.5) << "what was behind the nozzle is gone";
  const BodyId strand = s.body(id);
  s.set_gravity({0, 0, -0.3f});
  s.advance(3);
  EXPECT_LT(s.motion(strand).velocity.z(), -1.8) << "and it falls";
  s.remove_emitter(id);
  EXPECT_THROW(s.emitter(id), ConfigError);
  EXPECT_TRUE(s.motion(strand).velocity.allFinite());
}

TEST(emitter, that_stops_before_anything_has_left_leaves_nothing) {
  Simulation s(solver(0));
  Emitter emitter = nozzle(0, 0.01f);
  emitter.stop = 1;
  const EmitterId id = s.add_emitter(emitter, s.add_material({}));
  s.advance(3);
  EXPECT_EQ(s.particle_count(), 0u);
  EXPECT_THROW(s.emitter(id), ConfigError) << "an emitter goes with its body";
}

TEST(emitter, frees_what_it_holds_when_it_is_removed) {
  Simulation s(solver(0.3f));
  const EmitterId id = s.add_emitter(nozzle(0, 1), s.add_material({}));
  s.advance(3);
  const BodyId strand = s.body(id);
  s.remove_emitter(id);
  s.advance(3);
  EXPECT_LT(s.motion(strand).velocity.z(), -0.8);
}

TEST(emitter, grows_no_longer_than_its_budget_and_sinks_take_what_comes_to_them) {
  Simulation s(solver(0.3f));
  Emitter emitter = nozzle(10, 1.5f);
  emitter.most_particles = 400;
  const EmitterId id = s.add_emitter(emitter, s.add_material({.alpha = 1.0f, .viscosity = 0.5f}));
  for (int k = 0; k < 150; ++k) s.step();
  EXPECT_GE(s.particle_count(), 400u);
  EXPECT_LT(s.particle_count(), 400u + 8 * 12) << "a batch of layers is put behind the nozzle at once";
  const SinkId sink = s.add_sink(Aabb{{-1000, -1000, -1000}, {1000, 1000, 0}});
  const SinkId idle = s.add_sink(Aabb{{5000, 0, 0}, {5001, 1, 1}});
  std::uint64_t drained = 0;
  for (int k = 0; k < 250; ++k) {
    drained += s.step().drained;
    ASSERT_GT(s.bounds(s.body(id)).min.z(), -1.5f);
  }
  EXPECT_LT(s.particle_count(), 400u) << "and it flows on as room is made";
  EXPECT_GT(s.particle_count(), 150u);
  s = Simulation::restore(s.save());
  EXPECT_EQ(s.sink_ids(), (std::vector{sink, idle}));
  EXPECT_EQ(s.drained(sink), drained);
  EXPECT_EQ(s.drained(idle), 0u);
  s.remove_sink(idle);
  EXPECT_THROW(s.drained(idle), ConfigError);
}

TEST(emitter, leaves_what_others_have_pinned_and_gives_its_pin_back) {
  Simulation s(solver(0));
  const MaterialId jelly = s.add_material({});
  const EmitterId id = s.add_emitter(nozzle(0), jelly);
  const std::vector<ParticleId> held = {0, 1, 2};
  const PinId mine = s.pin(held, {0, 0, -1});
  for (int k = 0; k < 60; ++k) s.step();
  for (const ParticleId particle : held) EXPECT_EQ(s.velocities()[s.row(particle)], Vec3(0, 0, -1));
  s.remove_body(s.body(id));
  s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {50, 0, 0}}), jelly);
  s.step();
  EXPECT_THROW(s.body(id), ConfigError);
  EXPECT_EQ(slot_of(s.pin(std::vector<ParticleId>{s.ids()[0]})), 0u) << "the slot of what held the strand";
  EXPECT_EQ(slot_of(mine), 1u);
}

TEST(emitter, has_the_same_bits_on_any_number_of_threads_and_after_a_restore) {
  const auto run = [](int threads, bool restored) {
    SolverConfig config = solver(0.1f);
    config.threads = threads;
    Simulation s(config);
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    Emitter emitter = nozzle(6, 1);
    emitter.velocity = {0.5f, 0, 0};
    s.add_emitter(emitter, s.add_material({.alpha = 0.5f}));
    s.add_sink(Aabb{{-100, -100, -100}, {100, 100, 100}}, true);
    for (int k = 0; k < 100; ++k) s.step();
    if (restored) s = Simulation::restore(s.save(), threads);
    for (int k = 0; k < 150; ++k) s.step();
    return s.state_hash();
  };
  const std::uint64_t expected = run(1, false);
  EXPECT_EQ(run(3, false), expected);
  EXPECT_EQ(run(2, true), expected);
}

TEST(emitter, takes_what_it_holds_along_through_its_keyframes_and_turns_it) {
  Simulation s(solver(0));
  Emitter emitter{.radius = 2.0f, .spacing = 1, .speed = 0};
  emitter.keyframes = {{1, {{0, 0, 0}, {0, 0, 0, 1}}},
                       {4, {{3, 0, 1}, {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}},
                       {6, {{3, 5, 1}, {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}}};
  const EmitterId id = s.add_emitter(emitter, s.add_material({}));
  std::vector<Vec3> local;
  for (std::size_t row = 0; row < s.particle_count(); ++row) local.push_back(s.positions()[row]);
  const std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
  while (s.time() < 7) {
    s.step();
    const Pose pose = pose_at(emitter.keyframes, s.time());
    ASSERT_EQ(s.emitter(id).pose.translation, pose.translation);
    const Eigen::Quaterniond turn(Eigen::Vector4d(pose.rotation));
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const Eigen::Vector3d expected = pose.translation + turn * local[k].cast<double>();
      ASSERT_LT((s.positions()[s.row(ids[k])].cast<double>() - expected).norm(), 3e-5) << s.time();
    }
  }
  s.set_flow(id, 1);
  EXPECT_TRUE(s.emitter(id).keyframes.empty());
  const Vec3 before = s.positions()[s.row(ids[0])];
  s.step();
  EXPECT_NEAR((s.positions()[s.row(ids[0])] - before).x(), 0.15, 1e-5) << "the strand leaves it along x now";
}

TEST(emitter, flows_at_the_speed_of_its_keys) {
  Simulation s(solver(0));
  Emitter emitter = nozzle(0);
  emitter.speed = {{1, 0}, {3, 1}, {4, 1}, {4.6f, 0}};
  const EmitterId id = s.add_emitter(emitter, s.add_material({}));
  const ParticleId held = s.ids()[s.rows(s.body(id)).end - 1];
  const float z = s.positions()[s.row(held)].z();
  const auto advance_to = [&](double time, double way) {
    s.advance(time - s.time());
    EXPECT_NEAR(s.positions()[s.row(held)].z(), z - way, 2e-5) << time;
  };
  advance_to(1, 0);
  advance_to(2, 0.25);
  advance_to(3, 1);
  advance_to(4, 2);
  advance_to(4.6, 2.3);
  advance_to(6, 2.3);
}

TEST(emitter, with_key_points_goes_on_with_the_same_bits_after_a_restore) {
  const auto run = [](bool restored) {
    Simulation s(solver(0.1f));
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    Emitter emitter = nozzle(6);
    emitter.speed = {{0, 0.5f}, {10, 1.5f}, {12, 0}, {20, 1}};
    emitter.keyframes = {{2, {{0, 0, 6}, {1, 0, 0, 0}}}, {25, {{9, 3, 7}, {0.9, 0.3, 0, 0.1}}}};
    s.add_emitter(emitter, s.add_material({.alpha = 0.3f}));
    for (int k = 0; k < 90; ++k) s.step();
    if (restored) s = Simulation::restore(s.save(), 1);
    for (int k = 0; k < 120; ++k) s.step();
    return s.state_hash();
  };
  EXPECT_EQ(run(true), run(false));
}

/// It stood still before too, but the nozzle pushed on and filled it up.
TEST(emitter, whose_strand_is_not_enabled_stands_still_and_goes_on_as_if_nothing_had_been) {
  for (const float alpha : {0.0f, 1.0f}) {
    SCOPED_TRACE(alpha);
    Simulation s(solver(0)), always(solver(0));
    std::vector<EmitterId> nozzles;
    for (Simulation* each : {&s, &always}) {
      Emitter moving = nozzle(0);
      moving.velocity = {0.2f, 0, 0};
      nozzles.push_back(each->add_emitter(moving, each->add_material({.alpha = alpha, .viscosity = 0.5f})));
      each->add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {90, 0, 0}}), Material{});
      for (int k = 0; k < 40; ++k) each->step();
    }
    const std::size_t count = s.particle_count();
    s.enable(s.body(nozzles[0]), false);
    for (int k = 0; k < 100; ++k) s.step();
    EXPECT_EQ(s.particle_count(), count);
    EXPECT_EQ(s.emitter(nozzles[0]).pose.translation, always.emitter(nozzles[1]).pose.translation);
    s.enable(s.body(nozzles[0]), true);
    for (int k = 0; k < 40; ++k) {
      s.step();
      always.step();
    }
    ASSERT_EQ(s.particle_count(), always.particle_count());
    const Aabb box = s.bounds(s.body(nozzles[0])), expected = always.bounds(always.body(nozzles[1]));
    EXPECT_LT((box.min - expected.min).norm(), 1e-3f);
    EXPECT_LT((box.max - expected.max).norm(), 1e-3f);
  }
}

TEST(emitter, with_keyframes_goes_on_from_where_it_stood_when_its_strand_is_enabled_again) {
  // 6 m of way in the 6 s for which it is not enabled: in one step they would be 40 m/s.
  const auto leave = [](Simulation& s) {
    Emitter emitter = nozzle(0);
    emitter.start = 1;
    emitter.stop = 14;
    emitter.speed = {{2, 0.5f}, {12, 1.5f}};
    emitter.keyframes = {{1, {{0, 0, 0}, {1, 0, 0, 0}}}, {13, {{12, 0, 2}, {0.9, 0.3, 0, 0.1}}}};
    return s.add_emitter(emitter, s.add_material({.alpha = 0.3f}));
  };
  Simulation s(solver(0)), always(solver(0));
  const EmitterId nozzle = leave(s), led = leave(always);
  s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {90, 0, 0}}), Material{});
  s.advance(3);
  always.advance(3);
  const Pose pose = s.emitter(nozzle).pose;
  s.enable(s.body(nozzle), false);
  s.advance(6);
  EXPECT_EQ(s.emitter(nozzle).pose.translation, pose.translation);
  s = Simulation::restore(s.save());
  s.enable(s.body(nozzle), true);
  for (int k = 0; k < 20; ++k) {
    s.advance(0.5);
    always.advance(0.5);
    const Emitter &own = s.emitter(nozzle), &other = always.emitter(led);
    ASSERT_LT((own.pose.translation - other.pose.translation).norm(), 1e-5) << always.time();
    ASSERT_LT((own.velocity - other.velocity).norm(), 1e-4f) << always.time();
  }
  const BodyMotion motion = s.motion(s.body(nozzle)), expected = always.motion(always.body(led));
  EXPECT_EQ(motion.mass, expected.mass) << "it has stopped as long after it started";
  EXPECT_LT((motion.center_of_mass - expected.center_of_mass).norm(), 1e-2);
}

TEST(emitter, that_was_not_enabled_takes_a_new_flow_by_the_time_of_now) {
  Simulation s(solver(0));
  Emitter emitter = nozzle(0);
  emitter.stop = 6;
  const EmitterId id = s.add_emitter(emitter, s.add_material({}));
  s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {90, 0, 0}}), Material{});
  s.advance(1);
  s.enable(s.body(id), false);
  for (int k = 1; k <= 40; ++k)  // steps that land on frames are no floats
    while (s.time() < 1 + 0.1 * k) s.step_towards(1 + 0.1 * k);
  s.enable(s.body(id), true);
  s.set_flow(id, {{5, 0}, {7, 1}});
  const double low = static_cast<double>(s.bounds(s.body(id)).max.z());
  s.advance(2);
  EXPECT_NEAR(static_cast<double>(s.bounds(s.body(id)).max.z()), low - 1, 1e-4);
  EXPECT_NEAR(*s.emitter(id).stop, 10, 1e-12) << "and stops after the 6 s that it was enabled";
  s.advance(3.2);
  EXPECT_TRUE(s.held(id).empty());
}

TEST(sink, leaves_what_is_not_enabled) {
  Simulation s(solver(0));
  const BodyId body =
      s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {0, 0, 0}, .jitter = 0}), Material{});
  s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {20, 0, 0}, .jitter = 0}), Material{});
  s.add_sink(Aabb{{-1, -1, -1}, {30, 5, 1.5f}});
  s.enable(body, false);
  s.step();
  EXPECT_EQ(s.rows(body).end - s.rows(body).begin, 27u);
  EXPECT_EQ(s.particle_count(), 36u);
  s.enable(body, true);
  s.step();
  EXPECT_EQ(s.rows(body).end - s.rows(body).begin, 9u);
}

TEST(emitter, that_lets_out_faster_than_a_step_carries_is_refused_before_the_first_one) {
  Simulation s(solver(0));
  s.add_emitter(nozzle(0, 2e4f), s.add_material({.alpha = 1.0f}));
  EXPECT_EQ(test::refusal([&] { s.prepare(); }),
            "emitter.speed: 20000 m/s is not allowed: no step carries more than 14000 m/s");
}

TEST(emitter, tells_which_particles_it_holds) {
  Simulation s(solver(0));
  const MaterialId jelly = s.add_material({.alpha = 0.3f});
  const EmitterId gone = s.add_emitter(nozzle(50), jelly), id = s.add_emitter(nozzle(0), jelly);
  s.remove_emitter(gone);
  EXPECT_EQ(s.emitter_ids(), (std::vector<EmitterId>{id}));
  s.advance(10);
  std::vector<ParticleId> held = s.held(id);
  std::ranges::sort(held);
  const Simulation::Rows rows = s.rows(s.body(id));
  std::size_t behind = 0;
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    const bool is_behind = s.positions()[row].z() > 1e-4f;
    behind += is_behind;
    EXPECT_EQ(std::ranges::binary_search(held, s.ids()[row]), is_behind) << s.positions()[row].transpose();
  }
  EXPECT_GT(behind, 0u);
  EXPECT_EQ(held.size(), behind);
  s.remove_particles(std::span(held).first(3));
  EXPECT_EQ(s.held(id).size(), behind - 3);
  EXPECT_THROW(s.held(gone), ConfigError);
}

TEST(emitter, is_refused_where_it_is_wrong) {
  Simulation s(solver(0));
  const MaterialId jelly = s.add_material({});
  const auto problem = [&](const std::function<void(Emitter&)>& change) {
    Emitter emitter = nozzle(0);
    change(emitter);
    try {
      s.add_emitter(emitter, jelly);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  const std::vector<std::pair<std::function<void(Emitter&)>, const char*>> cases{
      {[](Emitter& e) { e.radius = {}; }, "emitter.radius: is missing"},
      {[](Emitter& e) { e.width = 3.0f; }, "emitter.radius: is not allowed beside width"},
      {[](Emitter& e) { e.radius = -1.0f; }, "emitter.radius: -1 is not allowed"},
      {[](Emitter& e) { e.speed = -1; }, "emitter.speed"},
      {[](Emitter& e) {
         e.speed = {{1, 1}, {1, 0}};
       },
       "emitter.speed time"},
      {[](Emitter& e) {
         e.keyframes = {{1, {}}, {0, {}}};
       },
       "emitter.keyframes[1].time"},
      {[](Emitter& e) {
         e.keyframes = {{1, {{0, 0, 0}, {0, 0, 0, 0}}}};
       },
       "emitter.keyframes[0].pose.rotation"},
      {[](Emitter& e) { e.spacing = 0; }, "emitter.spacing"},
      {[](Emitter& e) { e.radius = 1e6f; }, "emitter.spacing: makes layers of over a million"},
      {[](Emitter& e) { e.pose.rotation.setZero(); }, "emitter.pose.rotation"},
      {[](Emitter& e) {
         e.radius = {};
         e.points = {{0, 0, 0}, {1, 0, 5}, {2, 0, 0}, {1.06f, 0.03f, 0}};
       },
       "emitter.points: points 1 (1 0 5) and 3 (1.06 0.03    0) are 0.0670"},
      {[](Emitter& e) { e.speed = 1e30f; },
       "emitter.speed: 1e+30 m/s is not allowed: no step carries more than"},
      {[](Emitter& e) { e.jitter = 1; }, "emitter.jitter"},
      {[](Emitter& e) { e.most_particles = 0; }, "emitter.most_particles"},
  };
  for (const auto& [change, text] : cases) EXPECT_NE(problem(change).find(text), std::string::npos) << text;
  EXPECT_THROW(s.remove_emitter(EmitterId{0}), ConfigError);
  EXPECT_THROW(s.remove_sink(SinkId{0}), ConfigError);
  EXPECT_THROW(s.add_sink(Aabb{{0, 0, 0}, {0, 1, 1}}), ConfigError);
  EXPECT_EQ(s.particle_count(), 0u);
}

}  // namespace emitter_test
}  // namespace mallow
