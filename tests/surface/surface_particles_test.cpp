#include <numeric>
#include <random>

#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"
#include "same_meshes.h"

namespace mallow {
namespace surface_particles_test {

using Rows = Simulation::Rows;

std::vector<Vec3> shaken_ball(const Vec3& center, float radius) {
  return sample(sphere_shape(center, radius), {.spacing = 1.0f, .jitter = 0.3f}).positions;
}

TEST(surface_particles, meshes_have_the_same_bits_whatever_the_order_of_rows_where_ids_name_them) {
  const std::vector<Vec3> points = shaken_ball({0, 0, 0}, 4);
  std::vector<std::uint32_t> order(points.size());
  std::vector<ParticleId> ids;
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  std::vector<Vec3> shuffled;
  for (const std::uint32_t k : order) {
    shuffled.push_back(points[k]);
    ids.push_back(3 * k + 7 + (ParticleId{k % 5} << 32));  // of several generations
  }
  for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::anisotropic, SurfaceKind::spheres}) {
    Surfacer surfacer({.kind = kind});
    const Mesh expected = surfacer.draw({points, points, {{.spacing = 1}}});
    expect_same(Surfacer({.kind = kind}).draw({shuffled, shuffled, {{.spacing = 1}}, ids}), expected);
  }
}

TEST(surface_particles, columns_and_arrays_are_drawn_alike) {
  const std::vector<Vec3> points = shaken_ball({0, 0, 0}, 3);
  const std::size_t n = points.size();
  std::vector<float> columns(3 * (n + 5));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < 3; ++a) columns[a * (n + 5) + i] = points[i][static_cast<Eigen::Index>(a)];
  const VectorView view(columns.data(), n, n + 5);
  Surfacer surfacer({});
  const Mesh expected = surfacer.draw({points, points, {{.spacing = 1}}});
  expect_same(Surfacer({}).draw({view, view, {{.spacing = 1}}}), expected);
}

TEST(surface_particles, rows_of_no_body_are_not_drawn_and_stretches_of_a_body_share_a_surface) {
  std::vector<Vec3> points = shaken_ball({0, 0, 0}, 3);
  const std::size_t first = points.size();
  for (const Vec3& x : shaken_ball({6, 0, 0}, 3)) points.push_back(x);
  const std::size_t both = points.size();
  for (const Vec3& x : shaken_ball({0, 9, 0}, 3)) points.push_back(x);
  const std::span<const Vec3> two(points.data(), both);
  Surfacer surfacer({.voxel_size = 0.25f});
  const Mesh expected = surfacer.draw({two, {}, {{.spacing = 1}}});
  EXPECT_EQ(component_count(expected), 1u);
  expect_same(
      surfacer.draw(
          {points, {}, {{.spacing = 1, .rows = Rows{0, first}}, {.spacing = 1, .rows = Rows{first, both}}}}),
      expected);
  EXPECT_EQ(surfacer.surface_count(), 1u);
  const Mesh& apart = surfacer.draw(
      {two,
       {},
       {{.spacing = 1, .rows = Rows{0, first}}, {.spacing = 1, .body = 4, .rows = Rows{first, both}}}});
  EXPECT_EQ(component_count(apart), 2u);
  EXPECT_EQ(apart.material_ids.back(), 4u);
  EXPECT_EQ(surfacer.surface_count(), 5u);
}

/// Bodies grow in turns, so that the rows of one are not those of its ids, and steps sort them.
Simulation mixed_simulation() {
  Simulation simulation({.support_radius = 2.9f, .gravity = {0, 0, -0.3f}});
  const auto cube = [](float x, float y) {
    return sample(Lattice{.count = {5, 5, 5}, .spacing = 1, .corner = {x, y, 1}});
  };
  const BodyId jelly = simulation.add_body(cube(0, 0), {.alpha = 0.5f});
  const BodyId fluid = simulation.add_body(cube(9, 0), {.alpha = 1.0f});
  simulation.extend_body(jelly, cube(0, 9));
  simulation.extend_body(fluid, cube(9, 9));
  simulation.add_collider({.shape = Plane{{0, 0, 1}, 0}});
  return simulation;
}

TEST(surface_particles, of_a_simulation_are_drawn_as_copies_in_the_order_of_ids_are) {
  for (const bool joined : {false, true}) {
    Simulation simulation = mixed_simulation();
    Surfacer surfacer({.joined = joined, .smoothing = 1}), other({.joined = joined, .smoothing = 1});
    bool sorted = false;
    for (int frame = 0; frame < 4; ++frame) {
      const std::vector<Vec3> x = simulation.positions_by_id(), v = simulation.velocities_by_id();
      const std::vector<std::uint32_t> bodies_of = simulation.bodies_by_id();
      std::vector<SurfaceBody> bodies;
      for (std::size_t i = 0; i < x.size(); ++i)
        bodies.push_back({.spacing = 1, .body = bodies_of[i], .rows = Rows{i, i + 1}});
      expect_same(surfacer.draw(surface_particles(simulation)), other.draw({x, v, bodies}));
      for (int step = 0; step < 10; ++step) simulation.step();
      sorted = sorted || !std::is_sorted(simulation.ids().begin(), simulation.ids().end());
    }
    EXPECT_TRUE(sorted);
  }
}

TEST(surface_particles, of_a_simulation_are_views) {
  Simulation simulation({.support_radius = 2.9f});
  const BodyId body = simulation.add_body(sample(Lattice{.count = {3, 3, 3}, .spacing = 0.5f}), Material{});
  const SurfaceParticles particles = surface_particles(simulation);
  ASSERT_EQ(particles.bodies.size(), 1u);
  EXPECT_EQ(particles.bodies[0].spacing, simulation.spacing(body));
  EXPECT_EQ(particles.ids.data(), simulation.ids().data());
}

}  // namespace surface_particles_test
}  // namespace mallow
