// What many bodies cost: what one costs, times their number.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <functional>

#include "mallow/errors.h"
#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace many_bodies_test {

using test::refusal;

Vec3 place(std::size_t body, std::size_t across, float pitch) {
  return pitch * Vec3(static_cast<float>(body % across), static_cast<float>(body / across % across),
                      static_cast<float>(body / across / across));
}

Body cube(int n, const Vec3& corner) {
  return sample(Lattice{.count = {n, n, n}, .spacing = 1, .corner = corner, .jitter = 0});
}

double seconds(const std::function<void()>& what) {
  const std::clock_t before = std::clock();
  what();
  return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

/// Processor time of what happens to bodies [s a body].
struct Cost {
  double adding, preparing, stepping, telling;
};

struct Crowd {
  int points;  ///< along an edge of a body
  float alpha, pitch;
  bool merges;
};

Cost cost(const Crowd& crowd, std::size_t across) {
  // One thread: others would spin, and that is processor time too.
  Simulation s(
      SolverConfig{.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -0.1f}, .threads = 1});
  const MaterialId material = s.add_material(Material{.alpha = crowd.alpha});
  const std::size_t bodies = across * across * across;
  const auto each = static_cast<double>(bodies);
  Cost cost{};
  cost.adding = seconds([&] {
                  for (std::size_t b = 0; b < bodies; ++b) {
                    Body body = cube(crowd.points, place(b, across, crowd.pitch));
                    body.merges = crowd.merges;
                    s.add_body(body, material);
                  }
                }) /
                each;
  s.add_collider({.shape = Plane{}});
  cost.preparing = seconds([&] { s.prepare(); }) / each;
  cost.stepping = 1;
  double slowest = 0;  // fluids are sorted in the second
  for (int k = 0; k < 4; ++k) slowest = std::max(slowest, seconds([&] { s.step(); }) / each);
  cost.stepping = slowest;
  cost.telling = seconds([&] { s.info(); }) / each;
  return cost;
}

Cost least(const Cost& a, const Cost& b) {
  return {std::min(a.adding, b.adding), std::min(a.preparing, b.preparing), std::min(a.stepping, b.stepping),
          std::min(a.telling, b.telling)};
}

// What grows with the square of their number would be eight times as much for each. Of eight times as many
// less fits into caches.
constexpr double k_most = 3;
// Less for each than this is not measured: a clock's tick.
constexpr double k_least = 1e-6;

/// What else runs takes caches and processors away: the least of all tries counts, and there are more of them
/// where it is too much.
constexpr int k_tries = 6;

bool holds(double few, double many) {
  return many <= k_most * std::max(few, k_least);
}

/// cost(across): of each of so many [s].
void expect_no_more_for_each(const std::function<double(std::size_t)>& cost, std::size_t across_many) {
  double few = 1, many = 1;
  for (int attempt = 0; attempt < k_tries && (attempt == 0 || !holds(few, many)); ++attempt) {
    few = std::min(few, cost(11));
    many = std::min(many, cost(across_many));
  }
  EXPECT_TRUE(holds(few, many)) << 1e6 * few << " us for each of few, " << 1e6 * many << " of many";
}

class many_bodies : public testing::TestWithParam<Crowd> {};

TEST_P(many_bodies, cost_what_few_do_for_each) {
  Cost few{1, 1, 1, 1}, many = few;
  const auto all_hold = [&] {
    return holds(few.adding, many.adding) && holds(few.preparing, many.preparing) &&
           holds(few.stepping, many.stepping) && holds(few.telling, many.telling);
  };
  for (int attempt = 0; attempt < k_tries && (attempt < 2 || !all_hold()); ++attempt) {
    few = least(few, cost(GetParam(), 11));
    many = least(many, cost(GetParam(), 22));
  }
  const auto check = [](const char* what, double before, double after) {
    EXPECT_TRUE(holds(before, after))
        << what << ": " << 1e6 * before << " us for each of few, " << 1e6 * after << " of many";
  };
  check("adding", few.adding, many.adding);
  check("preparing", few.preparing, many.preparing);
  check("stepping", few.stepping, many.stepping);
  check("telling", few.telling, many.telling);
}

INSTANTIATE_TEST_SUITE_P(of_a_crowd, many_bodies,
                         testing::Values(Crowd{1, 1, 1, false}, Crowd{1, 1, 1, true}, Crowd{1, 1, 6, false},
                                         Crowd{2, 0, 2, false}, Crowd{2, 0, 6, false}));

/// Bodies of one particle that have all fallen asleep, each on its own.
Simulation sleeping_crowd(std::size_t across) {
  Simulation s(SolverConfig{.time_step = 0.15f,
                            .support_radius = 2.1f,
                            .gravity = {0, 0, 0},
                            .sleep_speed = 1.0f,
                            .sleep_time = 0.1f});
  const MaterialId material = s.add_material(Material{});
  for (std::size_t b = 0; b < across * across * across; ++b)
    s.add_body(cube(1, place(b, across, 6)), material);
  while (std::ranges::any_of(s.bodies(), [&](BodyId body) { return s.is_awake(body); })) s.step();
  return s;
}

/// Processor time, for each of a crowd that sleeps, of a call for it [s].
double cost_of_waking(std::size_t across) {
  Simulation s = sleeping_crowd(across);
  const std::vector<BodyId> bodies = s.bodies();
  return seconds([&] {
           for (const BodyId body : bodies) s.wake(body);
         }) /
         static_cast<double>(bodies.size());
}

TEST(many_bodies_that, sleep_wake_for_what_few_cost_each) {
  expect_no_more_for_each(cost_of_waking, 22);
}

/// Processor time of a step, for each of a crowd of bodies that have flowed and may become one [s].
double cost_of_looking_for_pressed(std::size_t across) {
  Simulation s(
      SolverConfig{.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .update_interval = 2});
  const MaterialId material = s.add_material(Material{.plastic_yield = 0.0f, .merge_flow = 0});
  const std::size_t bodies = across * across * across;
  for (std::size_t b = 0; b < bodies; ++b) {
    Body body = cube(2, place(b, across, 6));
    for (const Vec3& x : body.positions)
      body.velocities.push_back({0.1f * (x.z() - body.positions[0].z()), 0, 0});
    body.merges = true;
    s.add_body(body, material);
  }
  for (int k = 0; k < 4; ++k) s.step();
  double least = 1;
  for (int k = 0; k < 3; ++k) least = std::min(least, seconds([&] { s.step(), s.step(); }));
  return least / static_cast<double>(bodies);
}

TEST(many_bodies_that, have_flowed_look_for_each_other_for_what_few_cost_each) {
  expect_no_more_for_each(cost_of_looking_for_pressed, 27);
}

/// Processor time of taking most bodies of a crowd that sleeps out, all in one call, for each [s].
double cost_of_removing(std::size_t across) {
  Simulation s = sleeping_crowd(across);
  std::vector<ParticleId> ids(s.ids().begin(), s.ids().end());
  std::ranges::sort(ids);
  ids.resize(ids.size() - 9);
  const double all = seconds([&] { s.remove_particles(ids); });
  EXPECT_EQ(s.body_count(), 9u);
  return all / static_cast<double>(ids.size());
}

TEST(many_bodies_that, are_removed_together_go_for_what_few_cost_each) {
  expect_no_more_for_each(cost_of_removing, 22);
}

TEST(overlap, is_found_among_many_bodies_wherever_they_have_come) {
  Simulation s(SolverConfig{.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}});
  const MaterialId material = s.add_material(Material{});
  std::vector<BodyId> bodies;
  for (std::size_t b = 0; b < 100; ++b) bodies.push_back(s.add_body(cube(2, place(b, 5, 4)), material));
  const auto refuses = [&](const Vec3& corner) {
    return refusal([&] { s.add_body(cube(2, corner), material, "new"); }).find("overlap") !=
           std::string::npos;
  };
  EXPECT_TRUE(refuses(place(57, 5, 4)));
  s.set_position(bodies[57], {501, 1, 1});
  EXPECT_TRUE(refuses({500, 0, 0}));
  EXPECT_TRUE(refuses(place(99, 5, 4)));
  EXPECT_FALSE(refuses(place(57, 5, 4)));
  s.remove_body(bodies[3]);
  EXPECT_FALSE(refuses(place(3, 5, 4)));
  for (std::size_t b = 0; b < 40; ++b) s.add_body(cube(2, Vec3(0, 0, 100) + place(b, 5, 4)), material);
  s.set_velocity(bodies[0], {0, -1, 0});
  EXPECT_TRUE(refuses({0, 0, 0}));
  for (int k = 0; k < 14; ++k) s.step();
  EXPECT_FALSE(refuses({0, 0, 0}));
}

}  // namespace many_bodies_test
}  // namespace mallow
