// A program of its own, because it counts what the whole program allocates.
#include "mallow/skin.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "levels.h"
#include "mallow/mallow.h"
#include "meshes.h"
#include "simulation/allocation_counter.h"
#include "simulation/phases.h"
#include "simulation/state.h"
#include "surface/skin_binding.h"

namespace mallow {

/// The way of tests to the columns of a simulation.
struct StateAccess {
  static Simulation::State& of(Simulation& s) { return *s.state_; }
};

namespace skin_test {

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

float largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

/// A ball of radius 6 without gravity, and a mesh a little larger.
struct Ball {
  Vec3 center;
  Simulation simulation;
  BodyId body;
  Mesh mesh;

  explicit Ball(const Vec3& where = {0, 0, 0}, const Material& material = {.alpha = 0}, int threads = 2)
      : center(where),
        simulation({.time_step = 0.1f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .threads = threads}),
        body(simulation.add_body(sample(sphere_shape(center, 6), {.spacing = 1.0f}), material)),
        mesh(sphere_mesh(center, 6.3f, 24)) {}

  Simulation::State& state() { return StateAccess::of(simulation); }
  /// Puts all particles where `map` takes their rest positions, at rest, and matches shapes there.
  template <class Map>
  void deform(const Map& map) {
    simulation.prepare();
    ParticleStore& store = state().store;
    const VectorColumn& rest = state().bodies[0].shape.reference;
    for (std::size_t row = 0; row < store.size(); ++row) {
      store.position.set(row, map(rest.get(row)));
      store.velocity.set(row, {0, 0, 0});
    }
    state().rows_moved();
    const VectorColumn before = [&] {
      VectorColumn copy(store.size());
      for (std::size_t row = 0; row < store.size(); ++row) copy.set(row, store.position.get(row));
      return copy;
    }();
    simulation.step();
    for (std::size_t row = 0; row < store.size(); ++row) store.position.set(row, before.get(row));
    state().rows_moved();
  }
  void yield() {
    BodyState& body_state = state().bodies[0];
    take_reference(state(), body_state);
    build_regions(state().execution, state().region_scratch, body_state.shape);
  }
};

/// A turn by 2 rad about an odd axis, and a way.
const Eigen::Quaternionf k_turn(Eigen::AngleAxisf(2.0f, Vec3(1, -2, 0.5f).normalized()));
const Vec3 k_way(3, -7, 12);

/// Twisted about z, and longer.
Vec3 twisted(const Vec3& x) {
  return Eigen::AngleAxisf(0.12f * x.z(), Vec3::UnitZ()) * Vec3(x.x(), x.y(), 1.3f * x.z());
}

TEST(skin, is_bound_to_the_body_that_it_names_where_others_have_gone) {
  Simulation simulation({.time_step = 0.1f, .support_radius = 2.1f, .threads = 1});
  const auto cube = [](float x) {
    return sample(Lattice{.count = {4, 4, 4}, .spacing = 1, .corner = {x, 0, 0}});
  };
  const BodyId gone = simulation.add_body(cube(0), {.alpha = 0.1f});
  const BodyId other = simulation.add_body(cube(20), {.alpha = 0.2f});
  simulation.remove_body(gone);
  const BodyId later = simulation.add_body(cube(40), {.alpha = 0.3f});
  for (const auto& [body, x] : {std::pair{other, 20.0f}, {later, 40.0f}}) {
    Mesh mesh;
    mesh.vertices = {{x, 1, 1}, {x + 3, 1, 1}, {x, 3, 1}};
    mesh.triangles = {{0, 1, 2}};
    Skin skin(simulation, body, mesh);
    Skin again = Skin::restore(skin.save(), 1);
    EXPECT_EQ(again.body(), body);
    simulation.step();
    EXPECT_EQ(again.update(simulation).vertices, skin.update(simulation).vertices);
    EXPECT_EQ(skin.mesh().material_ids.front(), slot_of(body));
  }
}

TEST(skin, is_where_the_mesh_was_at_rest) {
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(40, -30, 20)}) {
    for (const int stride : {1, 3}) {
      Ball ball(center, {.alpha = 0.3f, .region_stride = stride});
      ball.mesh.normals = vertex_normals(ball.mesh);
      Skin skin(ball.simulation, ball.body, ball.mesh);
      EXPECT_EQ(largest_distance(skin.mesh().vertices, ball.mesh.vertices), 0);
      const Mesh& mesh = skin.update(ball.simulation);
      EXPECT_LT(largest_distance(mesh.vertices, ball.mesh.vertices), 12e-6f) << "of a body 12 wide";
      EXPECT_LT(largest_distance(mesh.normals, ball.mesh.normals), 1e-6f);
      EXPECT_EQ(mesh.triangles, ball.mesh.triangles);
      EXPECT_EQ(mesh.material_ids, std::vector<std::uint32_t>(mesh.vertices.size(), 0));
    }
  }
}

TEST(skin, is_where_floats_can_be_far_from_0) {
  const Vec3 center(1e6f, -2e6f, 3e5f);
  Ball ball(center);
  Skin skin(ball.simulation, ball.body, ball.mesh);
  EXPECT_LT(largest_distance(skin.update(ball.simulation).vertices, ball.mesh.vertices), 0.3f)
      << "floats are a quarter apart there";
}

TEST(skin, takes_a_rigid_motion_to_single_precision) {
  for (const int stride : {1, 3}) {
    Ball ball({5, 6, 7}, {.alpha = 0, .region_stride = stride});
    Skin skin(ball.simulation, ball.body, ball.mesh);
    const std::vector<Vec3> vertices = skin.mesh().vertices, normals = skin.mesh().normals;
    const Vec3 mean = ball.simulation.positions()[0] - ball.simulation.rest_positions(ball.body)[0];
    ball.deform([&](const Vec3& x) { return Vec3(k_turn * x + k_way); });
    const Mesh& mesh = skin.update(ball.simulation);
    float off = 0, tilt = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      off = std::max(off, (k_turn * (vertices[v] - mean) + k_way - mesh.vertices[v]).norm());
      tilt = std::max(tilt, (k_turn * normals[v] - mesh.normals[v]).norm());
    }
    EXPECT_LT(off, 12 * 1e-6f);
    EXPECT_LT(tilt, 3e-6f);
    for (const float stretch : skin.stretch()) ASSERT_LT(stretch, 1e-5f);
  }
}

TEST(skin, follows_a_smooth_motion_within_a_tenth_of_a_spacing) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  const Vec3 mean = ball.simulation.positions()[0] - ball.simulation.rest_positions(ball.body)[0];
  const auto bent = [](const Vec3& x) { return Vec3(Eigen::AngleAxisf(0.03f * x.z(), Vec3::UnitZ()) * x); };
  ball.deform(bent);
  const Mesh& mesh = skin.update(ball.simulation);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    ASSERT_LT((mesh.vertices[v] - bent(ball.mesh.vertices[v] - mean)).norm(), 0.1f) << v;
}

TEST(skin, weights_sum_to_1_and_change_smoothly_from_place_to_place) {
  const std::vector<Vec3> particles = sample(sphere_shape({0, 0, 0}, 4), {.spacing = 0.5f}).positions;
  std::vector<std::uint32_t> all(particles.size());
  std::iota(all.begin(), all.end(), 0u);
  constexpr int k_steps = 4000;
  std::vector<Vec3> way;
  for (int k = 0; k <= k_steps; ++k)
    way.push_back(Vec3(-4.2f, -0.3f, 0.2f) + Vec3(8.4f, 0.7f, -0.5f) * (static_cast<float>(k) / k_steps));
  const Column<VertexBinding> bindings = bind_vertices(way, {particles, all}, 0.5f, 2);
  std::vector<double> before, now;
  for (std::size_t v = 0; v < bindings.size(); ++v) {
    double sum = 0;
    now.assign(particles.size(), 0);
    for (std::size_t k = 0; k < k_skin_particles; ++k) {
      EXPECT_GE(bindings[v].weight[k], 0);
      EXPECT_LE(bindings[v].weight[k], bindings[v].weight[k - std::min<std::size_t>(k, 1)])
          << "nearest first";
      sum += static_cast<double>(bindings[v].weight[k]);
      now[bindings[v].particle[k]] += static_cast<double>(bindings[v].weight[k]);
    }
    ASSERT_NEAR(sum, 1, 3e-7);
    // A step is 0.004 spacings.
    for (std::size_t p = 0; p < before.size(); ++p) ASSERT_LT(std::abs(now[p] - before[p]), 0.02) << v;
    before = now;
  }
}

TEST(skin, has_the_same_bits_for_any_number_of_threads) {
  std::vector<std::vector<Vec3>> vertices, normals;
  for (const int threads : {1, 2, 4}) {
    Ball ball({0, 0, 0}, {.alpha = 0.2f}, threads);
    Skin skin(ball.simulation, ball.body, ball.mesh, threads);
    ball.deform(twisted);
    ball.yield();
    vertices.push_back(skin.update(ball.simulation).vertices);
    normals.push_back(skin.mesh().normals);
    EXPECT_TRUE(same_bits(vertices.back(), vertices.front())) << threads;
    EXPECT_TRUE(same_bits(normals.back(), normals.front())) << threads;
  }
}

TEST(skin, has_the_same_bits_at_every_instruction_level) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<float> motions(40 * k_skin_row), vertices(300), normals(300);
  for (std::vector<float>* values : {&motions, &vertices, &normals})
    for (float& value : *values) value = number(random);
  std::vector<VertexBinding> bindings(100);
  for (VertexBinding& binding : bindings)
    for (std::size_t k = 0; k < k_skin_particles; ++k) {
      binding.particle[k] = static_cast<std::uint32_t>(random() % 40);
      binding.weight[k] = 0.5f + 0.5f * number(random);
    }
  const float origin[3] = {1, 2, 3};
  std::vector<float> first;
  for (const InstructionLevel level : levels()) {
    std::vector<float> to(600, 0.0f);
    MALLOW_SELECT(level, skin_lanes)
        .blend(bindings.data(), motions.data(), origin, vertices.data(), normals.data(), 0, 100, to.data(),
               to.data() + 300);
    if (first.empty()) first = to;
    EXPECT_EQ(std::memcmp(to.data(), first.data(), to.size() * sizeof(float)), 0);
  }
}

TEST(skin, writes_no_vertex_of_another_block) {
  std::vector<float> motions(k_skin_row, 1.0f), values(30, 1.0f), to(60, -7.0f);
  std::vector<VertexBinding> bindings(10);
  for (VertexBinding& binding : bindings) binding = {{}, {1}};
  const float origin[3] = {};
  for (const InstructionLevel level : levels()) {
    MALLOW_SELECT(level, skin_lanes)
        .blend(bindings.data(), motions.data(), origin, values.data(), values.data(), 4, 6, to.data(),
               to.data() + 30);
    for (std::size_t k = 0; k < to.size(); ++k) EXPECT_EQ(to[k] == -7.0f, k % 30 < 12 || k % 30 >= 18) << k;
  }
}

TEST(skin, has_the_same_bits_whatever_the_order_of_rows) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  ball.deform(twisted);
  const std::vector<Vec3> vertices = skin.update(ball.simulation).vertices;
  const std::vector<Vec3> normals = skin.mesh().normals;
  // All that is known by row takes another order.
  ShapeMatching& shape = ball.state().bodies[0].shape;
  const std::size_t n = ball.simulation.particle_count();
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::shuffle(order, std::mt19937(3));
  const ShapeMatching before = [&] {
    ShapeMatching copy;
    copy.reference.resize(n);
    for (std::size_t i = 0; i < n; ++i) copy.reference.set(i, shape.reference.get(i));
    for (std::size_t c = 0; c < 4; ++c) {
      copy.rotation[c].resize(n);
      std::ranges::copy(shape.rotation[c], copy.rotation[c].begin());
    }
    return copy;
  }();
  for (std::size_t i = 0; i < n; ++i) {
    shape.reference.set(i, before.reference.get(order[i]));
    for (std::size_t c = 0; c < 4; ++c) shape.rotation[c][i] = before.rotation[c][order[i]];
  }
  ball.state().store.permute(0, order, 2);
  ball.state().rows_moved();
  skin.update(ball.simulation);
  EXPECT_TRUE(same_bits(skin.mesh().vertices, vertices));
  EXPECT_TRUE(same_bits(skin.mesh().normals, normals));
}

TEST(skin, does_not_move_when_the_body_takes_another_reference_shape) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  ball.deform(twisted);
  const std::vector<Vec3> vertices = skin.update(ball.simulation).vertices;
  const std::vector<Vec3> normals = skin.mesh().normals;
  EXPECT_GT(largest_distance(vertices, ball.mesh.vertices), 2);
  ball.yield();
  const Mesh& mesh = skin.update(ball.simulation);
  EXPECT_LT(largest_distance(mesh.vertices, vertices), 1e-4f);
  EXPECT_LT(largest_distance(mesh.normals, normals), 1e-4f);

  // What it has now is its shape from here on.
  const Vec3 mean = ball.simulation.positions()[0] - ball.simulation.rest_positions(ball.body)[0];
  const std::vector<Vec3> yielded = mesh.vertices;
  ball.deform([&](const Vec3& x) { return Vec3(k_turn * x + k_way); });
  skin.update(ball.simulation);
  for (std::size_t v = 0; v < yielded.size(); ++v)
    ASSERT_LT((k_turn * (yielded[v] - mean) + k_way - mesh.vertices[v]).norm(), 3e-5f);
}

TEST(skin, does_not_depend_on_how_often_it_was_updated_where_bodies_yield) {
  Ball ball;
  Skin often(ball.simulation, ball.body, ball.mesh), once(ball.simulation, ball.body, ball.mesh);
  for (int k = 0; k < 4; ++k) {
    ball.deform(
        [](const Vec3& x) { return Vec3(Eigen::AngleAxisf(0.02f * x.z() + 0.4f, Vec3::UnitZ()) * x); });
    ball.yield();
    often.update(ball.simulation);
  }
  EXPECT_LT(largest_distance(often.mesh().vertices, once.update(ball.simulation).vertices), 0.03f);
  EXPECT_LT(largest_distance(often.mesh().normals, once.mesh().normals), 0.02f);
}

TEST(skin, turns_with_a_body_that_yields_all_the_time) {
  Simulation s({.time_step = 0.1f, .support_radius = 2.1f, .gravity = {0, 0, 0}, .update_interval = 5});
  Body points = sample(Lattice{.count = {8, 8, 8}, .spacing = 1.0f, .corner = {-4, -4, -4}});
  for (const Vec3& x : points.positions) points.velocities.push_back(Vec3(0, 0, 0.4f).cross(x));
  const BodyId body = s.add_body(points, {.alpha = 0.3f, .update_threshold = 0, .deformation_damping = 0.0f});
  s.set_force([](const ForceInput&, VectorSpan a) { std::ranges::fill(a.x(), 1e-4f); });
  Mesh mesh;
  mesh.vertices = {{-4, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, -4, 0}};
  mesh.normals = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  Skin skin(s, body, mesh);
  const std::vector<Vec3> before = s.positions_by_id();
  int updates = 0;
  for (int k = 0; k < 200; ++k) updates += s.step().updated_references;
  EXPECT_GT(updates, 30);
  skin.update(s);
  // The turn of the whole body about z, and by how much less every normal has turned: a step's turn is 0.04.
  const std::vector<Vec3> now = s.positions_by_id();
  const Vec3 middle = std::accumulate(now.begin(), now.end(), Vec3(0, 0, 0)) / static_cast<float>(now.size());
  float cosine = 0, sine = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3 x = now[i] - middle;
    cosine += before[i].x() * x.x() + before[i].y() * x.y();
    sine += before[i].x() * x.y() - before[i].y() * x.x();
  }
  const Eigen::AngleAxisf turn(std::atan2(sine, cosine), Vec3::UnitZ());
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_LT((turn * mesh.normals[v] - skin.mesh().normals[v]).norm(), 0.06f) << v;
}

TEST(skin, moves_no_faster_than_particles_where_a_falling_body_yields) {
  Simulation s({.time_step = 0.1f, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .update_interval = 5});
  const BodyId body = s.add_body(sample(Lattice{.count = {8, 8, 8}, .spacing = 1.0f, .corner = {0, 0, 1}}),
                                 {.alpha = 0.5f, .update_threshold = 0});
  s.add_collider({.shape = Plane{}});
  Skin skin(s, body, box_mesh({0, 0, 1}, {8, 8, 9}));
  int updates = 0;
  for (int k = 0; k < 150; ++k) {
    const std::vector<Vec3> vertices = skin.mesh().vertices, positions = s.positions_by_id();
    updates += s.step().updated_references;
    const float moved = largest_distance(s.positions_by_id(), positions);
    EXPECT_LT(largest_distance(skin.update(s).vertices, vertices), 1.3f * moved + 1e-4f) << k;
  }
  EXPECT_GT(updates, 5);
}

TEST(skin, tells_where_a_body_has_torn) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  for (const float stretch : skin.stretch()) ASSERT_EQ(stretch, 0);
  ball.deform([](const Vec3& x) { return Vec3(x.x() + (x.x() > 0 ? 3.0f : 0.0f), x.y(), x.z()); });
  skin.update(ball.simulation);
  const std::span<const float> stretch = skin.stretch();
  for (std::size_t v = 0; v < stretch.size(); ++v) {
    const float from_cut = std::abs(ball.mesh.vertices[v].x());
    EXPECT_GT(stretch[v], from_cut < 0.1f ? 1.5f : -1e-9f) << v;
    EXPECT_LT(stretch[v], from_cut > 2.5f ? 1e-5f : 3.00001f) << v;
  }
  // It stays torn when it takes that for its shape.
  const std::vector<float> before(stretch.begin(), stretch.end());
  ball.yield();
  skin.update(ball.simulation);
  for (std::size_t v = 0; v < before.size(); ++v) ASSERT_NEAR(skin.stretch()[v], before[v], 1e-5f);
}

TEST(skin, makes_the_normals_of_a_mesh_without_that_has_two_vertices_at_a_seam) {
  Ball ball;
  Mesh mesh = ball.mesh;
  const auto twin = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(mesh.vertices[30]);
  mesh.triangles.resize(mesh.triangles.size() - 9);  // open
  std::ranges::find_if(mesh.triangles, [](const auto& t) { return t[0] == 30; })->at(0) = twin;
  Skin skin(ball.simulation, ball.body, mesh);
  for (std::size_t v = 0; v + 60 < ball.mesh.vertices.size(); ++v)
    ASSERT_LT((skin.mesh().normals[v] - ball.mesh.vertices[v].normalized()).norm(), 0.1f) << v;
  EXPECT_EQ(skin.mesh().normals[twin], skin.mesh().normals[30]);
  EXPECT_EQ(skin.update(ball.simulation).vertices[twin], skin.mesh().vertices[30]);
  EXPECT_EQ(skin.mesh().normals[twin], skin.mesh().normals[30]);
}

TEST(skin, allocates_nothing_when_it_is_updated) {
  if (!test::k_counts_allocations)
    GTEST_SKIP() << "allocations are counted with glibc and without sanitizers";
  for (const int threads : {1, 2}) {
    Ball ball;
    Skin skin(ball.simulation, ball.body, ball.mesh, threads);
    skin.update(ball.simulation);
    ball.deform(twisted);
    test::start_counting();
    for (int k = 0; k < 10; ++k) {
      skin.update(ball.simulation);
      skin.stretch();
    }
    EXPECT_EQ(test::stop_counting().count, 0u) << threads;
  }
}

TEST(skin, goes_on_with_the_same_bits_where_it_was_saved) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  ball.deform(twisted);
  ball.yield();
  skin.update(ball.simulation);
  Skin again = Skin::restore(skin.save(), 1);
  ball.deform([](const Vec3& x) { return Vec3(k_turn * x + k_way); });
  ball.yield();
  EXPECT_TRUE(same_bits(again.update(ball.simulation).vertices, skin.update(ball.simulation).vertices));
  EXPECT_TRUE(same_bits(again.mesh().normals, skin.mesh().normals));
  EXPECT_EQ(again.mesh().triangles, skin.mesh().triangles);
  EXPECT_EQ(again.mesh().material_ids, skin.mesh().material_ids);
  EXPECT_TRUE(std::ranges::equal(again.stretch(), skin.stretch()));
  EXPECT_EQ(again.save(), skin.save());
}

TEST(skin, is_not_restored_from_bytes_that_are_damaged) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, sphere_mesh({0, 0, 0}, 6, 3));
  const std::string saved = skin.save();
  for (std::size_t size = 0; size < saved.size(); size += 97)
    EXPECT_THROW(Skin::restore(saved.substr(0, size)), ConfigError);
  EXPECT_THROW(Skin::restore(saved + 'x'), ConfigError);
  std::mt19937 random(2);
  for (int k = 0; k < 2000; ++k) {
    std::string damaged = saved;
    damaged[random() % damaged.size()] ^= static_cast<char>(1u << random() % 8);
    try {
      Skin::restore(damaged).update(ball.simulation);  // what is let through can be used
    } catch (const ConfigError&) {
    }
  }
}

TEST(skin, has_the_velocities_of_its_particles) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  const Vec3 velocity(1, -2, 3);
  for (std::size_t row = 0; row < ball.simulation.particle_count(); ++row)
    ball.state().store.velocity.set(row, velocity);
  for (const Vec3& v : skin.find_velocities(ball.simulation).velocities)
    ASSERT_LT((v - velocity).norm(), 1e-6f);
  EXPECT_TRUE(skin.update(ball.simulation).velocities.empty());
}

template <class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expect_refused(const Mesh& mesh, const std::string& part) {
  Ball ball;
  const std::string message = message_of([&] { Skin skin(ball.simulation, ball.body, mesh); });
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(skin, refuses_a_mesh_that_is_not_one_or_is_not_the_bodys) {
  const Mesh mesh = sphere_mesh({0, 0, 0}, 6.3f, 8);
  const auto changed = [&](const auto& change) {
    Mesh other = mesh;
    change(other);
    return other;
  };
  expect_refused({}, "mesh.vertices: there is none");
  expect_refused(changed([](Mesh& m) { m.vertices[7].y() = k_nan; }), "mesh.vertices[7]: (");
  expect_refused(changed([](Mesh& m) { m.normals.assign(3, Vec3(1, 0, 0)); }), "mesh.normals: 3 are not");
  expect_refused(changed([](Mesh& m) {
                   m.normals.assign(m.vertices.size(), Vec3(1, 0, 0));
                   m.normals[4] = Vec3(0, 0, 0);
                 }),
                 "mesh.normals[4]: has no length");
  expect_refused(changed([](Mesh& m) { m.triangles[2][1] = 5000; }),
                 "mesh.triangles[2]: there is no vertex 5000");
  expect_refused(changed([](Mesh& m) {
                   m.vertices[9] = {0, 0, 10};
                 }),
                 "mesh.vertices[9]: ( 0  0 10) is not allowed");
  expect_refused(changed([](Mesh& m) {
                   for (Vec3& x : m.vertices) x += Vec3(50, 0, 0);
                 }),
                 "others");
}

TEST(skin, refuses_a_body_without_regions_and_one_that_is_not_there) {
  Ball fluid({0, 0, 0}, {.alpha = 1});
  EXPECT_NE(message_of([&] {
              Skin skin(fluid.simulation, fluid.body, fluid.mesh);
            }).find("'body 0', which has no reference shape now: its alpha is 1"),
            std::string::npos);
  Ball ball;
  EXPECT_NE(message_of([&] { Skin skin(ball.simulation, BodyId{3}, ball.mesh); }).find("no body 3"),
            std::string::npos);

  Skin skin(ball.simulation, ball.body, ball.mesh);
  ball.simulation.set_alpha(ball.simulation.material(ball.body), 1);
  EXPECT_NE(message_of([&] { skin.update(ball.simulation); }).find("its alpha is 1"), std::string::npos);
  EXPECT_TRUE(same_bits(skin.mesh().vertices, ball.mesh.vertices)) << "and stays where it was";
}

TEST(skin, refuses_a_simulation_that_lacks_its_particles) {
  Ball ball;
  Skin skin(ball.simulation, ball.body, ball.mesh);
  Simulation fewer({.time_step = 0.1f, .support_radius = 2.1f});
  fewer.add_body(sample(Lattice{.count = {3, 3, 3}, .spacing = 1.0f}), {.alpha = 0});
  fewer.prepare();
  EXPECT_NE(message_of([&] { skin.update(fewer); }).find("there is no particle"), std::string::npos);
  Simulation others({.time_step = 0.1f, .support_radius = 2.1f});
  others.add_body(sample(Lattice{.count = {3, 3, 3}, .spacing = 1.0f}), {.alpha = 0});
  others.add_body(sample(Lattice{.count = {20, 20, 3}, .spacing = 1.0f, .corner = {0, 0, 9}}), {.alpha = 0});
  others.prepare();
  EXPECT_NE(message_of([&] { skin.update(others); }).find("is not of body 0"), std::string::npos);
}

}  // namespace skin_test
}  // namespace mallow
