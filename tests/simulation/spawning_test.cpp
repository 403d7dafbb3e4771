// Bodies that are spawned and removed for as long as a game lasts: their materials go with them, and what
// they are called is found at once.
#include <gtest/gtest.h>

#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace spawning_test {

using test::refusal;

SolverConfig solver() {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .threads = 1};
}
Body cube(int n, float x) {
  return sample(Lattice{.count = {n, n, n}, .spacing = 1, .corner = {x, 0, 0}, .jitter = 0});
}

std::size_t bytes_of(const SavedState& saved) {
  std::size_t bytes = 0;
  for (const Chunk& chunk : saved.chunks) bytes += chunk.bytes.size();
  return bytes;
}

TEST(own_material, goes_with_its_body_so_that_ten_thousand_spawns_leave_nothing) {
  Simulation s(solver());
  s.add_body(cube(2, -20), Material{}, "stays");
  const Body ball = cube(1, 0);
  std::size_t after_ten = 0;
  for (int k = 1; k <= 10000; ++k) {
    const BodyId body = s.add_body(ball, Material{.alpha = 1.0f}, "ball");
    s.remove_body(body);
    if (k == 10) after_ten = bytes_of(s.save());
  }
  EXPECT_EQ(bytes_of(s.save()), after_ten);
}

TEST(own_material, that_is_gone_is_told_and_never_taken_for_the_next_one) {
  Simulation s(solver());
  const MaterialId shared = s.add_material({.alpha = 0.5f});
  const BodyId first = s.add_body(cube(2, 0), Material{.alpha = 0.1f});
  const MaterialId own = s.material(first);
  s.remove_body(first);
  const BodyId second = s.add_body(cube(2, 0), Material{.alpha = 0.2f});
  EXPECT_EQ(slot_of(s.material(second)), slot_of(own)) << "its slot is used again";
  EXPECT_NE(s.material(second), own);
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { s.set_material(own, {}); }, [&] { s.set_alpha(own, 0.3f); },
           [&] { s.material_settings(own); }, [&] { s.add_body(cube(2, 9), own); }})
    EXPECT_NE(refusal(call).find("material 1 was removed"), std::string::npos) << refusal(call);
  EXPECT_EQ(s.material_settings(s.material(second)).alpha.at(0), 0.2f);
  EXPECT_EQ(s.material_settings(shared).alpha.at(0), 0.5f) << "without bodies too";
}

TEST(own_material, lasts_as_long_as_anybody_is_made_of_it) {
  Simulation s(solver());
  const BodyId first = s.add_body(cube(2, 0), Material{.alpha = 0.1f});
  const MaterialId own = s.material(first);
  const BodyId second = s.add_body(cube(2, 9), own);
  Body bar = sample(Lattice{.count = {12, 2, 2}, .spacing = 1, .corner = {0, 20, 0}, .jitter = 0});
  bar.splits = true;
  const BodyId torn = s.add_body(bar, own);
  s.remove_body(first);
  EXPECT_EQ(s.material(second), own);
  s.step();
  s.remove_particles(Aabb{{4, 19, -1}, {8, 23, 3}});
  s.step();
  ASSERT_EQ(s.body_count(), 3u) << "the bar is in two";
  s = Simulation::restore(s.save(), 1);  // which knows who is made of what
  s.remove_body(second);
  s.remove_body(torn);
  EXPECT_EQ(s.material_settings(own).alpha.at(0), 0.1f) << "a part of the bar is left";
  s.remove_body(s.bodies().front());
  EXPECT_NE(refusal([&] { s.material_settings(own); }).find("was removed"), std::string::npos);
  EXPECT_EQ(s.body_count(), 0u);
}

TEST(own_material, of_a_body_that_is_refused_leaves_no_trace) {
  Simulation s(solver());
  s.add_body(cube(2, 0), Material{});
  s.prepare();
  const std::size_t bytes = bytes_of(s.save());
  EXPECT_NE(refusal([&] { s.add_body(cube(2, 0.05f), Material{}); }).find("spacing"), std::string::npos);
  EXPECT_EQ(bytes_of(s.save()), bytes);
  EXPECT_EQ(s.material(s.add_body(cube(2, 9), Material{})), MaterialId{1});
}

TEST(own_material, changes_no_bit_of_what_moves_whether_others_came_and_went_before) {
  const auto run = [](bool spawned) {
    Simulation s(solver());
    if (spawned) s.remove_body(s.add_body(cube(2, 40), Material{.alpha = 0.9f}));
    const BodyId body = s.add_body(cube(4, 0), Material{.alpha = 0.3f});
    s.set_velocity(body, {0, 0, 0}, {0.1f, 0.2f, 0});
    for (int k = 0; k < 30; ++k) s.step();
    std::vector<Vec3> x;
    for (std::size_t row = 0; row < s.particle_count(); ++row) x.push_back(s.positions()[row]);
    return x;
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(name, finds_the_first_of_its_bodies_whoever_came_went_split_or_was_restored) {
  Simulation s(solver());
  const MaterialId material = s.add_material({});
  const auto is_first = [&](const char* name) {
    for (const BodyId body : s.bodies())
      if (s.name(body) == name) return s.find_body(name) == body;
    return !s.find_body(name);
  };
  Body bar = sample(Lattice{.count = {12, 2, 2}, .spacing = 1, .corner = {0, 20, 0}, .jitter = 0});
  bar.splits = true;
  s.add_body(bar, material, "bar");
  EXPECT_TRUE(is_first("bar"));
  std::vector<BodyId> balls;
  for (int k = 0; k < 5; ++k)
    balls.push_back(s.add_body(cube(2, 9 * static_cast<float>(k)), material, "ball"));
  s.add_body(cube(2, -9), material, "bar, part 2");
  s.add_body(cube(2, -18), material);
  const std::vector<const char*> names = {"bar", "ball", "bar, part 2", "bar, part 3", "body 7", "nobody"};
  const auto look = [&] {
    for (const char* name : names) EXPECT_TRUE(is_first(name)) << name;
  };
  look();
  s.step();
  s.remove_particles(Aabb{{4, 19, -1}, {8, 23, 3}});
  s.step();
  ASSERT_EQ(s.name(s.bodies()[1]), "bar, part 3") << "a name of its own, before the ball";
  look();
  s.remove_body(balls[0]);
  s.remove_body(balls[3]);
  look();
  s.add_body(cube(2, 0), material, "ball");  // in the slot of one that is gone, behind all others
  look();
  s = Simulation::restore(s.save(), 1);
  look();
  for (const BodyId body : s.bodies()) s.remove_body(body);
  look();
}

TEST(name, is_found_without_a_look_at_every_body) {
  Simulation s(solver());
  const MaterialId material = s.add_material({.alpha = 1.0f});
  constexpr int k_bodies = 20000;
  for (int k = 0; k < k_bodies; ++k)
    s.add_body(cube(1, 3 * static_cast<float>(k)), material, "body of number " + std::to_string(k));
  const auto seconds = [&](int finds) {
    const std::clock_t before = std::clock();
    for (int k = 0; k < finds; ++k)
      EXPECT_TRUE(s.find_body("body of number " + std::to_string(k_bodies - 1 - k)));
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  const double first = seconds(1);
  EXPECT_LT(seconds(1000), 10 * first + 0.01) << "the first one looks at all of them";
}

}  // namespace spawning_test
}  // namespace mallow
