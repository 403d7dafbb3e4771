#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "levels.h"
#include "mallow/mallow.h"
#include "sph/sph.h"

namespace mallow {
namespace neighbor_slack_test {

constexpr float k_radius = 1;

/// Random points that swirl, drift together, and now and then leap.
struct Swarm {
  VectorColumn x;
  std::mt19937 random{5};

  explicit Swarm(std::size_t n = 400) : x(n) {
    std::uniform_real_distribution<float> coordinate(0, 4);
    for (std::size_t i = 0; i < n; ++i)
      x.set(i, {coordinate(random), coordinate(random), coordinate(random)});
  }
  void move(float restlessness, const Vec3& drift) {
    std::uniform_real_distribution<float> shake(-restlessness, restlessness);
    for (std::size_t i = 0; i < x.size(); ++i)
      x.set(i, x.get(i) + drift + Vec3(shake(random), shake(random), shake(random)));
  }
};

Sph sph_with_slack(float slack, std::size_t n) {
  Sph sph;
  sph.support_radius = k_radius;
  sph.factors = kernel_factors(static_cast<double>(k_radius));
  sph.neighbor_slack = slack;
  sph.groups = {{1, 1, 1, 1, 16, 1, 0, 0}};
  sph.bodies = {{n, 0}};
  return sph;
}

/// Pairs within the radius that the lists do not have, and listed places whose position is not that of their
/// row.
std::size_t faults(const Sph& sph, const VectorColumn& x) {
  std::size_t count = 0;
  std::vector<std::size_t> place(x.size());
  for (std::size_t s = 0; s < x.size(); ++s) {
    place[sph.grid.order[s]] = s;
    count += sph.grid.sorted.get(s) != x.get(sph.grid.order[s]);
  }
  const auto& clusters = sph.grid.cluster_start;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto behind = std::upper_bound(clusters.begin(), clusters.end(), place[i]);
    const auto list = sph.lists.of(static_cast<std::size_t>(behind - clusters.begin()) - 1);
    for (std::size_t j = 0; j < x.size(); ++j)
      if ((x.get(i) - x.get(j)).norm() <= k_radius)
        count += std::find(list.begin(), list.end(), place[j]) == list.end();
  }
  return count;
}

TEST(neighbor_slack, lists_always_hold_every_pair_within_the_radius) {
  for (const float slack : {0.02f, 0.1f, 0.3f}) {
    Swarm swarm;
    Sph sph = sph_with_slack(slack, swarm.x.size());
    int found = 0, kept = 0;
    for (int step = 0; step < 60; ++step) {
      ++(find_neighbors(swarm.x, {2, best_instruction_level()}, sph) ? found : kept);
      ASSERT_EQ(faults(sph, swarm.x), 0u) << "slack " << slack << ", step " << step;
      swarm.move(step % 20 == 19 ? 0.5f : 0.004f, {0.3f, -0.2f, 0.1f});
    }
    EXPECT_GE(found, 3) << slack << ": at the start and after each leap";
    EXPECT_GT(kept, 0) << slack;
  }
}

TEST(neighbor_slack, a_common_motion_keeps_lists_and_one_stray_does_not) {
  Swarm swarm;
  Sph sph = sph_with_slack(0.1f, swarm.x.size());
  EXPECT_TRUE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph));
  swarm.move(0, {100, -50, 25});
  EXPECT_FALSE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph));
  swarm.x.set(7, swarm.x.get(7) + Vec3(0.049f, 0, 0));
  EXPECT_FALSE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph)) << "just within half the slack";
  swarm.x.set(7, swarm.x.get(7) + Vec3(0.002f, 0, 0));
  EXPECT_TRUE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph)) << "just beyond";
}

TEST(neighbor_slack, without_it_nothing_is_kept) {
  Swarm swarm;
  Sph sph = sph_with_slack(0, swarm.x.size());
  EXPECT_TRUE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph));
  EXPECT_TRUE(find_neighbors(swarm.x, {2, best_instruction_level()}, sph));
  EXPECT_EQ(sph.kept.bytes(), 0u);
}

/// Paste that yields at every check, dropped beside a fluid on a slope. No distance of the lattice is the
/// radius: rounding would decide who is in a region.
Simulation wet_scene(float slack, int threads = 2) {
  SolverConfig config{
      .support_radius = 2.1f, .update_interval = 8, .neighbor_slack = slack, .threads = threads};
  Simulation simulation(config);
  simulation.add_body(sample(Lattice{.count = {6, 6, 6}, .spacing = 1, .corner = {0, 0, 1}, .jitter = 0}),
                      Material{.alpha = 0.6f, .update_threshold = 0});
  simulation.add_body(sample(Lattice{.count = {5, 5, 5}, .spacing = 1, .corner = {1, 1, 8}, .jitter = 0}),
                      Material{.alpha = 1});
  simulation.add_collider({.shape = Plane{{0.1f, 0, 1}, 0}, .friction = 0.3f});
  return simulation;
}

TEST(neighbor_slack, changes_a_motion_by_rounding_only) {
  Simulation without = wet_scene(0), with = wet_scene(0.2f);
  int found = 0, updates = 0;
  for (int step = 0; step < 24; ++step) {
    without.step();
    const StepReport report = with.step();
    found += report.neighbors_found;
    updates += report.updated_references;
    EXPECT_TRUE(report.neighbors_found || report.updated_references == 0) << "rows were sorted";
  }
  EXPECT_GT(updates, 0);
  EXPECT_LT(found, 24);
  const auto a = without.positions_by_id(), b = with.positions_by_id();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 2e-4f) << i;
}

TEST(neighbor_slack, gives_the_same_bits_for_any_number_of_threads) {
  Simulation one = wet_scene(0.1f, 1);
  for (int step = 0; step < 40; ++step) one.step();
  for (const int threads : {2, 3, 4}) {
    Simulation several = wet_scene(0.1f, threads);
    for (int step = 0; step < 40; ++step) several.step();
    EXPECT_EQ(several.state_hash(), one.state_hash()) << threads;
  }
}

TEST(neighbor_slack, a_falling_body_finds_its_neighbors_once) {
  SolverConfig config{.support_radius = 2, .neighbor_slack = 0.1f};
  Simulation simulation(config);
  simulation.add_body(sample(Lattice{.count = {6, 6, 6}, .spacing = 1, .jitter = 0}),
                      Material{.alpha = 0.5f});
  EXPECT_TRUE(simulation.step().neighbors_found);
  for (int step = 0; step < 50; ++step) EXPECT_FALSE(simulation.step().neighbors_found) << step;
}

TEST(neighbor_slack, a_body_that_is_added_is_found) {
  Simulation simulation = wet_scene(0.5f);
  simulation.step();
  simulation.add_body(sample(Lattice{.count = {3, 3, 3}, .spacing = 1, .corner = {30, 0, 9}, .jitter = 0}),
                      Material{.alpha = 1});
  EXPECT_TRUE(simulation.step().neighbors_found);
}

}  // namespace neighbor_slack_test
}  // namespace mallow
