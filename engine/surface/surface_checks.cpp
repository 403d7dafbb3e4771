#include "surface/surface_checks.h"

#include <algorithm>
#include <vector>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "surface/particle_order.h"

namespace mallow {
namespace {

void check_bodies(const SurfaceParticles& particles, Checks& checks) {
  const std::size_t n = particles.positions.size();
  if (n > 0 && particles.bodies.empty()) checks.problem("bodies", "there is none");
  std::vector<std::pair<Simulation::Rows, std::size_t>> taken;
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const SurfaceBody& body = particles.bodies[b];
    check_value(element("bodies", b) + ".spacing", body.spacing, k_positive, checks);
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

std::string element(const char* column, std::size_t index) {
  return column + ('[' + std::to_string(index) + ']');
}

void check_finite(const char* column, const StridedVectors& vectors, Checks& checks) {
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (vectors[i].allFinite()) continue;
    checks.vector(element(column, i), vectors[i]);
    return;
  }
}

void check(const SurfaceConfig& config, int threads) {
  Checks checks;
  check_fields("surface.", config, checks);
  if (config.kind == SurfaceKind::anisotropic) {
    Range radius = range_of(&SurfaceConfig::kernel_radius);
    radius.lowest = 2;
    checks.number(
        "surface.kernel_radius", config.kernel_radius, radius.holds(config.kernel_radius),
        "a number" + range_text(radius) + " for anisotropic kernels: fewer neighbours do not tell a shape");
  }
  check_value("threads", threads, range_of(&SolverConfig::threads), checks);
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
  // Their squares are finite, and so is all that is made of them.
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = particles.positions[i];
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() <= 1e15f) continue;
    checks.problem(element("positions", i), "is farther than 1e15 from 0");
    break;
  }
  check_finite("velocities", particles.velocities, checks);
  checks.finish();
}

}  // namespace mallow
