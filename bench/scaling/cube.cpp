#include "scaling/cube.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "program/failure.h"

namespace mallow::bench {
namespace {

/// Length of the waves of velocity, in spacings: several regions.
constexpr float k_wavelength = 16.0f;
/// Their height, in spacings per time step: five steps shear a region by 0.1.
constexpr float k_stir = 0.05f;

/// The paper's.
constexpr float k_time_step = 0.15f, k_update_threshold = 12, k_pressure_coefficient = 16, k_viscosity = 0.5f;
constexpr int k_update_interval = 60;

const std::vector<std::string> k_materials = {"elastic", "gel", "paste", "fluid"};

Vec3 stirred(const Vec3& x) {
  const auto wave = [](float value) {
    return std::sin(2 * std::numbers::pi_v<float> * value / k_wavelength);
  };
  return k_stir / k_time_step * Vec3(wave(x.y()), wave(x.z()), wave(x.x()));
}

/// A heap falls until nearly all of it touches, and sleeps before the last [s].
constexpr double k_fallen = 25, k_asleep = 400;
/// So that the weight of a heap of 200 bodies of 5³ is a twentieth of its stiffness, and no more.
constexpr float k_heap_gravity = 0.1f;
constexpr float k_room = 1.25f;  ///< of a body in a bin, as a share of its width

/// Bodies side by side in a bin, of which half as many fill it as would lie on each other.
std::size_t across_bin(const Cube& cube) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::cbrt(static_cast<double>(cube.bodies) / 3)));
}
float bin_width(const Cube& cube) {
  return static_cast<float>(across_bin(cube)) * k_room *
             static_cast<float>(*std::ranges::max_element(cube.count)) +
         1;
}
/// Of a body that falls into a bin: each layer is a little aside of that below.
Vec3 place_above_bin(const Cube& cube, std::size_t body) {
  const std::size_t across = across_bin(cube), layer = body / across / across;
  const auto width = static_cast<float>(*std::ranges::max_element(cube.count));
  const float pitch = k_room * width;
  return {0.6f + pitch * static_cast<float>(body % across) + 0.2f * static_cast<float>(layer % 2),
          0.6f + pitch * static_cast<float>(body / across % across) + 0.1f * static_cast<float>(layer % 3),
          0.6f + (width + 0.4f) * static_cast<float>(layer)};
}

/// Of a body: they lie in a lattice that is about as wide as it is high.
Vec3 place_of(const Cube& cube, std::size_t body) {
  if (cube.in_a_bin()) return place_above_bin(cube, body);
  constexpr float k_apart = 4;  // beyond what SPH and contact look at
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(cube.bodies)) - 1e-9));
  const std::size_t cell[3] = {body % side, body / side % side, body / side / side};
  Vec3 place;
  for (int a = 0; a < 3; ++a)
    place[a] = static_cast<float>(cell[a]) * (static_cast<float>(cube.count[static_cast<std::size_t>(a)]) +
                                              (cube.between == "apart" ? k_apart : 0));
  return place;
}

}  // namespace

std::size_t Cube::particles() const {
  return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
         static_cast<std::size_t>(count[2]) * bodies;
}

std::span<const std::string> cube_materials() {
  return k_materials;
}

float cube_alpha(const std::string& material) {
  return material == "elastic" ? 0.0f : material == "gel" ? 0.3f : material == "fluid" ? 1.0f : 0.7f;
}

std::vector<std::size_t> cube_sizes(std::size_t min, std::size_t max) {
  std::vector<std::size_t> sizes;
  for (std::size_t n = min; n <= max; n *= 2) sizes.push_back(n);
  return sizes;
}

Cube make_cube(const std::string& material, std::size_t particles, std::size_t bodies,
               const std::string& between) {
  const double n = static_cast<double>(particles) / static_cast<double>(bodies);
  const double a = std::max(1.0, std::round(std::cbrt(n)));
  const double b = std::max(1.0, std::round(std::sqrt(n / a)));
  const double c = std::max(1.0, std::round(n / (a * b)));
  return {material, {static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)}, bodies, between};
}

double average_neighbors(const Cube& cube) {
  const auto reach = static_cast<int>(k_cube_radius);
  double pairs = 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        if (static_cast<float>(x * x + y * y + z * z) > k_cube_radius * k_cube_radius) continue;
        // Points that have one at this offset.
        double points = 1;
        const int offset[3] = {x, y, z};
        for (std::size_t a = 0; a < 3; ++a) points *= std::max(0, cube.count[a] - std::abs(offset[a]));
        pairs += points;
      }
  return pairs * static_cast<double>(cube.bodies) / static_cast<double>(cube.particles());
}

Simulation build(const Cube& cube, int threads, std::shared_ptr<Executor> executor) {
  SolverConfig config;
  config.time_step = k_time_step;
  config.support_radius = k_cube_radius;
  config.update_interval = k_update_interval;
  config.threads = threads;
  config.executor = std::move(executor);
  if (cube.in_a_bin()) config.gravity = {0, 0, -k_heap_gravity};
  Simulation simulation(config);

  Material material;
  material.alpha = cube_alpha(cube.material);
  material.update_threshold = k_update_threshold;
  material.pressure_coefficient = k_pressure_coefficient;
  material.viscosity = k_viscosity;
  const MaterialId id = simulation.add_material(material, cube.material);
  const Body one = sample(Lattice{.count = cube.count, .spacing = 1.0f, .jitter = 0});
  for (std::size_t b = 0; b < cube.bodies; ++b) {
    Body body = one;
    body.merges = cube.between == "merging";
    for (Vec3& x : body.positions) x += place_of(cube, b);
    if (!cube.in_a_bin())
      for (const Vec3& x : body.positions) body.velocities.push_back(stirred(x));
    simulation.add_body(body, id, cube.bodies == 1 ? cube.material : std::string());
  }
  simulation.add_collider({.shape = Plane{}, .friction = 0.3f});
  if (cube.in_a_bin()) {
    const float width = bin_width(cube);
    simulation.add_collider({.shape = Box{{0, 0, -10}, {width, width, 10000}, true}, .friction = 0.3f});
  }
  return simulation;
}

void settle(const Cube& cube, Simulation& simulation) {
  if (!cube.in_a_bin()) return;
  while (simulation.time() < k_fallen) simulation.step();
  if (cube.between == "heap") return;
  std::size_t awake = cube.bodies;
  while (awake > 0 && simulation.time() < k_asleep) awake = simulation.step().awake_bodies;
  if (awake > 0)
    throw program::RunFailure("a heap of " + std::to_string(cube.bodies) + " bodies does not fall asleep");
}

}  // namespace mallow::bench
