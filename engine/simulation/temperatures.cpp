// Temperatures of particles, and what follows them. [model 2, section 7]
#include <algorithm>
#include <cmath>
#include <sstream>

#include "colliders/collider_checks.h"
#include "core/parallel.h"
#include "simulation/damage.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

HeatConstants constants_of(const Material& material) {
  return {.conductivity = static_cast<double>(material.conductivity),
          .specific_heat = static_cast<double>(material.specific_heat),
          .latent_heat = static_cast<double>(material.latent_heat),
          .solidus = static_cast<double>(material.solidus.value_or(0)),
          .liquidus = static_cast<double>(material.liquidus.value_or(0)),
          .heat_transfer = static_cast<double>(material.heat_transfer)};
}

void make_columns(Simulation::State& s) {
  if (!s.store.temperature.empty()) return;
  s.store.temperature.resize(s.store.size());
  s.store.temperature_rest.resize(s.store.size());
}

/// Calls body(rows) for those of all bodies of which `follows` holds, in blocks.
template <class Follows, class Rows>
void for_rows_of(Simulation::State& s, const Follows& follows, const Rows& rows) {
  for (BodyState& body : s.bodies) {
    if (!body.is_heated || !follows(*body.material)) continue;
    parallel_for(s.execution.threads, body.size(), [&](std::size_t begin, std::size_t end) {
      rows(body, body.begin + begin, body.begin + end);
    });
  }
}

}  // namespace

void refuse_temperatures(const BodyState& body, const Body& points) {
  if (points.temperature.empty() || body.material->carries_heat()) return;
  throw ConfigError("body.temperature", "is not allowed: material '" + body.material->name +
                                            "' carries no heat, as it has no temperature");
}

void warm_rows(Simulation::State& s, BodyState& body, std::size_t begin, const Body& points) {
  const Material& material = body.material->settings;
  if (!material.temperature) return;
  make_columns(s);
  body.is_heated = true;
  for (std::size_t row = begin; row < body.end; ++row) {
    s.store.temperature[row] =
        points.temperature.empty() ? *material.temperature : points.temperature[row - begin];
    s.store.temperature_rest[row] = 0;
  }
}

void prepare_heat(Simulation::State& s) {
  Heat& heat = s.heat;
  s.sph.keeps_lists = false;
  heat.groups.clear();
  heat.bodies.clear();
  for (BodyState& body : s.bodies) {
    // A material may have come to carry heat, and to follow it, since the body was added.
    if (body.material->carries_heat() && !body.is_heated) warm_rows(s, body, body.begin, {});
    body.is_heated = body.material->carries_heat();
    const Material& settings = body.material->settings;
    if (body.is_heated && ((settings.alpha_by_temperature && !body.paints_alpha) ||
                           (settings.plastic_yield_by_temperature && !body.paints_yield))) {
      paint_rows(s, body, body.begin, {});
      body.grew = body.grew || body.shape.reference.size() != body.size();
    }
  }
  if (std::ranges::none_of(s.bodies, &BodyState::is_heated)) {
    s.store.temperature.release();
    s.store.temperature_rest.release();
    heat = {};
    return;
  }
  s.sph.keeps_lists = s.sph.groups.size() > 1;
  heat.groups.resize(s.sph.groups.size());
  heat.lattices.assign(s.sph.groups.size(), {});
  for (const BodyState& body : s.bodies) {
    if (!body.is_heated) continue;
    constexpr float k_touching = 1.25f;  // spacings
    const HeatLattice lattice = heat_lattice(s.sph.kernel, static_cast<double>(s.support_radius()),
                                             static_cast<double>(body.spacing));
    heat.groups[body.sph_group] = {.conductivity = body.material->settings.conductivity,
                                   .factor = lattice.factor * body.spacing,
                                   .touch = k_touching * body.spacing};
    heat.lattices[body.sph_group] = lattice;
    heat.bodies.push_back({.begin = body.begin,
                           .end = body.end,
                           .group = body.sph_group,
                           .spacing = body.spacing,
                           .mass = static_cast<double>(body.mass),
                           .inward = s.contact_offset(body) - 0.5f * body.spacing,
                           .constants = constants_of(body.material->settings),
                           .lattice = lattice});
  }
}

void follow_temperatures(Simulation::State& s) {
  const auto follows = [](const MaterialState& material) {
    return material.settings.alpha_by_temperature.has_value();
  };
  for_rows_of(s, follows, [&](const BodyState& body, std::size_t begin, std::size_t end) {
    const Schedule& alpha = *body.material->settings.alpha_by_temperature;
    for (std::size_t row = begin; row < end; ++row)
      s.store.alpha[row] = alpha.at(static_cast<double>(s.store.temperature[row]));
  });
  if (std::ranges::any_of(s.bodies,
                          [&](const BodyState& body) { return body.is_heated && follows(*body.material); }))
    s.blend_changed = true;
  const auto softens = [](const MaterialState& material) {
    return material.settings.plastic_yield_by_temperature.has_value();
  };
  for_rows_of(s, softens, [&](const BodyState& body, std::size_t begin, std::size_t end) {
    const Schedule& yield = *body.material->settings.plastic_yield_by_temperature;
    for (std::size_t row = begin; row < end; ++row)
      s.store.plastic_yield[row] = yield.at(static_cast<double>(s.store.temperature[row]));
  });
}

void thin_by_heat(Simulation::State& s) {
  const auto follows = [](const MaterialState& material) {
    return material.settings.viscosity_by_temperature.has_value();
  };
  const auto thins = [&](const BodyState& body) { return body.is_heated && follows(*body.material); };
  if (std::ranges::none_of(s.bodies, thins)) return s.viscosity.resize(0);
  s.viscosity.resize(s.store.size());
  for (const BodyState& body : s.bodies)
    if (!thins(body))
      std::fill(s.viscosity.begin() + body.begin, s.viscosity.begin() + body.end, body.viscosity);
  for_rows_of(s, follows, [&](const BodyState& body, std::size_t begin, std::size_t end) {
    const Schedule& viscosity = *body.material->settings.viscosity_by_temperature;
    for (std::size_t row = begin; row < end; ++row)
      s.viscosity[row] = viscosity.at(static_cast<double>(s.store.temperature[row]));
  });
  // Limits on the step go by the thickest.
  for (BodyState& body : s.bodies)
    if (thins(body))
      body.viscosity = *std::max_element(s.viscosity.begin() + body.begin, s.viscosity.begin() + body.end);
}

void conduct_heat(Simulation::State& s, float time_step) {
  if (s.heat.bodies.empty() || s.awake.empty()) return;
  Heat& heat = s.heat;
  std::size_t known = 0;
  for (const BodyState& body : s.bodies) {
    if (!body.is_heated) continue;
    HeatedBody& heated = heat.bodies[known++];
    heated.begin = body.begin;
    heated.end = body.enabled ? body.end : body.begin;
  }
  heat.colliders.clear();
  for (const Collider& collider : s.colliders)
    heat.colliders.push_back(
        {.is_heated = collider.temperature.has_value(),
         .temperature = collider.temperature ? static_cast<double>(collider.temperature->at(s.time)) : 0,
         .inverse_transfer = collider.heat_transfer ? 1 / static_cast<double>(*collider.heat_transfer) : 0});
  heat.air_temperature = static_cast<double>(s.config.air_temperature.at(s.time));
  const double parts =
      conduct(s.sph, s.placed_colliders, static_cast<double>(time_step), s.execution,
              {s.store.position, s.store.velocity, s.store.temperature, s.store.temperature_rest}, heat);
  if (parts <= k_most_heat_parts) return;
  std::ostringstream text = describe_particle(s, static_cast<std::uint32_t>(heat.bodies.front().begin));
  text << "carries heat that spreads so fast that a step of " << time_step << " s would take " << parts
       << " parts, and " << k_most_heat_parts
       << " are allowed; lower material.conductivity, or heat_transfer of what it touches, raise "
          "material.specific_heat, or lower solver.time_step (now "
       << s.base_step() << ")";
  throw StepError(text.str(), s.store.id[heat.bodies.front().begin], Phase::motion);
}

void Simulation::set_temperature(std::span<const ParticleId> ids, float temperature) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  checks.number("temperature", temperature, std::isfinite(temperature), "a finite number");
  checks.finish();
  for (const ParticleId id : ids)
    if (!s.body_of(row(id)).is_heated)
      throw ConfigError("temperature", "is not allowed: particle " + std::to_string(id) + " is of body '" +
                                           s.body_of(row(id)).name + "', which carries no heat");
  for (const ParticleId id : ids) {
    s.store.temperature[row(id)] = temperature;
    s.store.temperature_rest[row(id)] = 0;
  }
}

void Simulation::set_temperature(ColliderId id, const std::optional<Schedule>& temperature) {
  state_->refuse_in_callback();
  Collider changed = collider(id);
  changed.temperature = temperature;
  Checks checks;
  check(changed, checks);
  checks.finish();
  state_->colliders[state_->index(id)].temperature = temperature;
}

std::span<const float> Simulation::temperatures() const {
  return state_->store.temperature.span();
}

double Simulation::heat(BodyId id) const {
  const BodyState& body = std::as_const(*state_).body(id);
  if (!body.is_heated) return 0;
  const HeatConstants constants = constants_of(body.material->settings);
  double sum = 0;
  for (std::size_t row = body.begin; row < body.end; ++row)
    sum += constants.enthalpy(static_cast<double>(state_->store.temperature[row]) +
                              static_cast<double>(state_->store.temperature_rest[row]));
  return static_cast<double>(body.mass) * sum;
}

}  // namespace mallow
