#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

#include "colliders/one_row.h"
#include "levels.h"
#include "motion/motion.h"

namespace mallow {
namespace move_particles_test {

/// Rows that no block and no lane divides, between others that belong to someone else.
constexpr std::size_t k_begin = 21, k_end = 824, k_rows = 900;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float operator()(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  Vec3 vec(float size) {
    const float x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }
  Primitive primitive() {
    const Vec3 at = vec(6);
    switch (engine_() % 6) {
      case 0:
        return Plane{vec(2) + Vec3(0, 0, 3), (*this)(-30, -20)};
      case 1:
        return Sphere{at, (*this)(0.2f, 2)};
      case 2:
        return Capsule{at, at + Vec3(1, 2, 0.5f), (*this)(0.2f, 1)};
      case 3:
        return Cylinder{at, at + Vec3(1, -2, 0.5f), (*this)(0.2f, 2)};
      case 4:
        return Cone{at, at + Vec3(-1, 2, 0.5f), (*this)(0.2f, 2), (*this)(0, 1)};
      default:
        return Box{at, at + Vec3(1, 2, 0.5f)};
    }
  }
  Union shapes(int count) {
    Union result;
    for (int k = 0; k < count; ++k) result.parts.push_back(primitive());
    return result;
  }

 private:
  std::mt19937 engine_;
};

/// Particles in a cube of side 12, in the order of x, with all that may act on them.
struct World {
  ParticleStore store;
  VectorColumn sph{k_rows}, cross{k_rows}, user{k_rows}, pull{k_end - k_begin};
  std::vector<Collider> colliders;
  std::vector<PinMotion> pins{{.velocity = {1, 2, 3}}, {.velocity = {-4, 0, 0}}};
  MotionInput input;

  World() {
    Random random(1);
    std::vector<Vec3> x, v;
    for (std::size_t i = 0; i < k_rows; ++i) {
      x.push_back(random.vec(6));
      x.back().x() = 12 * static_cast<float>(i) / k_rows - 6;
      v.push_back(random.vec(2));
    }
    store.insert(0, x, v);
    store.next_position.resize(k_rows);
    store.next_velocity.resize(k_rows);
    for (VectorColumn* column : {&sph, &cross, &user, &pull})
      for (std::size_t i = 0; i < column->size(); ++i) column->set(i, random.vec(1));
    input = {.begin = k_begin,
             .end = k_end,
             .time_step = 0.13f,
             .alpha = 0.7f,
             .elastic_factor = 0.9f,
             .gravity = {0.1f, 0, -0.6f},
             .sph_acceleration = &sph,
             .cross_group = nullptr,
             .user = nullptr,
             .pull = &pull,
             .colliders = {},
             .contact = {.time_step = 0.13f,
                         .max_push = 1.5f,
                         .contact_offset = 0.3f,
                         .gravity = {0.1f, 0, -0.6f},
                         .least_bounce = 0.16f},
             .pins = pins,
             .measure_external = true,
             .mass = 1};
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void collide(std::vector<Collider> with) { colliders = std::move(with); }
  void pin_some() {
    store.pin.resize(k_rows);
    for (std::size_t i = 0; i < k_rows; i += 7) store.pin[i] = static_cast<std::uint16_t>(1 + i % 2);
  }
  std::vector<MotionPhases> loops{{.predict = true, .collide = true, .advance = true}};
  MotionSums move(int threads = 2, InstructionLevel level = best_instruction_level()) {
    std::vector<PlacedCollider> placed;
    place_colliders(colliders, {0, 0, 0}, input.time_step, level, placed);
    MovingBodies bodies;
    bodies.inputs = {input};
    bodies.inputs[0].colliders = placed;
    for (const MotionPhases& phases : loops) move_particles(phases, {threads, level}, store, bodies);
    return bodies.sums[0];
  }

  struct Moved {
    Vec3 x, v;
    double external;
  };
  /// Model 4 and 5 for one particle.
  Moved literally(std::size_t i) const {
    const Vec3 x = store.position.get(i);
    Vec3 v = store.velocity.get(i);
    if (!store.pin.empty() && store.pin[i] != 0) {
      v = pins[store.pin[i] - 1u].velocity;
      return {x + input.time_step * v, v, 0};
    }
    Vec3 external = input.gravity;
    if (input.cross_group) external += cross.get(i);
    if (input.user) external += user.get(i);
    v += input.time_step * external;
    if (input.sph_acceleration) v += input.alpha * input.time_step * sph.get(i);
    if (input.pull) v += input.elastic_factor * pull.get(i - k_begin);
    const Vec3 free = v;
    const Vec3 before = store.velocity.get(i);
    for (const Collider& collider : colliders) v = resolve_one_row(collider, input.contact, x, before, v);
    return {x + input.time_step * v, v,
            static_cast<double>((external + (v - free) / input.time_step).norm())};
  }
  /// That a step is what the literal one is, row by row, to the bit, at every level and for every number of
  /// threads; and how many particles were touched.
  std::size_t expect_literal() {
    double external = 0;
    std::size_t unpinned = 0, touched = 0;
    for (std::size_t i = k_begin; i < k_end; ++i) {
      external += literally(i).external;
      unpinned += store.pin.empty() || store.pin[i] == 0;
    }
    for (const InstructionLevel level : levels()) {
      const MotionSums first = move(1, level);
      EXPECT_EQ(first.unpinned, unpinned);
      EXPECT_EQ(first.bad_row, SIZE_MAX);
      EXPECT_NEAR(first.external, external, 1e-9 * external);
      for (const int threads : {2, 3}) EXPECT_EQ(move(threads, level).external, first.external);
      touched = 0;
      for (std::size_t i = k_begin; i < k_end; ++i) {
        const Moved expected = literally(i);
        EXPECT_EQ(store.next_velocity.get(i), expected.v) << "row " << i;
        EXPECT_EQ(store.next_position.get(i), expected.x) << "row " << i;
        touched += std::abs(expected.external - static_cast<double>(input.gravity.norm())) > 1e-3;
      }
    }
    return touched;
  }
};

TEST(move_particles, equals_the_recurrence_whatever_acts) {
  for (int terms = 0; terms < 32; ++terms) {
    World world;
    if (!(terms & 1)) world.input.sph_acceleration = nullptr;
    if (!(terms & 2)) world.input.pull = nullptr;
    if (terms & 4) world.input.cross_group = &world.cross;
    if (terms & 8) world.input.user = &world.user;
    if (terms & 16) world.pin_some();
    world.expect_literal();
  }
}

TEST(move_particles, equals_the_recurrence_with_contact_at_every_shape) {
  const std::vector<Collider::Shape> shapes = {
      Plane{{0, 0, 1}, -5},
      Plane{{3, -1, 2}, 2},
      Sphere{{-1, 0, 2}, 3},
      Sphere{{0, 0, 0}, 6, true},
      Box{{-2, -2, -2}, {2, 3, 1}},
      Box{{-5, -5, -5}, {5, 5, 5}, true},
      Capsule{{-2, 0, 1}, {1, 2, -2}, 2},
      Capsule{{-2, 0, 1}, {1, 2, -2}, 4, true},
      Cylinder{{-2, 0, 1}, {1, 2, -2}, 2},
      Cylinder{{-2, 0, 4}, {1, 2, -4}, 4, true},
      Cone{{-2, 0, 1}, {1, 2, -2}, 3},
      Cone{{-2, 0, 4}, {1, 2, -4}, 5, 3, true},
      Random(2).shapes(5),
      Union{{Box{{-5, -5, -5}, {5, 5, 5}, true}, Sphere{{0, 0, 0}, 6, true}, Plane{{0, 0, 1}, -5}}},
  };
  for (const auto& shape : shapes) {
    World world;
    world.collide({{.shape = shape, .velocity = {0.3f, 0, 0.2f}, .restitution = 0.4f, .friction = 0.3f}});
    EXPECT_GT(world.expect_literal(), 10u);
  }
}

TEST(move_particles, meets_colliders_in_their_order) {
  World world;
  world.pin_some();
  world.input.user = &world.user;
  // Thrown at each other by the first, they reach the second only then.
  world.collide({{.shape = Plane{{1, 0, 0}, -2}, .velocity = {60, 0, 0}, .restitution = 1},
                 {.shape = Sphere{{5, 0, 0}, 1}, .velocity = {-3, 0, 0}, .restitution = 0.5f},
                 {.shape = Box{{-9, -9, -9}, {9, 9, 9}, true}, .friction = 1}});
  world.expect_literal();
  std::swap(world.colliders[0], world.colliders[2]);
  world.expect_literal();
}

TEST(move_particles, equals_the_recurrence_in_a_union_of_few_and_of_many_parts) {
  for (const int parts : {1, 4, 31, 33, 300}) {
    World world;
    world.collide({{.shape = Random(static_cast<unsigned>(parts)).shapes(parts), .friction = 0.5f}});
    const std::size_t touched = world.expect_literal();
    EXPECT_TRUE(touched > 0 || parts == 1);
  }
}

// A block that is thin and slow is out of reach of most that is about it, and must not be taken to be of all.
TEST(move_particles, equals_the_recurrence_along_a_slow_beam) {
  for (const auto& shape : std::vector<Collider::Shape>{
           Plane{{1, 0, 0}, -5.5f},
           Plane{{-2, 0, 0}, -9},
           Sphere{{-5, 1, 0}, 0.8f},
           Sphere{{0, 0, 0}, 5, true},
           Sphere{{4, 0, -9}, 12, true},
           Box{{-5, 0.4f, -1}, {-4, 1, 1}},
           Box{{-5, -5, -0.9f}, {5.5f, 5, 9}, true},
           Capsule{{-5, 1, -3}, {-5, 1, 3}, 0.8f},
           Cylinder{{-5, 0, -9}, {-5, 0, 0}, 2},
           Cone{{0, 0, -9}, {0, 0, 9}, 4, 6, true},
           Union{{Box{{5, -2, -2}, {7, 2, 2}}, Sphere{{-6, 0, 0}, 0.5f}, Box{{-9, -9, -9}, {9, 9, 9}, true}}},
       }) {
    World world;
    world.input.gravity = {0, 0, -0.01f};
    world.input.sph_acceleration = world.input.pull = nullptr;
    for (std::size_t i = 0; i < k_rows; ++i) {
      world.store.position.set(i, world.store.position.get(i).cwiseProduct(Vec3(1, 0.1f, 0.1f)));
      world.store.velocity.set(i, 1e-3f * world.store.velocity.get(i));
    }
    world.collide({{.shape = shape}});
    EXPECT_GT(world.expect_literal(), 5u);
  }
}

TEST(move_particles, equals_the_recurrence_far_from_the_origin) {
  World world;
  const Vec3 offset(3000, -2000, 500);
  for (std::size_t i = 0; i < k_rows; ++i) world.store.position.set(i, world.store.position.get(i) + offset);
  world.collide({{.shape = Sphere{offset, 3}}, {.shape = Plane{{0, 0, 7}, 7 * 495}, .friction = 0.2f}});
  EXPECT_GT(world.expect_literal(), 10u);
}

// Centres, and gaps whose squares a float does not hold.
TEST(move_particles, equals_the_recurrence_at_distances_out_of_range) {
  const Vec3 corner(1, 2, 3);
  World world;
  for (std::size_t i = 0; i < k_rows; ++i) {
    const float tiny = std::ldexp(1.0f, -static_cast<int>(i % 120) - 20);
    world.store.position.set(i, i % 3 == 0   ? corner
                                : i % 3 == 1 ? Vec3(tiny, -tiny, 0)
                                             : Vec3(-tiny, 0, 0.5f * tiny));
  }
  for (const auto& shape : std::vector<Collider::Shape>{
           Sphere{corner, 0.5f},
           Sphere{{0, 0, 0}, 1e-3f},
           Sphere{{0, 0, 0}, 2, true},
           Sphere{{3e17f, 0, 0}, 3e17f},
           Sphere{{0, -2e16f, 0}, 2e16f, true},
           Box{{-3, -3, -3}, {0, 0, 0}},
           Box{{0, 0, 0}, {1, 2, 3}},
           Capsule{corner, {0, 0, 0}, 0.5f},
           Capsule{{0, 0, 0}, {1, 0, 0}, 2, true},
           Cylinder{corner, {0, 0, 0}, 0.5f},
           Cone{{0, 0, -1}, {0, 0, 0}, 1},
           Cone{{0, 0, 0}, {3e14f, 0, 0}, 1e14f, 2e14f},
           Union{{Box{{-3, -3, -3}, {0, 0, 0}}, Sphere{{0, 0, 0}, 1e-3f}, Sphere{corner, 0.1f}}},
       }) {
    world.collide({{.shape = shape, .velocity = {0.3f, 0, 0.2f}, .friction = 0.3f}});
    EXPECT_GT(world.expect_literal(), 5u);
  }
}

TEST(move_particles, in_several_loops_has_the_bits_of_one) {
  const auto run = [](std::vector<MotionPhases> loops, bool pinned) {
    World world;
    world.collide({{.shape = Random(3).shapes(5), .friction = 0.3f},
                   {.shape = Box{{-9, -9, -9}, {9, 9, 9}, true}, .restitution = 0.5f}});
    if (pinned) world.pin_some();
    if (!loops.empty()) world.loops = std::move(loops);
    const MotionSums sums = world.move();
    std::vector<Vec3> moved;
    for (std::size_t i = k_begin; i < k_end; ++i) {
      moved.push_back(world.store.next_position.get(i));
      moved.push_back(world.store.next_velocity.get(i));
    }
    return std::tuple(sums.external, sums.unpinned, sums.bad_row, moved);
  };
  const MotionPhases predict{.predict = true}, collide{.collide = true}, advance{.advance = true};
  for (const bool pinned : {false, true}) {
    const auto one = run({}, pinned);
    EXPECT_EQ(run({predict, collide, advance}, pinned), one);
    EXPECT_EQ(run({predict, {.collide = true, .advance = true}}, pinned), one);
    EXPECT_EQ(run({{.predict = true, .collide = true}, advance}, pinned), one);
  }
}

TEST(move_particles, leaves_all_other_rows_alone) {
  World world;
  const Vec3 mark(7, 8, 9);
  for (const InstructionLevel level : levels()) {
    for (VectorColumn* column : {&world.store.next_position, &world.store.next_velocity})
      for (std::size_t i = 0; i < k_rows; ++i) column->set(i, mark);
    world.move(2, level);
    for (std::size_t i = 0; i < k_rows; ++i) {
      const bool own = i >= k_begin && i < k_end;
      EXPECT_EQ(world.store.next_position.get(i) == mark, !own);
      EXPECT_EQ(world.store.next_velocity.get(i) == mark, !own);
    }
  }
}

TEST(move_particles, names_the_first_row_that_is_not_finite) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    World world;
    world.collide({{.shape = Random(3).shapes(5)}, {.shape = Box{{-9, -9, -9}, {9, 9, 9}, true}}});
    for (const std::size_t row : {std::size_t{823}, std::size_t{500}, std::size_t{21}}) {
      world.sph.set(row, {0, bad, 0});
      for (const InstructionLevel level : levels()) EXPECT_EQ(world.move(2, level).bad_row, row);
    }
    // Rows of others do not count.
    World other;
    other.sph.set(k_begin - 1, {bad, 0, 0});
    other.store.position.set(k_end, {bad, 0, 0});
    EXPECT_EQ(other.move().bad_row, SIZE_MAX);
  }
}

}  // namespace move_particles_test
}  // namespace mallow
