#include "scaling/cube.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace mallow::bench {
namespace {

/// Length of the waves of velocity, in spacings: several regions.
constexpr float k_wavelength = 16.0f;
/// Their height, in spacings per time step: five steps shear a region by 0.1.
constexpr float k_stir = 0.05f;

/// The paper's.
constexpr float k_time_step = 0.15f, k_update_threshold = 12, k_pressure_coefficient = 16, k_viscosity = 0.5f;
constexpr int k_update_interval = 60;

const std::vector<std::string> k_materials = {"elastic", "paste", "fluid"};

Vec3 stirred(const Vec3& x) {
  const auto wave = [](float value) {
    return std::sin(2 * std::numbers::pi_v<float> * value / k_wavelength);
  };
  return k_stir / k_time_step * Vec3(wave(x.y()), wave(x.z()), wave(x.x()));
}

/// Of a body: they lie in a lattice that is about as wide as it is high.
Vec3 place_of(const Cube& cube, std::size_t body) {
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
  return material == "elastic" ? 0.0f : material == "fluid" ? 1.0f : 0.7f;
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
    body.velocities.reserve(body.positions.size());
    for (const Vec3& x : body.positions) body.velocities.push_back(stirred(x));
    simulation.add_body(body, id, cube.bodies == 1 ? cube.material : std::string());
  }
  simulation.add_collider({.shape = Plane{}, .friction = 0.3f});
  return simulation;
}

}  // namespace mallow::bench
