#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "mallow/mallow.h"
#include "refusal.h"

namespace mallow {
namespace checkpoint_test {

SolverConfig config(float neighbor_slack = 0) {
  SolverConfig c;
  c.time_step = 0.15f;
  c.support_radius = 2.0f;
  c.update_interval = 10;
  c.neighbor_slack = neighbor_slack;
  c.threads = 2;
  return c;
}

Body cube(int side, const Vec3& corner) {
  return sample(Lattice{{side, side, side}, 1.0f, corner, 0});
}

void twist(const ForceInput& in, VectorSpan a) {
  a.eigen().col(0) -= 0.05f * in.positions.eigen().col(1);
}

struct Case {
  const char* name;
  std::function<Simulation()> build;
  ForceCallback force = {};
  bool updates = true;  ///< reference shapes are updated on the way
};

Simulation elastic() {
  Simulation s(config());
  s.add_body(cube(7, {0, 0, 0.6f}), Material{.alpha = 0, .update_threshold = 0.1f});
  s.add_collider({.shape = Plane{{0.1f, 0, 1}, 0}, .friction = 0.3f});
  return s;
}

Simulation every_third_region() {
  Simulation s(config());
  s.add_body(cube(7, {0, 0, 0.6f}), Material{.alpha = 0.3f, .update_threshold = 0.5f, .region_stride = 3});
  s.add_collider({.shape = Plane{}});
  return s;
}

/// Turns round several times, each step by as much as one iteration can just follow.
Simulation spinning() {
  SolverConfig c = config();
  c.gravity = {0, 0, 0};
  c.rotation_iterations = 1;
  Simulation s(c);
  Body body = cube(6, {-3, -3, -3});
  for (const Vec3& x : body.positions) body.velocities.push_back(Vec3(0.3f, 0.2f, 0.9f).cross(x));
  s.add_body(body, Material{.alpha = 0});
  return s;
}

/// From liquid to solid and back, so that regions are built on the way and left alone later.
Simulation alpha_that_changes() {
  Simulation s(config());
  s.add_body(cube(7, {0, 0, 0.6f}),
             Material{.alpha = {{0, 1}, {3, 1}, {6, 0.2f}, {12, 0.2f}, {15, 1}}, .update_threshold = 0.2f});
  s.add_collider({.shape = Plane{}});
  return s;
}

Simulation fluid(float neighbor_slack) {
  Simulation s(config(neighbor_slack));
  s.add_body(cube(7, {0, 0, 0.6f}), Material{.alpha = 1});
  s.add_collider({.shape = Box{{-1, -1, 0}, {12, 8, 20}, true}});
  return s;
}

/// Groups, a body that comes later to one of them, obstacles of every kind that move, pins.
Simulation everything(float neighbor_slack) {
  Simulation s(config(neighbor_slack));
  const BodyId jelly =
      s.add_body(cube(6, {0, 0, 1}), Material{.alpha = 0.5f, .update_threshold = 0.1f}, "jelly");
  s.add_body(cube(5, {2, 2, 8}), Material{.alpha = {{0, 1}, {3, 0.2f}}, .region_stride = 3}, "thickening");
  s.add_body(cube(5, {-7, 0, 1}), Material{.alpha = 0, .particle_mass = 2.0f}, "solid");
  s.add_body(cube(4, {9, 0, 1}), Material{.alpha = 1}, "liquid");
  s.extend_body(jelly, cube(4, {20, 0, 1}));
  s.add_collider({.shape = Plane{{0.1f, 0, 1}, 0}, .friction = 0.3f});
  s.add_collider(
      {.shape = Union{{Sphere{{4, 4, 0}, 2}, Box{{-3, -3, 0}, {-1, -1, 3}}}}, .velocity = {0, 0.1f, 0}});
  s.add_collider({.shape = Sphere{{0, 0, 0}, 90, true}, .restitution = 0.5f});
  const PinId pin = s.pin(Aabb{{-7, 0, 1}, {-5, 5, 2}}, {0, 0, 0.05f});
  s.set_velocity(pin, {0, 0.01f, 0.05f});
  return s;
}

/// Kept relative to a point near it, and so are the obstacles.
Simulation far_away() {
  const Vec3 at(98765, -123456, 65432);
  Simulation s(config());
  s.add_collider({.shape = Plane{{0.1f, 0, 1}, Vec3(0.1f, 0, 1).dot(at)}, .friction = 0.3f});
  s.add_body(cube(6, at + Vec3(0, 0, 1)), Material{.alpha = 0.5f, .update_threshold = 0.1f});
  s.add_body(cube(4, at + Vec3(1, 1, 8)), Material{.alpha = 1});
  s.add_collider({.shape = Sphere{at + Vec3(4, 4, 0), 2}, .velocity = {0, 0.1f, 0}});
  return s;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> k_cases = {
      {"elastic", elastic},
      {"every_third_region", every_third_region},
      {"alpha_that_changes", alpha_that_changes},
      {"spinning", spinning, {}, false},
      {"far_away", far_away},
      {"fluid", [] { return fluid(0); }, {}, false},
      {"fluid_with_kept_lists", [] { return fluid(0.2f); }, {}, false},
      {"everything", [] { return everything(0); }, twist},
      {"everything_with_kept_lists", [] { return everything(0.15f); }, twist},
  };
  return k_cases;
}

Simulation start(const Case& which) {
  Simulation s = which.build();
  s.set_force(which.force);
  return s;
}

Simulation restored(const SavedState& saved, int threads, const Case& which) {
  Simulation s = Simulation::restore(saved, threads);
  s.set_force(which.force);
  return s;
}

void expect_equal(const SavedState& a, const SavedState& b, const std::string& where) {
  ASSERT_EQ(a.chunks.size(), b.chunks.size());
  for (std::size_t k = 0; k < a.chunks.size(); ++k) {
    EXPECT_EQ(a.chunks[k].name, b.chunks[k].name);
    EXPECT_TRUE(a.chunks[k].bytes == b.chunks[k].bytes) << where << ", chunk " << a.chunks[k].name;
  }
}

class checkpoint : public testing::TestWithParam<std::size_t> {
 protected:
  const Case& which() const { return cases()[GetParam()]; }
};

/// Before the first step, around updates of reference shapes (10, 20, 60), around sorts of fluids (61), where
/// lists are kept and where they are not.
constexpr int k_saved_at[] = {0, 1, 7, 9, 10, 11, 19, 20, 21, 33, 59, 60, 61, 62, 80, 100};
constexpr int k_steps = 200;

TEST_P(checkpoint, continues_with_the_same_bits) {
  Simulation s = start(which());
  std::vector<SavedState> saved;
  std::vector<std::uint64_t> hashes;
  std::vector<std::vector<ParticleId>> orders;
  bool kept = false;
  int updates = 0;
  for (int step = 0; step <= k_steps; ++step) {
    if (std::ranges::find(k_saved_at, step) != std::end(k_saved_at)) saved.push_back(s.save());
    hashes.push_back(s.state_hash());
    orders.emplace_back(s.ids().begin(), s.ids().end());
    const StepReport report = s.step();
    kept = kept || !report.neighbors_found;
    updates += report.updated_references;
  }
  const std::string name = which().name;
  EXPECT_TRUE(kept || name.find("kept") == std::string::npos);
  EXPECT_EQ(updates > 0, which().updates);

  for (std::size_t k = 0; k < saved.size(); ++k) {
    const int threads = 1 + static_cast<int>(k) % 3;
    Simulation again = restored(saved[k], threads, which());
    const std::string where = name + " saved at " + std::to_string(k_saved_at[k]);
    for (int step = k_saved_at[k]; step <= k_steps; ++step) {
      ASSERT_EQ(again.state_hash(), hashes[static_cast<std::size_t>(step)]) << where << ", step " << step;
      ASSERT_TRUE(std::ranges::equal(again.ids(), orders[static_cast<std::size_t>(step)]))
          << where << ", step " << step;
      again.step();
    }
  }
}

/// Step 21 updates reference shapes; 61 sorts fluids.
TEST_P(checkpoint, gives_one_state_however_often_a_step_is_taken_from_it) {
  Simulation s = start(which());
  for (const int moment : {20, 60}) {
    while (s.step_count() < moment) s.step();
    const SavedState saved = s.save();
    s.step();
    for (int time = 0; time < 16; ++time) {
      Simulation again = restored(saved, 1 + time % 4, which());
      again.step();
      ASSERT_EQ(again.state_hash(), s.state_hash()) << moment << ", time " << time;
    }
  }
}

TEST_P(checkpoint, of_what_it_restored_is_the_same) {
  Simulation s = start(which());
  for (int step = 0; step <= 62; ++step) {
    const SavedState saved = s.save();
    expect_equal(restored(saved, 1, which()).save(), saved, which().name);
    s.step();
  }
}

TEST_P(checkpoint, damaged_is_refused_or_a_simulation) {
  Simulation s = start(which());
  for (int step = 0; step < 12; ++step) s.step();
  const SavedState good = s.save();
  std::mt19937 random(20240607);
  int refused = 0;
  for (int k = 0; k < 300; ++k) {
    SavedState bad = good;
    std::string& bytes = bad.chunks[random() % bad.chunks.size()].bytes;
    if (bytes.empty()) continue;
    const std::size_t at = random() % std::min<std::size_t>(bytes.size(), 400);
    if (k % 5 == 0)
      bytes.resize(at);
    else
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    try {
      Simulation::restore(bad, 1);
    } catch (const ConfigError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 60);
}

INSTANTIATE_TEST_SUITE_P(scenes, checkpoint, testing::Range<std::size_t>(0, 8),
                         [](const auto& test) { return std::string(cases()[test.param].name); });

TEST(checkpoint, of_a_simulation_that_gets_a_body_later_continues) {
  Simulation s = everything(0);
  for (int step = 0; step < 15; ++step) s.step();
  s.extend_body(BodyId{0}, cube(3, {30, 0, 1}));
  Simulation again = Simulation::restore(s.save(), 3);
  for (int step = 0; step < 30; ++step) {
    s.step();
    again.step();
    ASSERT_EQ(again.state_hash(), s.state_hash()) << step;
  }
}

TEST(checkpoint, keeps_what_was_set_between_steps) {
  Simulation s = everything(0);
  for (int step = 0; step < 5; ++step) s.step();
  s.set_alpha(MaterialId{0}, AlphaSchedule{{0, 0.5f}, {3, 1}});
  s.set_velocity(ColliderId{1}, {0.2f, 0, 0});
  Simulation again = Simulation::restore(s.save(), 1);
  for (int step = 0; step < 30; ++step) {
    s.step();
    again.step();
    ASSERT_EQ(again.state_hash(), s.state_hash()) << step;
  }
  EXPECT_EQ(again.colliders()[1].velocity, Vec3(0.2f, 0, 0));
}

TEST(checkpoint, says_which_chunk_is_missing) {
  Simulation s = elastic();
  s.step();
  const SavedState good = s.save();
  for (std::size_t k = 0; k < good.chunks.size(); ++k) {
    SavedState bad = good;
    bad.chunks.erase(bad.chunks.begin() + static_cast<std::ptrdiff_t>(k));
    try {
      Simulation::restore(bad);
      ADD_FAILURE() << good.chunks[k].name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find("'" + good.chunks[k].name + "'"), std::string::npos)
          << error.what();
    }
  }
}

/// A painted, heated, pinned body: it has every column that may be absent.
SavedState with_all_columns() {
  Simulation s(config());
  Body body = cube(4, {0, 0, 0.6f});
  const std::size_t n = body.positions.size();
  body.alpha.assign(n, 0.5f);
  body.stiffness.assign(n, 2.0f);
  body.plastic_yield.assign(n, 0.1f);
  body.temperature.assign(n, 300.0f);
  s.add_body(body, Material{.plastic_yield = 0.2f, .temperature = 290.0f});
  s.pin(Aabb{{-1, -1, -1}, {9, 9, 1.5f}});
  return s.save();
}

/// Chunks of columns, and bytes a particle.
struct SavedColumnFormat {
  const char* chunk;
  std::size_t bytes;
  bool may_be_absent;
};
constexpr SavedColumnFormat k_columns[] = {
    {"ids", 8, false},           {"positions", 12, false},  {"velocities", 12, false},
    {"pinned", 2, true},         {"alphas", 4, true},       {"stiffnesses", 4, true},
    {"plastic_yields", 4, true}, {"temperatures", 4, true}, {"temperature_rests", 4, true},
};

TEST(checkpoint, has_the_columns_of_particles_in_the_order_of_the_format) {
  const SavedState saved = with_all_columns();
  auto at = std::ranges::find(saved.chunks, "ids", &Chunk::name);
  for (const SavedColumnFormat& column : k_columns) {
    ASSERT_NE(at, saved.chunks.end());
    EXPECT_EQ(at->name, column.chunk);
    EXPECT_EQ(at->bytes.size(), 64 * column.bytes) << column.chunk;
    at += column.chunk == std::string("ids") ? 2 : 1;  // the slots of the ids follow them
  }
}

TEST(checkpoint, with_a_column_of_another_length_is_refused_by_its_name) {
  const SavedState good = with_all_columns();
  for (const SavedColumnFormat& column : k_columns) {
    SavedState bad = good;
    std::ranges::find(bad.chunks, column.chunk, &Chunk::name)->bytes.resize(63 * column.bytes);
    EXPECT_NE(test::refusal([&] { Simulation::restore(bad, 1); }).find(std::string("'") + column.chunk + "'"),
              std::string::npos)
        << column.chunk;
  }
}

TEST(checkpoint, with_a_value_out_of_the_range_of_its_column_is_refused) {
  const SavedState good = with_all_columns();
  const auto with = [&](const char* chunk, float value) {
    SavedState bad = good;
    std::memcpy(std::ranges::find(bad.chunks, chunk, &Chunk::name)->bytes.data(), &value, sizeof value);
    return test::refusal([&] { Simulation::restore(bad, 1); });
  };
  EXPECT_NE(with("alphas", 1.5f).find("'alphas'"), std::string::npos);
  EXPECT_NE(with("stiffnesses", -1.0f).find("'stiffnesses'"), std::string::npos);
  EXPECT_NE(with("plastic_yields", -1.0f).find("'plastic_yields'"), std::string::npos);
  EXPECT_NE(with("temperatures", std::numeric_limits<float>::infinity()).find("'temperatures'"),
            std::string::npos);
  EXPECT_NE(with("temperature_rests", std::nanf("")).find("'temperature_rests'"), std::string::npos);
}

TEST(checkpoint, of_another_version_is_refused) {
  SavedState saved = elastic().save();
  ++saved.chunks.front().bytes.front();
  try {
    Simulation::restore(saved);
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("version 16; this build of mallow reads 15"), std::string::npos)
        << error.what();
  }
}

}  // namespace checkpoint_test
}  // namespace mallow
