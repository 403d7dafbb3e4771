// Bodies whose parts become bodies of their own: Simulation::split(), Body::splits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mallow/mallow.h"
#include "refusal.h"

namespace mallow {
namespace split_test {

SolverConfig solver(int threads = 2) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = threads};
}

/// A bar of 4 x 4 that stands, so many particles high.
Body bar(int height, float bottom) {
  return sample(Lattice{.count = {4, 4, height}, .spacing = 1, .corner = {0, 0, bottom}, .jitter = 0.05f});
}

Aabb slab(float from, float to) {
  return {{-9, -9, from}, {9, 9, to}};
}

struct Cut {
  Simulation simulation;
  BodyId body;
};

/// A bar cut into a lower and an upper half by taking three layers out, in flight; more are above.
Cut cut_bar(SolverConfig config, const Material& material, bool splits = false) {
  Cut cut{Simulation(config), {}};
  Body points = bar(20, 0.1f);
  points.splits = splits;
  cut.body = cut.simulation.add_body(points, material, "bar");
  if (config.gravity.z() != 0)
    cut.simulation.add_collider({.shape = Box{{-0.5f, -0.5f, 0}, {4.5f, 4.5f, 90}, true}, .friction = 0.2f});
  cut.simulation.step();
  cut.simulation.remove_particles(slab(8, 11));
  return cut;
}

TEST(split, makes_parts_bodies_that_rest_and_move_as_they_did) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  for (const int stride : {1, 3}) {
    Cut cut = cut_bar(config, {.alpha = 0.2f, .region_stride = stride});
    Simulation& s = cut.simulation;
    s.set_velocity(cut.body, {0.1f, 0, 0}, {0, 0.1f, 0.1f});
    for (int k = 0; k < 20; ++k) s.step();
    s.set_user_data(cut.body, 7);
    const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
    const double elastic = s.energy().elastic;
    const std::vector<BodyId> bodies = s.split(cut.body);
    ASSERT_EQ(bodies.size(), 2u);
    EXPECT_EQ(bodies[0], cut.body);
    EXPECT_EQ(s.bodies(), bodies);
    EXPECT_EQ(s.rows(bodies[0]).end - s.rows(bodies[0]).begin, 144u) << "the larger part keeps the id";
    EXPECT_EQ(s.rows(bodies[1]).end - s.rows(bodies[1]).begin, 128u);
    EXPECT_EQ(s.name(bodies[1]), "bar, part 2");
    EXPECT_EQ(s.user_data(bodies[1]), 7u);
    EXPECT_EQ(s.positions_by_id(), x);
    EXPECT_EQ(s.velocities_by_id(), v);
    // With a stride other particles own regions now.
    EXPECT_NEAR(s.energy().elastic, elastic, (stride == 1 ? 1e-4 : 0.25) * elastic + 1e-6);
    EXPECT_EQ(s.split(bodies[1]), std::vector{bodies[1]});
    s.step();
    const auto split = std::ranges::find(s.events(), BodyEvent::Kind::split, &BodyEvent::kind);
    ASSERT_NE(split, s.events().end());
    EXPECT_EQ(split->body, bodies[0]);
    EXPECT_EQ(split->other, bodies[1]);
  }
}

TEST(split, lets_halves_move_as_if_they_had_been_cut_by_nobody) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  const auto run = [&](bool splits) {
    Cut cut = cut_bar(config, {.alpha = 0, .deformation_damping = 0.0f});
    Simulation& s = cut.simulation;
    s.set_velocity(cut.body, {0.1f, 0, 0}, {0, 0, 0.05f});
    if (splits) s.split(cut.body);
    for (int k = 0; k < 30; ++k) s.step();
    return s.positions_by_id();
  };
  const std::vector<Vec3> one = run(false), two = run(true);
  float most = 0;
  for (std::size_t i = 0; i < one.size(); ++i) most = std::max(most, (one[i] - two[i]).norm());
  EXPECT_LT(most, 1e-3f);
}

TEST(split, lets_the_upper_half_of_a_cut_bar_stand_on_the_lower_one) {
  const auto top = [](bool splits) {
    Cut cut = cut_bar(solver(), {.alpha = 0}, splits);
    cut.simulation.advance(60);
    return cut.simulation.bounds(cut.body).max.z();
  };
  EXPECT_NEAR(top(true), 17, 1.5) << "8 and 9 layers, one on the other";
  EXPECT_LT(top(false), 11) << "halves of one body of alpha 0 pass through each other";
}

TEST(split, of_bodies_that_are_to_comes_with_the_step_after_they_were_torn) {
  Cut cut = cut_bar(solver(), {.alpha = 0}, true);
  Simulation& s = cut.simulation;
  EXPECT_EQ(s.body_count(), 1u);
  s.step();
  EXPECT_EQ(s.body_count(), 2u);
  std::vector<BodyEvent::Kind> kinds;
  for (const BodyEvent& event : s.events()) kinds.push_back(event.kind);
  EXPECT_EQ(kinds, (std::vector{BodyEvent::Kind::torn, BodyEvent::Kind::split}));
}

TEST(split, gives_the_parts_that_a_body_is_in_now_and_not_those_that_it_lost) {
  Cut cut = cut_bar(solver(), {.alpha = 0}, true);
  Simulation& s = cut.simulation;
  s.step();
  const auto lost = std::ranges::find(s.events(), BodyEvent::Kind::split, &BodyEvent::kind);
  ASSERT_NE(lost, s.events().end());
  const BodyId upper = *lost->other;
  EXPECT_EQ(s.split(cut.body), std::vector{cut.body});
  EXPECT_EQ(s.split(upper), std::vector{upper});
  EXPECT_EQ(s.body_count(), 2u);
  s.remove_particles(slab(14, 17));
  const std::vector<BodyId> parts = s.split(cut.body);
  ASSERT_EQ(parts.size(), 2u) << "the part that kept the id was cut once more";
  EXPECT_EQ(parts[0], cut.body);
  EXPECT_NE(parts[1], upper);
  EXPECT_EQ(s.body_count(), 3u);
}

/// A strand that a nozzle at the origin lets out downwards, cut across at a height between layers that it
/// holds.
std::vector<BodyId> cut_strand(Simulation& s, EmitterId nozzle, float height) {
  s.remove_particles(Aabb{{-9, -9, height}, {9, 9, height + 2.9f}});
  return s.split(s.body(nozzle));
}

TEST(split, of_a_strand_leaves_its_emitter_the_part_that_new_layers_come_to) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  Simulation s(config);
  Emitter nozzle{.radius = 2.0f, .spacing = 1, .speed = 1};
  nozzle.pose.rotation = {1, 0, 0, 0};
  const EmitterId id = s.add_emitter(nozzle, s.add_material({.alpha = 0.1f}), "strand");
  s.advance(10);
  const BodyId strand = s.body(id);
  const std::vector<BodyId> first = cut_strand(s, id, 1);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0], strand);
  EXPECT_GT(s.bounds(first[0]).min.z(), 3.5f) << "what is behind the cut goes on with the nozzle";
  EXPECT_LT(s.bounds(first[1]).max.z(), 1.5f);
  // What the nozzle holds of the other part leaves it; then both are cut once more.
  s.advance(1);
  s.remove_particles(slab(-7, -4));
  for (const BodyId body : s.bodies()) s.split(body);
  EXPECT_EQ(s.body_count(), 3u);
  const std::vector<BodyId> second = cut_strand(s, id, 6);
  ASSERT_EQ(second.size(), 2u);
  EXPECT_EQ(second[0], strand);
  s.advance(40);
  EXPECT_EQ(s.body_count(), 4u);
  EXPECT_EQ(s.split(strand), std::vector{strand}) << "new layers are held together with those before them";
}

TEST(split, has_the_same_bits_on_any_number_of_threads_and_after_a_restore_in_between) {
  const auto run = [](int threads, bool restores) {
    Cut cut = cut_bar(solver(threads), {.alpha = 0.1f}, true);
    Simulation s = restores ? Simulation::restore(cut.simulation.save(), threads) : std::move(cut.simulation);
    s.step();
    if (restores) s = Simulation::restore(s.save(), threads);
    for (int k = 0; k < 60; ++k) s.step();
    EXPECT_EQ(s.body_count(), 2u);
    return s.state_hash();
  };
  const std::uint64_t hash = run(1, false);
  EXPECT_EQ(run(2, false), hash);
  EXPECT_EQ(run(3, true), hash);
}

TEST(split, keeps_what_particles_have_of_their_own) {
  SolverConfig config = solver();
  Simulation s(config);
  Body points = bar(20, 0.1f);
  for (const Vec3& x : points.positions) {
    points.alpha.push_back(x.z() < 10 ? 0.1f : 0.4f);
    points.temperature.push_back(300 + x.z());
    points.plastic_yield.push_back(x.x() < 2 ? 0.3f : 0.5f);
  }
  const BodyId id = s.add_body(
      points, Material{.plastic_yield = 0.3f, .temperature = 300.0f, .conductivity = 1, .specific_heat = 1});
  s.step();
  s.remove_particles(slab(8, 11));
  const PinId pin = s.pin(slab(15, 30));
  const auto columns = [&] {
    std::vector<std::vector<float>> all;
    const auto by_id = [&](std::span<const float> column) {
      std::vector<std::pair<ParticleId, float>> values;
      for (std::size_t row = 0; row < column.size(); ++row) values.emplace_back(s.ids()[row], column[row]);
      std::ranges::sort(values);
      all.emplace_back();
      for (const auto& [particle, value] : values) all.back().push_back(value);
    };
    by_id(s.alphas());
    by_id(s.temperatures());
    return all;
  };
  const auto before = columns();
  const std::vector<BodyId> bodies = s.split(id);
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(columns(), before);
  for (int k = 0; k < 20; ++k) s.step();
  s.unpin(pin);
  EXPECT_EQ(s.body_count(), 2u);
}

TEST(split, into_many_leaves_crumbs_with_the_one_that_keeps_the_id) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  Simulation s(config);
  const BodyId id = s.add_body(
      sample(Lattice{.count = {40, 2, 2}, .spacing = 1, .corner = {0, 0, 0}, .jitter = 0}), Material{});
  s.step();
  for (const float at : {6.0f, 14.0f, 22.0f, 30.0f}) s.remove_particles(Aabb{{at, -1, -1}, {at + 3, 3, 3}});
  s.remove_particles(Aabb{{34, -1, -1}, {39, 3, 3}});
  s.remove_particles(Aabb{{39, -1, -1}, {41, 1, 1}});
  const std::vector<BodyId> bodies = s.split(id);
  ASSERT_EQ(bodies.size(), 5u);
  std::size_t particles = 0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Simulation::Rows rows = s.rows(bodies[k]);
    EXPECT_EQ(rows.begin, k == 0 ? 0 : s.rows(bodies[k - 1]).end);
    particles += rows.end - rows.begin;
  }
  EXPECT_EQ(particles, s.particle_count());
  EXPECT_EQ(s.rows(bodies[0]).end - s.rows(bodies[0]).begin, 24u + 3u)
      << "the first of the largest, and crumbs";
  for (int k = 0; k < 10; ++k) s.step();
}

/// Names of all bodies, sorted.
std::vector<std::string> names(const Simulation& s) {
  std::vector<std::string> all;
  for (const BodyId body : s.bodies()) all.push_back(s.name(body));
  std::ranges::sort(all);
  return all;
}

TEST(split, gives_each_part_a_number_that_no_other_of_the_same_body_had_also_after_a_restore) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  const auto cut_again_and_again = [&](bool restores) {
    Simulation s(config);
    Body points = sample(Lattice{.count = {60, 2, 2}, .spacing = 1, .corner = {0, 0, 0}, .jitter = 0});
    points.splits = true;
    s.add_body(points, Material{}, "bar");
    s.step();
    const auto cut = [&](float at) {
      s.remove_particles(Aabb{{at, -1, -1}, {at + 3, 3, 3}});
      s.step();
      if (restores) s = Simulation::restore(s.save());
    };
    cut(40);
    EXPECT_EQ(names(s), (std::vector<std::string>{"bar", "bar, part 2"}));
    cut(20);  // the first part once more
    EXPECT_EQ(names(s), (std::vector<std::string>{"bar", "bar, part 2", "bar, part 3"}));
    cut(50);  // and one that was split off
    EXPECT_EQ(names(s), (std::vector<std::string>{"bar", "bar, part 2", "bar, part 3", "bar, part 4"}));
    s.remove_body(*s.find_body("bar, part 4"));
    s.remove_body(*s.find_body("bar"));
    cut(28);
    EXPECT_EQ(names(s), (std::vector<std::string>{"bar, part 2", "bar, part 3", "bar, part 5"}))
        << "numbers of parts that are gone do not come again";
  };
  for (const bool restores : {false, true}) cut_again_and_again(restores);
}

TEST(split, gives_no_part_a_name_that_somebody_chose) {
  Cut cut = cut_bar(solver(), {.alpha = 0}, true);
  Body other = bar(3, 50);
  cut.simulation.add_body(other, Material{}, "bar, part 2");
  cut.simulation.step();
  EXPECT_EQ(names(cut.simulation), (std::vector<std::string>{"bar", "bar, part 2", "bar, part 3"}));
}

TEST(bodies, that_were_given_no_name_have_names_of_their_own_whoever_went_before) {
  Simulation s(solver());
  float at = 0;
  const auto add = [&] { return s.add_body(bar(2, at += 10), Material{}); };
  const BodyId first = add();
  add();
  s.remove_body(first);
  add();
  add();
  EXPECT_EQ(names(s), (std::vector<std::string>{"body 1", "body 2", "body 3"}));
}

TEST(split, of_nobody_is_refused) {
  Cut cut = cut_bar(solver(), {.alpha = 0});
  cut.simulation.remove_body(cut.body);
  EXPECT_NE(test::refusal([&] { cut.simulation.split(cut.body); }).find("was removed"), std::string::npos);
}

TEST(set_collider, gives_another_floor_in_its_place_and_wakes_what_lay_on_it) {
  Simulation s(solver());
  const BodyId body = s.add_body(
      sample(Lattice{.count = {5, 5, 5}, .spacing = 1, .corner = {0, 0, 0.1f}, .jitter = 0}), Material{});
  const ColliderId floor = s.add_collider({.shape = Plane{}, .friction = 1.0f});
  for (int k = 0; k < 4000 && s.is_awake(body); ++k) s.step();
  ASSERT_FALSE(s.is_awake(body));
  EXPECT_THROW(s.set_collider(floor, {.shape = Plane{}, .friction = -1.0f}), ConfigError);
  EXPECT_EQ(s.colliders()[0].friction, 1.0f);
  s.set_collider(floor, {.shape = Plane{{0.1f, 0, 1}, 0}, .friction = 0.0f});
  EXPECT_EQ(s.colliders()[0].friction, 0.0f);
  const double before = s.motion(body).center_of_mass.x();
  s.advance(6);
  EXPECT_GT(s.motion(body).center_of_mass.x(), before + 0.3) << "it slides down";
  s.remove_collider(floor);
  EXPECT_THROW(s.set_collider(floor, {.shape = Plane{}}), ConfigError);
}

}  // namespace split_test
}  // namespace mallow
