#include "surface/surface_checks.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/checks.h"
#include "surface/particle_order.h"

namespace mallow {
namespace {

std::string element(const char* name, std::size_t index) {
  return name + ('[' + std::to_string(index) + ']');
}

/// The first vector that is not finite.
void check_finite(const char* name, const StridedVectors& values, Checks& checks) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].allFinite()) continue;
    checks.vector(element(name, i), values[i]);
    return;
  }
}

void check_bodies(const SurfaceParticles& particles, Checks& checks) {
  const std::size_t n = particles.positions.size();
  if (n > 0 && particles.bodies.empty()) checks.problem("bodies", "there is none");
  std::vector<std::pair<Simulation::Rows, std::size_t>> taken;
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const SurfaceBody& body = particles.bodies[b];
    checks.number(element("bodies", b) + ".spacing", body.spacing, body.spacing > 0, "a number above 0");
    const Simulation::Rows rows = rows_of(body, n);
    if (rows.begin > rows.end || rows.end > n)
      checks.problem(element("bodies", b) + ".rows", std::to_string(rows.begin) + " to " +
                                                         std::to_string(rows.end) +
                                                         " are not allowed: there are " + std::to_string(n));
    if (rows.begin < rows.end) taken.emplace_back(rows, b);
  }
  std::sort(taken.begin(), taken.end(),
            [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
  for (std::size_t k = 1; k < taken.size(); ++k)
    if (taken[k].first.begin < taken[k - 1].first.end)
      checks.problem(element("bodies", taken[k].second) + ".rows",
                     "some are those of " + element("bodies", taken[k - 1].second) + " too");
}

}  // namespace

void check(const SurfaceConfig& config, int threads) {
  Checks checks;
  if (config.voxel_size)
    checks.number("surface.voxel_size", *config.voxel_size, *config.voxel_size > 0, "a number above 0");
  else if (config.voxels)
    checks.number("surface.voxels", *config.voxels, *config.voxels >= 8 && *config.voxels <= 1024,
                  "8 to 1024");
  else
    checks.number("surface.voxels_per_spacing", config.voxels_per_spacing,
                  config.voxels_per_spacing >= 0.5f && config.voxels_per_spacing <= 16, "0.5 to 16");
  checks.number("surface.kernel_radius", config.kernel_radius,
                config.kernel_radius >= 1 && config.kernel_radius <= 4, "1 to 4 spacings");
  if (config.kind == SurfaceKind::anisotropic)
    checks.number("surface.kernel_radius", config.kernel_radius, config.kernel_radius >= 2,
                  "2 to 4 spacings for anisotropic kernels: fewer neighbours do not tell a shape");
  checks.number("surface.particle_radius", config.particle_radius,
                config.particle_radius >= 0.1f && config.particle_radius <= 1, "0.1 to 1 spacings");
  checks.number("surface.adaptivity", config.adaptivity, config.adaptivity >= 0 && config.adaptivity <= 1,
                "0 to 1 voxels");
  checks.number("surface.smoothing", config.smoothing, config.smoothing >= 0 && config.smoothing <= 100,
                "0 to 100 rounds");
  checks.number("surface.memory_limit", config.memory_limit, config.memory_limit > 0, "a number above 0");
  checks.number("threads", threads, threads >= 0, "0 (all there are) or more");
  checks.finish();
}

void check(const SurfaceParticles& particles) {
  Checks checks;
  const std::size_t n = particles.positions.size();
  const auto each = [&](const char* name, std::size_t count) {
    if (count != 0 && count != n)
      checks.problem(name, std::to_string(count) + " are not allowed: none, or one for each of " +
                               std::to_string(n) + " positions");
  };
  each("velocities", particles.velocities.size());
  each("ids", particles.ids.size());
  check_bodies(particles, checks);
  check_finite("positions", particles.positions, checks);
  check_finite("velocities", particles.velocities, checks);
  checks.finish();
}

}  // namespace mallow
