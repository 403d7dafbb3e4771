#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "particles/particle_store.h"

namespace mallow {
namespace particle_store_test {

std::vector<Vec3> points(std::size_t count, float from) {
  std::vector<Vec3> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = Vec3(from + static_cast<float>(i), from, -from);
  return result;
}

void add(ParticleStore& store, std::size_t at, std::size_t count, float from) {
  store.insert(at, points(count, from), points(count, from + 0.5f));
}

TEST(particle_ids, count_from_0_as_long_as_nothing_is_removed) {
  ParticleStore store;
  add(store, 0, 5, 0);
  add(store, 2, 3, 100);
  const std::vector<ParticleId> expected{0, 1, 5, 6, 7, 2, 3, 4};
  EXPECT_TRUE(std::ranges::equal(store.id, expected));
  for (std::size_t row = 0; row < store.size(); ++row) EXPECT_EQ(store.slots.find(store.id[row]), row);
  EXPECT_TRUE(store.slots.generation.empty());
}

TEST(particle_ids, of_who_is_gone_never_name_who_came_after) {
  ParticleStore store;
  add(store, 0, 5, 0);
  store.erase(std::vector<std::uint32_t>{1, 3});
  EXPECT_EQ(store.slots.find(1), std::nullopt);
  EXPECT_EQ(store.slots.find(3), std::nullopt);
  add(store, 3, 3, 10);
  EXPECT_EQ(store.size(), 6u);
  EXPECT_EQ(store.slots.size(), 6u) << "slots are used again";
  EXPECT_EQ(store.slots.find(1), std::nullopt);
  EXPECT_EQ(store.slots.find(3), std::nullopt);
  EXPECT_EQ(store.slots.find(99), std::nullopt);
  EXPECT_EQ(slot_of(store.id[3]), 3u);
  EXPECT_EQ(generation_of(store.id[3]), 1u);
  EXPECT_EQ(store.id[5], 5u);
  EXPECT_EQ(store.slots.find(ParticleId{7} << 32 | 3), std::nullopt) << "a generation that is to come";
}

/// What a particle has, by its id.
struct Particle {
  Vec3 x, v;
  int pin;
  bool operator==(const Particle&) const = default;
};

std::map<ParticleId, Particle> content(const ParticleStore& store) {
  std::map<ParticleId, Particle> result;
  for (std::size_t row = 0; row < store.size(); ++row)
    result[store.id[row]] = {store.position.get(row), store.velocity.get(row),
                             store.pin.empty() ? 0 : store.pin[row]};
  return result;
}

TEST(particle_store, keeps_what_belongs_to_an_id_together_through_any_changes) {
  std::mt19937 random(5);
  ParticleStore store;
  add(store, 0, 300, 0);
  store.pin.resize(300);
  for (std::size_t row = 0; row < 300; row += 3) store.pin[row] = static_cast<std::uint16_t>(1 + row);
  std::map<ParticleId, Particle> expected = content(store);
  for (int change = 0; change < 200; ++change) {
    const std::size_t n = store.size();
    switch (random() % 3) {
      case 0: {
        const std::size_t at = random() % (n + 1), count = 1 + random() % 40;
        add(store, at, count, static_cast<float>(1000 * change));
        const auto now = content(store);
        for (std::size_t row = at; row < at + count; ++row) expected[store.id[row]] = now.at(store.id[row]);
        break;
      }
      case 1: {
        std::vector<std::uint32_t> rows;
        for (std::uint32_t row = 0; row < n; ++row) {
          if (random() % 8 != 0) continue;
          rows.push_back(row);
          expected.erase(store.id[row]);
        }
        store.erase(rows);
        break;
      }
      default: {
        const std::size_t begin = random() % n;
        std::vector<std::uint32_t> order(n - begin);
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::shuffle(order, random);
        const std::vector<ParticleId> before(store.id.begin(), store.id.end());
        store.permute(begin, order, 2);
        for (std::size_t k = 0; k < order.size(); ++k)
          ASSERT_EQ(store.id[begin + k], before[begin + order[k]]);
      }
    }
    ASSERT_EQ(content(store), expected) << "change " << change;
    for (std::size_t row = 0; row < store.size(); ++row) ASSERT_EQ(store.slots.find(store.id[row]), row);
    ASSERT_EQ(store.next_position.size(), store.size());
    ASSERT_EQ(store.next_velocity.size(), store.size());
  }
}

TEST(particle_store, stays_as_large_as_it_is_through_ten_thousand_births_and_deaths) {
  ParticleStore store;
  add(store, 0, 1000, 0);
  std::size_t after_some = 0;
  for (int k = 0; k < 10000; ++k) {
    store.erase(std::vector<std::uint32_t>{static_cast<std::uint32_t>(k * 37 % 1000)});
    add(store, 999, 1, static_cast<float>(k));
    if (k == 100) after_some = store.bytes();
  }
  EXPECT_EQ(store.bytes(), after_some);
  EXPECT_EQ(store.slots.size(), 1000u);
}

}  // namespace particle_store_test
}  // namespace mallow
