// Bodies that are pressed into each other become one: model 2, section 5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace join_test {

using test::refusal;

using Kind = BodyEvent::Kind;

SolverConfig solver(int threads = 2) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, 0},
          .update_period = 3.0f,
          .volume_iterations = 0,
          .sleep_speed = 0.0f,
          .threads = threads};
}
Material dough(float yield = 0.05f) {
  return {.alpha = 0.3f, .plastic_yield = yield, .damping_time = 0.1f};
}
/// A ball that goes at a speed along z.
Body lump(float z, float speed, float radius = 4) {
  Body body = sample(sphere_shape({0, 0, z}, radius), Sampling{.spacing = 1.0f});
  body.velocity = {0, 0, speed};
  body.merges = true;
  return body;
}

/// Two balls that meet head-on, and a third body between them in the order of rows, far away.
struct Meeting {
  Simulation s;
  MaterialId material;
  BodyId lower, aside, upper;

  explicit Meeting(float speed, int threads = 2, Material made_of = dough())
      : s(solver(threads)), material(s.add_material(made_of)) {
    lower = s.add_body(lump(-5.2f, speed / 2), material, "lower");
    Body far = lump(0, 0, 3);
    for (Vec3& x : far.positions) x += Vec3(60, 0, 0);
    aside = s.add_body(far, material, "aside");
    upper = s.add_body(lump(5.2f, -speed / 2), material, "upper");
  }
  /// Until some bodies are one; returns the events of that step.
  std::vector<BodyEvent> run(int steps) {
    for (int k = 0; k < steps; ++k) {
      const std::size_t before = s.body_count();
      s.step();
      if (s.body_count() < before) return {s.events().begin(), s.events().end()};
    }
    return {};
  }
};
Eigen::Vector3d momentum(const Simulation& s) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Vec3& v : s.velocities_by_id()) sum += v.cast<double>();
  return sum;
}
bool holds(const Simulation& s, BodyId body, ParticleId id) {
  const Simulation::Rows rows = s.rows(body);
  return s.row(id) >= rows.begin && s.row(id) < rows.end;
}

TEST(join, two_lumps_that_are_pressed_together_become_one_and_events_say_so) {
  Meeting m(3.0f);
  const std::size_t lower = m.s.rows(m.lower).end - m.s.rows(m.lower).begin;
  std::vector<ParticleId> of_upper, of_aside;
  for (std::size_t row = m.s.rows(m.upper).begin; row < m.s.rows(m.upper).end; ++row)
    of_upper.push_back(m.s.ids()[row]);
  for (std::size_t row = m.s.rows(m.aside).begin; row < m.s.rows(m.aside).end; ++row)
    of_aside.push_back(m.s.ids()[row]);
  m.s.set_user_data(m.lower, 7);
  m.s.set_user_data(m.upper, 8);
  const std::vector<BodyEvent> events = m.run(100);
  EXPECT_EQ(m.s.bodies(), (std::vector{m.lower, m.aside}));
  EXPECT_EQ(m.s.name(m.lower), "lower");
  EXPECT_EQ(m.s.user_data(m.lower), 7u);
  EXPECT_EQ(m.s.find_body("upper"), std::nullopt);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, Kind::yielded);
  EXPECT_EQ(events[1].kind, Kind::merged);
  EXPECT_EQ(events[1].body, m.lower);
  EXPECT_EQ(events[1].other, m.upper);
  EXPECT_EQ(events[1].parts, 1u);
  EXPECT_EQ(m.s.rows(m.lower).end - m.s.rows(m.lower).begin, lower + of_upper.size());
  for (const ParticleId id : of_upper) ASSERT_TRUE(holds(m.s, m.lower, id));
  for (const ParticleId id : of_aside) ASSERT_TRUE(holds(m.s, m.aside, id));
  EXPECT_NE(refusal([&] { m.s.rows(m.upper); }).find("body 2 was merged into body 0"), std::string::npos);
}

TEST(join, leaves_no_list_of_bodies_that_grows_for_ever) {
  Meeting m(3.0f);
  std::vector<std::size_t> sizes;
  for (int meeting = 0; meeting < 4; ++meeting) {
    ASSERT_FALSE(m.run(100).empty()) << meeting;
    sizes.push_back(m.s.save().find("events")->size());
    m.s.remove_body(m.lower);
    m.lower = m.s.add_body(lump(-5.2f, 1.5f), m.material, "lower");
    m.upper = m.s.add_body(lump(5.2f, -1.5f), m.material, "upper");
  }
  EXPECT_EQ(sizes.back(), sizes[1]);
  EXPECT_NE(refusal([&] { m.s.rows(BodyId{2}); }).find("body 2 was"), std::string::npos);
}

TEST(join, two_that_touch_lightly_stay_two) {
  for (const float speed : {0.05f, 0.2f}) {
    Meeting m(speed);
    EXPECT_TRUE(m.run(static_cast<int>(3 / (0.15f * speed)) + 200).empty()) << speed;
    EXPECT_EQ(m.s.body_count(), 3u) << speed;
  }
}

TEST(join, not_where_one_does_not_merge_or_is_of_another_material) {
  for (const bool merges : {false, true}) {
    Simulation s(solver());
    const MaterialId one = s.add_material(dough()), other = s.add_material(dough());
    s.add_body(lump(-5.2f, 1.5f), one);
    Body upper = lump(5.2f, -1.5f);
    upper.merges = merges;
    s.add_body(upper, merges ? other : one);
    for (int k = 0; k < 200; ++k) s.step();
    EXPECT_EQ(s.body_count(), 2u);
  }
}

/// How far apart two balls that met are in the end, where the upper half of one is pulled away.
float gap_after_a_pull(float speed) {
  Meeting m(speed);
  m.run(static_cast<int>(3 / (0.15f * speed)) + 100);
  for (int k = 0; k < 100; ++k) m.s.step();
  std::vector<ParticleId> top;
  const Aabb all = m.s.bounds(m.lower);
  float highest = -99;
  for (std::size_t row = 0; row < m.s.particle_count(); ++row)
    if (m.s.positions()[row].x() < 30) highest = std::max(highest, m.s.positions()[row].z());
  for (std::size_t row = 0; row < m.s.particle_count(); ++row)
    if (m.s.positions()[row].x() < 30 && m.s.positions()[row].z() > highest - 2)
      top.push_back(m.s.ids()[row]);
  const float before = all.min.z();
  m.s.pin(top, {0, 0, 0.1f});
  for (int k = 0; k < 600; ++k) m.s.step();
  return m.s.bounds(m.lower).min.z() - before;
}

TEST(join, one_follows_where_the_other_is_pulled_and_what_touched_lightly_does_not) {
  EXPECT_GT(gap_after_a_pull(3.0f), 4.5f) << "of the 9 that its top was moved";
  EXPECT_LT(gap_after_a_pull(0.2f), 1.0f);
}

TEST(join, keeps_momentum) {
  Meeting m(3.0f);
  m.s.set_velocity(m.lower, {0.3f, 0.1f, 1.5f});
  const Eigen::Vector3d before = momentum(m.s);
  for (int k = 0; k < 100; ++k) m.s.step();
  EXPECT_EQ(m.s.body_count(), 2u);
  EXPECT_LT((momentum(m.s) - before).norm(), 1e-5 * 1.5 * static_cast<double>(m.s.particle_count()));
}

// The elastic strain that is left is what a new frame of one body keeps; nothing is gained.
TEST(join, takes_energy_and_gives_none) {
  for (const float speed : {1.0f, 2.0f, 3.0f}) {
    Meeting m(speed);
    double before = 0;
    const auto energy = [&] {
      const Energy e = m.s.energy();
      return e.kinetic + e.elastic;
    };
    for (int k = 0; k < 100 && m.s.body_count() == 3; ++k) {
      before = energy();
      m.s.step();
    }
    ASSERT_EQ(m.s.body_count(), 2u) << speed;
    for (int k = 0; k < 10; ++k) {
      const double after = energy();
      EXPECT_LT(after, 1.02 * before) << speed << ", step " << k;
      before = after;
      m.s.step();
    }
  }
}

TEST(join, gives_the_same_bits_on_any_number_of_threads_and_after_a_restore_at_any_step) {
  Meeting one(3.0f, 1), two(3.0f, 2);
  Simulation restored = Simulation::restore(two.s.save(), 2);
  std::size_t least = 3;
  for (int k = 0; k < 60; ++k) {
    one.s.step();
    two.s.step();
    restored = Simulation::restore(restored.save(), 2);
    restored.step();
    ASSERT_EQ(one.s.state_hash(), two.s.state_hash()) << k;
    ASSERT_EQ(one.s.state_hash(), restored.state_hash()) << k;
    ASSERT_EQ(one.s.events().size(), restored.events().size()) << k;
    ASSERT_EQ(one.s.bodies(), restored.bodies()) << k;
    least = std::min(least, restored.body_count());
  }
  EXPECT_EQ(least, 2u);
  restored = Simulation::restore(restored.save(), 2);
  EXPECT_NE(refusal([&] { restored.rows(two.upper); }).find("merged into body 0"), std::string::npos);
}

TEST(join, makes_one_of_three) {
  for (const int stride : {1, 3}) {
    Material material = dough();
    material.region_stride = stride;
    Simulation s(solver());
    const MaterialId id = s.add_material(material);
    const BodyId first = s.add_body(lump(-10.4f, 3), id);
    const BodyId second = s.add_body(lump(10.4f, -3), id), third = s.add_body(lump(0, 0), id);
    std::vector<BodyId> ended;
    std::size_t parts = 0;
    for (int k = 0; k < 150; ++k) {
      s.step();
      for (const BodyEvent& event : s.events()) {
        if (event.kind != Kind::merged || !event.other) continue;
        ended.push_back(*event.other);
        parts = event.parts;
        EXPECT_EQ(event.body, first);
      }
    }
    std::ranges::sort(ended);
    EXPECT_EQ(ended, (std::vector{second, third})) << stride;
    EXPECT_EQ(parts, 1u) << stride;
    EXPECT_EQ(s.bodies(), std::vector{first});
    EXPECT_EQ(s.rows(first).end, s.particle_count());
    for (const BodyId gone : ended)
      EXPECT_NE(refusal([&] { s.motion(gone); }).find("merged into body 0"), std::string::npos);
  }
}

TEST(join, takes_along_what_is_painted_warm_and_pinned) {
  Material material = dough(0.05f);
  material.temperature = 300.0f;
  material.conductivity = 0;
  material.specific_heat = 1;
  for (const bool on_first : {false, true}) {
    Meeting m(3.0f, 2, material);
    const BodyId painted = on_first ? m.lower : m.upper, plain = on_first ? m.upper : m.lower;
    const auto ids_of = [&](BodyId body) {
      const Simulation::Rows rows = m.s.rows(body);
      std::vector<ParticleId> ids(m.s.ids().begin() + static_cast<std::ptrdiff_t>(rows.begin),
                                  m.s.ids().begin() + static_cast<std::ptrdiff_t>(rows.end));
      std::ranges::sort(ids);
      return ids;
    };
    const std::vector<ParticleId> ids = ids_of(painted), others = ids_of(plain);
    for (std::size_t k = 0; k < ids.size(); ++k) {
      m.s.set_alpha({&ids[k], 1}, k % 2 == 0 ? 0.2f : 0.4f);
      m.s.set_stiffness({&ids[k], 1}, k % 3 == 0 ? 0.5f : 1.0f);
      m.s.set_temperature({&ids[k], 1}, 310.0f + static_cast<float>(k));
    }
    ASSERT_FALSE(m.run(100).empty());
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const std::size_t row = m.s.row(ids[k]);
      ASSERT_EQ(m.s.alphas()[row], k % 2 == 0 ? 0.2f : 0.4f);
      ASSERT_EQ(m.s.stiffnesses()[row], k % 3 == 0 ? 0.5f : 1.0f);
      ASSERT_EQ(m.s.temperatures()[row], 310.0f + static_cast<float>(k));
    }
    for (const ParticleId id : others) {
      ASSERT_EQ(m.s.alphas()[m.s.row(id)], 0.3f);
      ASSERT_EQ(m.s.stiffnesses()[m.s.row(id)], 1.0f);
      ASSERT_EQ(m.s.temperatures()[m.s.row(id)], 300.0f);
    }
  }
}

// Yield strains of their own are there for the one, and what the material says for the other.
TEST(join, keeps_the_yield_of_both) {
  for (const bool on_first : {false, true}) {
    const auto run = [&](bool all) {
      Simulation s(solver());
      const MaterialId id = s.add_material(dough(0.05f));
      Body lower = lump(-5.2f, 1.5f), upper = lump(5.2f, -1.5f);
      if (all || on_first) lower.plastic_yield.assign(lower.positions.size(), 0.05f);
      if (all || !on_first) upper.plastic_yield.assign(upper.positions.size(), 0.05f);
      s.add_body(lower, id);
      s.add_body(upper, id);
      for (int k = 0; k < 100; ++k) s.step();
      EXPECT_EQ(s.body_count(), 1u);
      return s.state_hash();
    };
    EXPECT_EQ(run(true), run(false)) << on_first;
  }
}

TEST(join, lets_an_emitter_go_on_in_the_body_that_is_there) {
  SolverConfig config = solver();
  config.gravity = {0, 0, -0.3f};
  config.volume_iterations = 2;
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.8f});
  const MaterialId material = s.add_material(dough());
  Body base = lump(4.5f, 0, 4);
  const BodyId lower = s.add_body(base, material, "lump");
  const EmitterId emitter = s.add_emitter({.radius = 2.0f,
                                           .pose = {.translation = {0, 0, 16}, .rotation = {1, 0, 0, 0}},
                                           .speed = 1.2f,
                                           .most_particles = 1500,
                                           .merges = true},
                                          material);
  const BodyId strand = s.body(emitter);
  for (int k = 0; k < 400 && s.body_count() > 1; ++k) s.step();
  ASSERT_EQ(s.body_count(), 1u);
  EXPECT_EQ(s.body(emitter), lower);
  EXPECT_NE(strand, lower);
  const std::size_t before = s.particle_count();
  for (int k = 0; k < 100; ++k) s.step();
  EXPECT_GT(s.particle_count(), before + 100);
  EXPECT_EQ(s.rows(lower).end, s.particle_count());
  s.remove_emitter(emitter);
  s.step();
}

// Two bodies act on each other as two parts of one, until they are one: so they become one when those do.
TEST(join, comes_when_two_lumps_of_a_body_would_have_merged) {
  const auto step_of = [](bool one) {
    Simulation s(solver());
    Body lower = lump(-5.2f, 0), upper = lump(5.2f, 0);
    lower.velocities.assign(lower.positions.size(), {0, 0, 1.5f});
    upper.velocities.assign(upper.positions.size(), {0, 0, -1.5f});
    const MaterialId material = s.add_material(dough());
    const BodyId body = s.add_body(lower, material);
    if (one)
      s.extend_body(body, upper);
    else
      s.add_body(upper, material);
    for (int k = 0; k < 100; ++k) {
      s.step();
      for (const BodyEvent& event : s.events())
        if (event.kind == Kind::merged) return k;
    }
    return -1;
  };
  EXPECT_GT(step_of(false), 0);
  EXPECT_EQ(step_of(false), step_of(true));
}

TEST(join, lets_contacts_go_on_as_those_of_the_body_that_is_there) {
  Meeting m(3.0f);
  m.s.set_velocity(m.upper, {0, 0, 0});
  m.s.set_velocity(m.lower, {0, 0, 3});
  m.s.add_collider({.shape = Box{{-20, -20, 0}, {20, 20, 1}}, .pose = {.translation = {0, 0, 9.2}}});
  m.s.report_contacts(m.upper);
  std::string told;
  for (int k = 0; k < 200; ++k) {
    m.s.step();
    for (const BodyEvent& event : m.s.events()) {
      if (event.kind == Kind::touched) told += event.body == m.upper ? "upper touches, " : "lower touches, ";
      if (event.kind == Kind::parted) told += event.body == m.upper ? "upper parts, " : "lower parts, ";
      if (event.kind == Kind::merged) told += "merged, ";
    }
  }
  EXPECT_EQ(told, "upper touches, lower touches, merged, lower parts, ");
}

// Until they are one, nothing but viscosity rubs them: blocks of dough slid down each other at 20 degrees.
TEST(join, what_slides_until_it_is_one_is_warned_of) {
  const auto warns = [](bool merges, const Material& material, const std::string& words) {
    Simulation s({.time_step = 0.15f, .support_radius = 2.1f});
    const MaterialId id = s.add_material(material);
    for (const float up : {0.0f, 4.0f}) {
      Body body = sample(Lattice{.count = {4, 4, 4}, .corner = {0, 0, up}});
      body.merges = merges;
      s.add_body(body, id);
    }
    return std::ranges::any_of(s.info().warnings,
                               [&](const std::string& w) { return w.find(words) != w.npos; });
  };
  const std::string slides = "slides along bodies that it merges with", never = "never becomes one";
  const Material dough{.alpha = 0.3f, .plastic_yield = 0.1f};
  const Material melting{.alpha = {{1.0f, 0.3f}, {2.0f, 1.0f}}, .plastic_yield = 0.1f};
  EXPECT_FALSE(warns(true, dough, slides));
  EXPECT_TRUE(warns(true, melting, slides));
  EXPECT_FALSE(warns(true, melting, never));
  EXPECT_FALSE(warns(false, dough, slides));
  EXPECT_TRUE(warns(true, {.alpha = 0.1f}, never));
  EXPECT_FALSE(warns(true, {.alpha = 1.0f}, slides));
}

TEST(join, bodies_that_may_become_one_touch_and_rub_as_all_others_do_until_they_are) {
  const auto positions = [](bool merges, bool may_be_fluid) {
    SolverConfig tilted = solver();
    tilted.gravity = {0.1f, 0, -0.3f};
    Simulation s(tilted);
    s.add_collider({.shape = Plane{}, .friction = 1.0f});
    Material tough = dough(0.8f);
    tough.friction = 0.5f;
    if (may_be_fluid) tough.alpha = {{1e4f, 0.3f}, {2e4f, 1.0f}};
    const MaterialId id = s.add_material(tough);
    for (const float up : {0.5f, 5.0f}) {
      Body slab = sample(Lattice{.count = {8, 8, 4}, .corner = {0, 0, up}, .jitter = 0.1f});
      slab.merges = merges;
      s.add_body(slab, id);
    }
    for (int k = 0; k < 200; ++k) s.step();
    return s.positions_by_id();
  };
  const std::vector<Vec3> apart = positions(false, false);
  EXPECT_EQ(positions(true, false), apart);
  EXPECT_NE(positions(true, true), apart);  // those that melt must flow together
}

}  // namespace join_test
}  // namespace mallow
