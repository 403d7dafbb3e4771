// Heat by pairs over the lists of SPH (Cleary & Monaghan 1999), from colliders and to the air; latent heat as
// enthalpy. In double by row: a step adds less than a float shows of a temperature.
#include "heat/heat.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Share of the difference to its surroundings that a particle gives up in a part of a step, at most.
constexpr double k_share = 0.8;
/// Clusters that one thread handles at a time.
constexpr std::size_t k_cluster_block = 16;
/// Particles this near to a collider touch it: those of the first layer [h].
constexpr float k_touch = 1.0f;

/// ρ/ρ0 of every place, in order, is what pairs count by.
void find_openness(const Sph& sph, const Execution& execution, Heat& heat) {
  const std::size_t n = sph.grid.order.size();
  heat.openness.resize(n);
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t group = sph.group.empty() ? 0 : sph.group[i];
      heat.openness[i] = openness(heat.lattices[group], sph.density[i] / sph.groups[group].rest_density);
    }
  });
}

void sum_flows(const Sph& sph, const HeatedColumns& columns, const Execution& execution, Heat& heat) {
  const std::size_t n = sph.grid.order.size();
  heat.sorted.resize(n);
  parallel_for(execution.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) heat.sorted[i] = columns.temperature[sph.grid.order[i]];
  });
  const HeatInput in{.lists = view(sph.grid, sph.lists),
                     .group = sph.group.empty() ? nullptr : sph.group.data(),
                     .groups = heat.groups.data(),
                     .position = raw(sph.grid.sorted),
                     .temperature = heat.sorted.data(),
                     .openness = heat.openness.data(),
                     .inverse_radius = 1.0f / sph.support_radius};
  const HeatLanes& lanes = MALLOW_SELECT(execution.level, heat_lanes);
  parallel_for(
      execution.threads, sph.grid.clusters(),
      [&](std::size_t begin, std::size_t end) {
        lanes.flows(in, begin, end, heat.flow.data(), heat.conductance.data());
      },
      k_cluster_block);
}

/// What the rows of a block exchange with colliders that they touch, and else with the air.
void find_surface(const HeatedBody& body, const Sph& sph, std::size_t begin, std::size_t end,
                  std::span<const PlacedCollider> placed, const HeatedColumns& columns, Heat& heat,
                  std::vector<NearWall>& near) {
  for (std::size_t row = begin; row < end; ++row) heat.surface[row] = {0, 0};
  near.clear();
  const auto is_heated = [](const HeatedCollider& collider) { return collider.is_heated; };
  if (std::ranges::any_of(heat.colliders, is_heated))
    find_near_walls(columns.position, columns.velocity, begin, end, placed,
                    body.inward + k_touch * body.spacing, near);
  const double h = static_cast<double>(body.spacing), kappa = body.constants.conductivity;
  for (const NearWall& wall : near) {
    const HeatedCollider& collider = heat.colliders[wall.collider];
    if (!collider.is_heated || !(kappa > 0)) continue;
    const double way =
        static_cast<double>(wall.distance - body.inward) - static_cast<double>(body.lattice.resistance) * h;
    const double g = h * h / (std::max(way, 0.125 * h) / kappa + collider.inverse_transfer);
    heat.surface[wall.row].conductance += g;
    heat.surface[wall.row].flow += g * collider.temperature;
  }
  if (!(body.constants.heat_transfer > 0)) return;
  const float rest_density = sph.groups[body.group].rest_density;
  for (std::size_t row = begin; row < end; ++row) {
    Heat::Surface& surface = heat.surface[row];
    if (surface.conductance > 0) continue;
    const float exposed = exposed_share(sph.density_by_row[row] / rest_density);
    const double area = h * h * static_cast<double>(exposed / body.lattice.exposure);
    surface.conductance = body.constants.heat_transfer * area;
    surface.flow = surface.conductance * heat.air_temperature;
  }
}

void heat_rows(const HeatedBody& body, std::size_t begin, std::size_t end, double time_step,
               const HeatedColumns& columns, const Heat& heat) {
  const HeatConstants& c = body.constants;
  for (std::size_t row = begin; row < end; ++row) {
    const double before =
        static_cast<double>(columns.temperature[row]) + static_cast<double>(columns.rest[row]);
    const Heat::Surface& surface = heat.surface[row];
    const double power = static_cast<double>(heat.flow[row]) + (surface.flow - surface.conductance * before);
    const double gained = time_step * power / body.mass;
    const double after =
        c.latent_heat > 0 ? c.temperature(c.enthalpy(before) + gained) : before + gained / c.specific_heat;
    columns.temperature[row] = static_cast<float>(after);
    columns.rest[row] = static_cast<float>(after - static_cast<double>(columns.temperature[row]));
  }
}

}  // namespace

double HeatConstants::enthalpy(double temperature) const {
  const double above = temperature - solidus;
  if (!(latent_heat > 0)) return specific_heat * above;
  return specific_heat * above + latent_heat * std::clamp(above / (liquidus - solidus), 0.0, 1.0);
}

double HeatConstants::temperature(double enthalpy) const {
  const double range = liquidus - solidus;
  if (!(latent_heat > 0) || enthalpy <= 0) return solidus + enthalpy / specific_heat;
  if (enthalpy >= specific_heat * range + latent_heat)
    return solidus + (enthalpy - latent_heat) / specific_heat;
  return solidus + enthalpy / (specific_heat + latent_heat / range);
}

std::size_t Heat::bytes() const {
  return sorted.bytes() + openness.bytes() + flow.bytes() + conductance.bytes() +
         surface.capacity() * sizeof(Surface);
}

double conduct(const Sph& sph, std::span<const PlacedCollider> placed, double time_step,
               const Execution& execution, const HeatedColumns& columns, Heat& heat) {
  heat.flow.resize(columns.position.size());
  heat.conductance.resize(columns.position.size());
  heat.surface.resize(columns.position.size());
  heat.blocks.clear();
  for (const HeatedBody& body : heat.bodies) heat.blocks.add(body.end - body.begin);
  heat.near.resize(heat.blocks.blocks.size());
  heat.fastest.assign(heat.blocks.blocks.size(), 0);
  find_openness(sph, execution, heat);
  sum_flows(sph, columns, execution, heat);
  parallel_for(execution.threads, heat.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const HeatedBody& body = heat.bodies[block.range];
    const std::size_t begin = body.begin + block.begin, end = body.begin + block.end;
    find_surface(body, sph, begin, end, placed, columns, heat, heat.near[number]);
    double most = 0;
    for (std::size_t row = begin; row < end; ++row)
      most = std::max(most, static_cast<double>(heat.conductance[row]) + heat.surface[row].conductance);
    heat.fastest[number] = most / (body.mass * body.constants.specific_heat);
  });
  double fastest = 0;
  for (const double rate : heat.fastest) fastest = std::max(fastest, rate);
  const double parts = std::max(1.0, std::ceil(time_step * fastest / k_share));
  if (!(parts <= k_most_heat_parts)) return parts;
  for (double part = 0; part < parts; ++part) {
    if (part > 0) sum_flows(sph, columns, execution, heat);
    parallel_for(execution.threads, heat.blocks, [&](const RangeBlocks::Block& block, std::size_t) {
      const HeatedBody& body = heat.bodies[block.range];
      heat_rows(body, body.begin + block.begin, body.begin + block.end, time_step / parts, columns, heat);
    });
  }
  return parts;
}

}  // namespace mallow
