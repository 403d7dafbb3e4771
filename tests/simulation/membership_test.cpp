#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace membership_test {

using test::refusal;

SolverConfig solver() {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 2};
}
Body cube(int n, const Vec3& corner) {
  return sample(Lattice{.count = {n, n, n}, .spacing = 1, .corner = corner, .jitter = 0.05f});
}

TEST(removed_body, leaves_every_bit_of_the_others) {
  const auto run = [](bool removes) {
    Simulation s(solver());
    const BodyId first = s.add_body(cube(4, {0, 0, 3}), Material{});
    const BodyId gone = s.add_body(cube(5, {40, 0, 3}), Material{.alpha = 0.4f});
    const BodyId last = s.add_body(cube(6, {80, 0, 3}), Material{});
    s.add_collider({.shape = Plane{}});
    for (int k = 0; k < 30; ++k) s.step();
    if (removes) {
      s.remove_body(gone);
      EXPECT_EQ(s.body_count(), 2u);
      EXPECT_EQ(s.particle_count(), 64u + 216u);
      EXPECT_EQ(s.bodies(), (std::vector{first, last}));
    }
    for (int k = 0; k < 60; ++k) s.step();
    std::vector<Vec3> x;
    for (const BodyId body : {first, last}) {
      const Simulation::Rows rows = s.rows(body);
      for (std::size_t row = rows.begin; row < rows.end; ++row) x.push_back(s.positions()[row]);
    }
    return x;
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(removed_bodies, leave_the_same_bits_and_names_whether_they_go_together_or_one_by_one) {
  const auto run = [](bool together) {
    Simulation s(solver());
    std::vector<BodyId> bodies;
    for (int b = 0; b < 12; ++b)
      bodies.push_back(s.add_body(cube(3, {4.0f * static_cast<float>(b), 0, 1}), Material{.alpha = 0.3f}));
    s.add_collider({.shape = Plane{}});
    for (int k = 0; k < 10; ++k) s.step();
    std::vector<ParticleId> ids;
    for (const int b : {0, 3, 4, 7, 11}) {
      const Simulation::Rows rows = s.rows(bodies[static_cast<std::size_t>(b)]);
      const std::span<const ParticleId> own = s.ids().subspan(rows.begin, rows.end - rows.begin);
      ids.insert(ids.end(), own.begin(), own.end());
    }
    const Simulation::Rows cut = s.rows(bodies[8]);
    const std::span<const ParticleId> some = s.ids().subspan(cut.begin, 5);
    ids.insert(ids.end(), some.begin(), some.end());
    if (together) {
      s.remove_particles(ids);
    } else {
      s.remove_particles(std::span(ids).last(5));
      for (const int b : {11, 7, 4, 3, 0}) s.remove_body(bodies[static_cast<std::size_t>(b)]);
    }
    EXPECT_EQ(s.body_count(), 7u);
    EXPECT_THROW(s.rows(bodies[4]), ConfigError);
    EXPECT_EQ(s.rows(bodies[5]).begin, 54u);
    for (int k = 0; k < 20; ++k) s.step();
    return s.state_hash();
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(removed_body, is_told_from_whoever_gets_its_slot) {
  Simulation s(solver());
  const BodyId a = s.add_body(cube(3, {0, 0, 0}), Material{}, "a");
  const BodyId b = s.add_body(cube(3, {9, 0, 0}), Material{}, "b");
  const std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
  s.remove_body(a);
  EXPECT_NE(refusal([&] { s.rows(a); }).find("body 0 was removed"), std::string::npos);
  EXPECT_NE(refusal([&] { s.remove_body(a); }).find("body 0 was removed"), std::string::npos);
  EXPECT_NE(refusal([&] { s.row(ids[0]); }).find("particle 0 was removed"), std::string::npos);
  const BodyId c = s.add_body(cube(3, {0, 0, 0}), Material{}, "c");
  EXPECT_EQ(slot_of(c), slot_of(a));
  EXPECT_NE(c, a);
  EXPECT_THROW(s.rows(a), ConfigError);
  EXPECT_EQ(s.find_body("b"), b);
  EXPECT_EQ(s.find_body("a"), std::nullopt);
  EXPECT_EQ(s.name(c), "c");
}

TEST(removed_particles, leave_the_rest_of_a_turned_body_at_rest_where_it_rests) {
  for (const int stride : {1, 3}) {
    SCOPED_TRACE(stride);
    SolverConfig config = solver();
    config.gravity = {0, 0, 0};
    config.sleep_speed = 0;
    Simulation s(config);
    const BodyId id = s.add_body(cube(6, {0, 0, 0}), Material{.region_stride = stride});
    s.set_velocity(id, {0.1f, 0, 0}, {0, 0.2f, 0.1f});
    for (int k = 0; k < 60; ++k) s.step();
    s.set_velocity(id, {0, 0, 0}, {0, 0, 0});
    for (int k = 0; k < 400; ++k) s.step();
    const double strained = s.energy().elastic;
    const Aabb box = s.bounds(id);
    const Aabb corner{box.min - Vec3(1, 1, 1), 0.5f * (box.min + box.max)};
    const std::size_t removed = s.remove_particles(corner);
    EXPECT_GT(removed, 5u);
    EXPECT_EQ(s.particle_count(), 216 - removed);
    EXPECT_LE(s.energy().elastic, strained + 1e-6) << "no new strain";
    const std::vector<Vec3> before = s.positions_by_id();
    for (int k = 0; k < 20; ++k) s.step();
    const std::vector<Vec3> after = s.positions_by_id();
    double most = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      most = std::max(most, static_cast<double>((after[i] - before[i]).norm()));
    EXPECT_LT(most, 0.01) << "a new reference shape, or wrong rotations, would tear at it";
  }
}

TEST(removed_particles, take_a_body_with_them_when_they_are_all_of_it_and_are_refused_when_they_are_wrong) {
  Simulation s(solver());
  const BodyId a = s.add_body(cube(3, {0, 0, 0}), Material{}), b = s.add_body(cube(3, {9, 0, 0}), Material{});
  s.prepare();
  std::vector<ParticleId> all(s.ids().begin(), s.ids().end());
  std::ranges::sort(all);
  EXPECT_NE(refusal([&] {
              s.remove_particles(std::vector<ParticleId>{3, 99});
            }).find("no particle 99"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              s.remove_particles(std::vector<ParticleId>{3, 3});
            }).find("given twice"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              s.remove_particles(Aabb{{50, 0, 0}, {60, 9, 9}});
            }).find("no particle is between"),
            std::string::npos);
  EXPECT_EQ(s.particle_count(), 54u);
  s.remove_particles(std::span(all).first(30));
  EXPECT_THROW(s.rows(a), ConfigError);
  EXPECT_EQ(s.rows(b).end, 24u);
  s.step();
  s.remove_particles(std::span(all).subspan(30));
  EXPECT_EQ(s.body_count(), 0u);
  s.step();
  EXPECT_GT(s.time(), 0.1);
  s.add_body(cube(3, {0, 0, 0}), Material{});
  s.step();
  EXPECT_EQ(s.particle_count(), 27u);
}

TEST(extended_body, keeps_the_elastic_memory_of_what_was_there) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  Simulation s(config);
  const BodyId id = s.add_body(cube(6, {0, 0, 0}), Material{.deformation_damping = 0});
  s.prepare();
  // Pulled to a fifth more than its length.
  const Simulation::Rows rows = s.rows(id);
  const std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
  s.set_velocity(id, {0, 0, 0}, {0, 0, 0.15f});
  for (int k = 0; k < 40; ++k) s.step();
  const Vec3 rest = s.rest_position(ids[7]) - s.rest_position(ids[100]);
  const double before = s.energy().elastic;
  const Aabb box = s.bounds(id);
  Body more = cube(3, {box.max.x() + 0.6f, 2, 2});
  s.extend_body(id, more);
  EXPECT_EQ(s.rows(id).end - s.rows(id).begin, rows.end - rows.begin + 27);
  EXPECT_LT((s.rest_position(ids[7]) - s.rest_position(ids[100]) - rest).norm(), 1e-5f);
  EXPECT_LT(s.energy().elastic, 1.2 * before + 1e-3) << "what came is put where it would rest";
}

TEST(pins, are_let_go_and_their_slots_are_told_apart) {
  Simulation s(solver());
  const BodyId id = s.add_body(cube(3, {0, 0, 10}), Material{});
  const std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
  const PinId pin = s.pin(ids, {0, 0, 0});
  for (int k = 0; k < 10; ++k) s.step();
  const double height = s.motion(id).center_of_mass.z();
  EXPECT_NEAR(height, 11.5, 0.1);
  s.unpin(pin);
  for (int k = 0; k < 10; ++k) s.step();
  EXPECT_LT(s.motion(id).center_of_mass.z(), height - 0.2);
  EXPECT_NE(refusal([&] { s.unpin(pin); }).find("pin 0 was removed"), std::string::npos);
  const PinId next = s.pin(ids, {0, 0, 0});
  EXPECT_EQ(slot_of(next), slot_of(pin));
  EXPECT_THROW(s.set_velocity(pin, {1, 0, 0}), ConfigError);
  const Eigen::Vector3d from = s.motion(id).center_of_mass;
  s.move_pin(next, {3, 0, 1}, 2.0);
  s.advance(3);
  EXPECT_LT((s.motion(id).center_of_mass - from - Eigen::Vector3d(3, 0, 1)).norm(), 1e-4);
}

TEST(colliders, that_are_removed_let_go_and_keep_the_names_of_the_others) {
  Simulation s(solver());
  s.add_body(cube(3, {0, 0, 0}), Material{});
  const ColliderId floor = s.add_collider({.shape = Plane{}});
  const ColliderId wall =
      s.add_collider({.shape = Plane{.normal = {1, 0, 0}, .offset = -5}, .measure_load = true});
  for (int k = 0; k < 20; ++k) s.step();
  const double height = s.motion(BodyId{0}).center_of_mass.z();
  s.remove_collider(floor);
  EXPECT_EQ(s.load(wall).impulse.norm(), 0);
  EXPECT_EQ(s.collider_ids(), std::vector{wall});
  EXPECT_NE(refusal([&] { s.collider(floor); }).find("collider 0 was removed"), std::string::npos);
  for (int k = 0; k < 20; ++k) s.step();
  EXPECT_LT(s.motion(BodyId{0}).center_of_mass.z(), height - 0.5);
}

TEST(spawning, ten_thousand_times_leaves_memory_flat_and_the_bits_of_a_run_that_restarted) {
  const auto run = [](int restart) {
    SolverConfig config = solver();
    config.threads = 1;
    Simulation s(config);
    const MaterialId jelly = s.add_material(Material{});
    s.add_collider({.shape = Plane{}});
    std::vector<BodyId> alive;
    std::vector<std::size_t> bytes;
    for (int k = 0; k < 10'000; ++k) {
      alive.push_back(s.add_body(cube(2, {static_cast<float>(6 * (k % 5)), 0, 4}), jelly));
      if (alive.size() == 5) {
        s.remove_body(alive.front());
        alive.erase(alive.begin());
      }
      if (k % 10 == 0) s.step();
      if (k == restart) s = Simulation::restore(s.save(), 1);
      if (k == 1000 || k == 9999) bytes.push_back(s.info().bytes);
    }
    return std::tuple(s.state_hash(), bytes.front(), bytes.back());
  };
  const auto [hash, early, late] = run(-1);
  EXPECT_LE(late, early + early / 10);
  EXPECT_EQ(std::get<0>(run(4321)), hash);
}

TEST(verbs, give_what_they_say) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  Simulation s(config);
  const BodyId a = s.add_body(cube(4, {0, 0, 0}), Material{.particle_mass = 2}, "a");
  const BodyId b = s.add_body(cube(4, {10, 0, 0}), Material{}, "b");
  s.set_velocity(a, {1, 2, 3}, {0.1f, 0, 0.2f});
  BodyMotion motion = s.motion(a);
  EXPECT_LT((motion.velocity - Eigen::Vector3d(1, 2, 3)).norm(), 1e-5);
  EXPECT_LT((motion.angular_velocity - Eigen::Vector3d(0.1f, 0, 0.2f)).norm(), 1e-5);
  EXPECT_NEAR(motion.mass, 128, 1e-9);
  EXPECT_LT((motion.momentum - 128 * Eigen::Vector3d(1, 2, 3)).norm(), 1e-3);
  s.add_impulse(a, {-128, 0, 0});
  EXPECT_NEAR(s.motion(a).velocity.x(), 0, 1e-5);
  EXPECT_EQ(s.add_impulse({12, 2, 2}, 1.5f, {0, 0, 7}), s.particles_in({12, 2, 2}, 1.5f).size());
  EXPECT_NEAR(s.motion(b).momentum.z(), 7, 1e-4);
  EXPECT_EQ(s.add_impulse({100, 2, 2}, 1.5f, {0, 0, 7}), 0u);
  s.set_position(b, {20, 1, 1});
  EXPECT_LT((s.motion(b).center_of_mass - Eigen::Vector3d(20, 1, 1)).norm(), 1e-5);
  s.set_user_data(b, 77);
  EXPECT_EQ(Simulation::restore(s.save()).user_data(b), 77u);
  EXPECT_EQ(s.user_data(a), 0u);
  s.set_material(MaterialId{1}, {.alpha = 0.5f, .particle_mass = 3, .region_radius = 1.6f});
  EXPECT_NEAR(s.motion(b).mass, 192, 1e-9);
  s.step();
  s.set_gravity({0, 0, -1});
  const double before = s.motion(b).velocity.z();
  s.step();
  EXPECT_NEAR(s.motion(b).velocity.z(), before - 0.15, 1e-4);
}

TEST(verbs, give_a_turned_body_other_regions_without_a_blow) {
  SolverConfig config = solver();
  config.gravity = {0, 0, 0};
  config.rotation_iterations = 1;
  Simulation s(config);
  const BodyId id = s.add_body(cube(6, {0, 0, 0}), Material{});
  s.set_velocity(id, {0, 0, 0}, {0, 0.2f, 0.1f});
  for (int k = 0; k < 80; ++k) s.step();
  const double before = s.motion(id).kinetic_energy;
  s.set_material(MaterialId{0}, {.region_radius = 1.6f, .region_stride = 2});
  for (int k = 0; k < 5; ++k) s.step();
  EXPECT_NEAR(s.motion(id).kinetic_energy, before, 0.05 * before) << "rotations would start from none";
}

TEST(verbs, refuse_what_is_wrong) {
  Simulation s(solver());
  s.add_body(cube(3, {0, 0, 0}), Material{});
  const Vec3 bad(std::nanf(""), 0, 0);
  const std::vector<std::pair<std::function<void()>, const char*>> calls{
      {[&] { s.set_gravity(bad); }, "solver.gravity"},
      {[&] { s.set_velocity(BodyId{0}, bad); }, "body.velocity"},
      {[&] {
         s.set_velocity(BodyId{4}, {0, 0, 0});
       },
       "there is no body 4"},
      {[&] {
         s.set_velocity(std::vector<ParticleId>{0, 27}, {0, 0, 0});
       },
       "there is no particle 27"},
      {[&] { s.set_position(BodyId{0}, bad); }, "body.center"},
      {[&] { s.add_impulse(BodyId{0}, bad); }, "impulse"},
      {[&] {
         s.add_impulse({0, 0, 0}, 0, {1, 0, 0});
       },
       "radius: 0 is not allowed"},
      {[&] { s.set_material(MaterialId{0}, {.alpha = 2.0f}); }, "alpha"},
      {[&] { s.set_material(MaterialId{9}, {}); }, "there is no material 9"},
      {[&] {
         s.move_pin(PinId{0}, {1, 0, 0}, 1);
       },
       "there is no pin 0"},
      {[&] { s.remove_collider(ColliderId{0}); }, "there is no collider 0"},
      {[&] { s.enable(BodyId{7}, false); }, "there is no body 7"},
      {[&] {
         s.raycast({0, 0, 0}, {0, 0, 0});
       },
       "direction"},
      {[&] {
         s.raycast({0, 0, 0}, {0, 0, 1}, -1);
       },
       "farthest"},
      {[&] {
         s.particles_in({0, 0, 0}, -1);
       },
       "radius"},
      {[&] { s.nearest_particle(bad); }, "point"},
  };
  for (const auto& [call, text] : calls)
    EXPECT_NE(refusal(call).find(text), std::string::npos) << refusal(call);
  s.set_force([&](const ForceInput&, VectorSpan) { s.remove_body(BodyId{0}); });
  EXPECT_NE(refusal([&] { s.step(); }).find("a callback may not change"), std::string::npos);
}

TEST(verbs, keep_the_momentum_of_particles_that_are_thrown_whoever_moves_as_one) {
  for (const bool half : {false, true}) {
    SCOPED_TRACE(half);
    SolverConfig config = solver();
    config.gravity = {0, 0, 0};
    config.sleep_speed = 0;
    Simulation s(config);
    const BodyId id = s.add_body(cube(6, {0, 0, 0}), Material{.alpha = 0.1f});
    for (int k = 0; k < 10; ++k) s.step();
    std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
    if (half) ids.resize(ids.size() / 2);
    s.set_velocity(std::span<const ParticleId>(ids), {0, 0, 0.2f});
    const double given = s.motion(id).momentum.z();
    EXPECT_NEAR(given, 0.2 * static_cast<double>(ids.size()), 1e-2);
    for (int k = 0; k < 5; ++k) s.step();
    EXPECT_NEAR(s.motion(id).momentum.z(), given, 1e-4 * given);
  }
}

TEST(verbs, put_no_body_where_floats_do_not_tell_its_particles_apart) {
  Simulation s(solver());
  const BodyId id = s.add_body(cube(4, {0, 0, 0}), Material{});
  s.step();
  const std::uint64_t hash = s.state_hash();
  EXPECT_NE(refusal([&] { s.set_position(id, {1e30f, 0, 0}); }).find("body.center"), std::string::npos);
  EXPECT_NE(refusal([&] { s.set_position(id, {1e7f, 0, 0}); }).find("floats are steps"), std::string::npos);
  EXPECT_EQ(s.state_hash(), hash);
}

TEST(removed_particles, that_held_a_body_together_leave_it_torn_and_its_parts_to_themselves) {
  for (const int stride : {1, 3}) {
    SCOPED_TRACE(stride);
    SolverConfig config = solver();
    config.gravity = {0, 0, 0};
    config.sleep_speed = 0;
    Simulation s(config);
    const BodyId id = s.add_body(sample(Lattice{.count = {11, 6, 6}, .jitter = 0}),
                                 Material{.alpha = 0.1f, .region_stride = stride});
    s.step();
    s.remove_particles(Aabb{{3.5f, -9, -9}, {7.5f, 9, 9}});
    std::vector<ParticleId> right;
    for (const ParticleId particle : s.particles_in(Aabb{{7.5f, -9, -9}, {20, 9, 9}}))
      right.push_back(particle);
    ASSERT_FALSE(right.empty());
    s.set_velocity(std::span<const ParticleId>(right), {0.2f, 0, 0});
    s.step();
    std::size_t torn = 0;
    for (const BodyEvent& event : s.events())
      if (event.kind == BodyEvent::Kind::torn && event.body == id) torn = event.parts;
    EXPECT_EQ(torn, 2u);
    for (int k = 0; k < 40; ++k) s.step();
    double left = 0;
    for (const Vec3& x : s.positions_by_id())
      if (x.x() < 3.5f) left = std::max(left, static_cast<double>(x.x()));
    EXPECT_NEAR(left, 2.5, 1e-4) << "what stays is not drawn along";
  }
}

TEST(queries, find_what_a_ray_or_a_place_meets) {
  Simulation s(solver());
  const BodyId low = s.add_body(cube(4, {0, 0, 0}), Material{});
  const BodyId high = s.add_body(cube(4, {0, 0, 10}), Material{});
  const ColliderId floor = s.add_collider({.shape = Plane{}});
  s.add_collider({.shape = Sphere{.center = {30, 0, 5}, .radius = 2}});
  const std::optional<BodyHit> hit = s.raycast({2, 2, 50}, {0, 0, -2});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body, high);
  EXPECT_NEAR(hit->distance, 50 - 14, 0.5);
  EXPECT_GT(hit->normal.z(), 0.3f);
  EXPECT_NEAR((hit->position - s.positions_by_id()[hit->particle]).norm(), 0.75, 1e-4);
  s.enable(high, false);
  EXPECT_EQ(s.raycast({2, 2, 50}, {0, 0, -1})->body, low);
  EXPECT_FALSE(s.raycast({2, 2, 50}, {0, 0, -1}, 40));
  EXPECT_FALSE(s.raycast({2, 2, 50}, {0, 0, 1}));
  const std::optional<ColliderHit> ground = s.raycast_colliders({30, 0, 50}, {0, 0, -1});
  ASSERT_TRUE(ground);
  EXPECT_EQ(ground->collider, ColliderId{1});
  EXPECT_NEAR(ground->distance, 43, 1e-3);
  EXPECT_EQ(s.raycast_colliders({9, 9, 50}, {0, 0, -1})->collider, floor);
  for (const float length : {1e-44f, 1e-22f, 1e20f, 3e38f}) {
    EXPECT_NEAR(s.raycast_colliders({30, 0, 50}, {0, 0, -length})->distance, ground->distance, 1e-4);
    EXPECT_EQ(s.raycast_colliders({30, 0, 50}, {0, 0, length}), std::nullopt);
  }
  EXPECT_EQ(s.particles_in(Aabb{{-1, -1, -1}, {5, 5, 2}}).size(), 32u);
  const NearestParticle nearest = *s.nearest_particle({-3, -3, -3});
  EXPECT_EQ(nearest.body, low);
  for (const Vec3& x : s.positions_by_id()) ASSERT_GE((x - Vec3(-3, -3, -3)).norm(), nearest.distance - 1e-5);
  EXPECT_GT(s.bounds(low).max.x(), 3);
}

}  // namespace membership_test
}  // namespace mallow
