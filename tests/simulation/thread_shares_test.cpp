#include "simulation/thread_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace mallow {
namespace thread_shares_test {

Body cube(int n, float x) {
  return sample(Lattice{.count = {n, n, n}, .spacing = 1, .corner = {x, 0, 0}});
}
Simulation cubes(const std::vector<int>& sides, int threads) {
  Simulation s({.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .threads = threads});
  float x = 0;
  for (const int n : sides) {
    s.add_body(cube(n, x), Material{});
    x += static_cast<float>(n) + 20;
  }
  s.step();
  return s;
}

TEST(thread_shares, are_what_each_thread_begins_with) {
  const int threads = 3;
  const Simulation s = cubes({13, 5, 9}, threads);
  const std::vector<int> shares = thread_shares(s);
  // Rows of the blocks of a loop, in order: those of one body are in none of another.
  std::vector<std::size_t> firsts;
  for (const BodyId body : s.bodies())
    for (std::size_t row = s.rows(body).begin; row < s.rows(body).end; row += k_block) firsts.push_back(row);
  for (int place = 0; place < threads; ++place) {
    // One that comes first finds all blocks, its own before those of others.
    std::vector<std::size_t> taken;
    SharedBlocks(threads, firsts.size()).work(static_cast<std::size_t>(place), [&](std::size_t block) {
      taken.push_back(block);
    });
    const auto own = static_cast<std::size_t>(
        std::ranges::count_if(firsts, [&](std::size_t row) { return shares[row] == place; }));
    ASSERT_GE(own, firsts.size() / threads);
    for (std::size_t k = 0; k < taken.size(); ++k)
      EXPECT_EQ(shares[firsts[taken[k]]] == place, k < own) << "thread " << place << ", block " << taken[k];
  }
  EXPECT_EQ(std::ranges::count(shares, -1), 0);
}

TEST(thread_shares, of_one_thread_are_all_and_of_more_threads_than_blocks_some_have_none) {
  const std::vector<int> one = thread_shares(cubes({9}, 1));
  EXPECT_EQ(std::ranges::count(one, 0), 729);
  const std::vector<int> many = thread_shares(cubes({9}, 8));
  EXPECT_TRUE(std::ranges::is_sorted(many));
  EXPECT_EQ(many.front(), 0);
  EXPECT_EQ(many.back(), 2) << "as many threads join as there are blocks";
  for (const int thread : {0, 1})
    EXPECT_EQ(std::ranges::count(many, thread), static_cast<std::ptrdiff_t>(k_block));
}

TEST(thread_shares, of_what_does_not_move_are_nobodys) {
  Simulation s = cubes({5, 9}, 2);
  s.enable(s.bodies()[1], false);
  const std::vector<int> shares = thread_shares(s);
  const Simulation::Rows moving = s.rows(s.bodies()[0]);
  for (std::size_t row = 0; row < shares.size(); ++row)
    EXPECT_EQ(shares[row], row >= moving.begin && row < moving.end ? 0 : -1) << "row " << row;
}

}  // namespace thread_shares_test
}  // namespace mallow
