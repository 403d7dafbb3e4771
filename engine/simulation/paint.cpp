// Alpha and stiffness that differ by particle within a body. [model 2, section 7]
#include <algorithm>
#include <cmath>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "config/validation.h"
#include "core/parallel.h"
#include "simulation/membership.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"

namespace mallow {
namespace {

/// Columns for all particles, as their materials have it.
void make_columns(Simulation::State& s) {
  if (s.is_painted()) return;
  s.store.alpha.resize(s.store.size());
  s.store.stiffness.resize(s.store.size());
  for (const BodyState& body : s.bodies) {
    std::fill(s.store.alpha.begin() + body.begin, s.store.alpha.begin() + body.end,
              body.material->settings.alpha.at(s.time));
    std::fill(s.store.stiffness.begin() + body.begin, s.store.stiffness.begin() + body.end, 1.0f);
  }
}

/// The least alpha that a row may have: that of a schedule changes.
float least_alpha(const Simulation::State& s, const BodyState& body, std::size_t row) {
  const Material& settings = body.material->settings;
  if (settings.alpha_by_temperature) return settings.alpha_by_temperature->lowest();
  return body.paints_alpha ? s.store.alpha[row] : settings.alpha.lowest();
}

/// Whether steps carry this share of a body's modulus; nothing where they are not known yet.
void check_springs(const Simulation::State& s, const BodyState& body, float share, Checks& checks) {
  if (!s.config.time_step) return;
  const Material& settings = body.material->settings;
  check_elasticity(s.config, settings, with_springs(s.config, settings, body.spacing), share, checks);
}

void check_elasticity(const Simulation::State& s, const BodyState& body, Checks& checks) {
  check_springs(s, body, static_cast<float>(painted_elasticity(s, body)), checks);
}

/// Bodies that have particles among these rows, and a column that they get a value in.
void paint(Simulation::State& s, std::span<const ParticleId> ids, float value, const char* field,
           const Range& range, bool BodyState::*paints, Column<float> ParticleStore::*column) {
  s.refuse_in_callback();
  Checks checks;
  check_value(field, value, range, checks);
  const bool is_alpha = column == &ParticleStore::alpha;
  for (const ParticleId id : ids) {
    const std::optional<std::size_t> row = s.store.slots.find(id);
    if (row && !(is_alpha && s.body_of(*row).material->settings.alpha_by_temperature)) continue;
    if (!row) checks.problem("particle", why_unknown(s.store, id));
    if (row) checks.problem(field, "is not allowed where alpha follows temperature: see set_temperature()");
    break;
  }
  checks.finish();
  if (ids.empty()) return;
  blend_bodies(s);  // which releases columns that nobody uses, so it comes first
  make_columns(s);
  std::vector<float> former;
  std::vector<BodyState*> changed;
  for (const ParticleId id : ids) {
    const std::size_t row = *s.store.slots.find(id);
    former.push_back(std::exchange((s.store.*column)[row], value));
    BodyState& body = s.body_of(row);
    if (std::ranges::find(changed, &body) == changed.end()) changed.push_back(&body);
  }
  std::vector<bool> painted;
  for (BodyState* body : changed) painted.push_back(std::exchange(body->*paints, true));
  for (const BodyState* body : changed) check_elasticity(s, *body, checks);
  try {
    checks.finish();
  } catch (const ConfigError&) {
    for (std::size_t k = ids.size(); k-- > 0;) (s.store.*column)[*s.store.slots.find(ids[k])] = former[k];
    for (std::size_t b = 0; b < changed.size(); ++b) changed[b]->*paints = painted[b];
    throw;
  }
  s.blend_changed = true;
  for (BodyState* body : changed) {
    wake_island(s, *body);
    if (body->merges) s.prepared = false;  // whether it touches what it merges with follows from it
    if (body->keeps_reference() && body->shape.reference.size() != body->size()) {
      body->grew = true;
      s.prepared = false;
    }
  }
}

/// What a body yields at where nothing else is said.
float yield_of(const Material& material) {
  return material.plastic_yield_by_temperature ? material.plastic_yield_by_temperature->highest()
                                               : material.plastic_yield.value_or(0.0f);
}

}  // namespace

double painted_elasticity(const Simulation::State& s, const BodyState& body) {
  double most = 0;
  if (!body.is_painted()) return most;
  for (std::size_t row = body.begin; row < body.end; ++row)
    most = std::max(most, (1 - static_cast<double>(least_alpha(s, body, row))) *
                              static_cast<double>(s.store.stiffness[row]));
  return most;
}

void refuse_yields(const BodyState& body, const Body& points) {
  if (points.plastic_yield.empty() || flows(body.material->settings)) return;
  throw ConfigError("body.plastic_yield", "is not allowed: material '" + body.material->name +
                                              "' does not flow, as it has no plastic_yield");
}

/// The same of the strain from which regions flow, which is a column of its own.
void paint_yields(Simulation::State& s, BodyState& body, std::size_t begin, const Body& points) {
  const Material& settings = body.material->settings;
  if (!points.plastic_yield.empty() || settings.plastic_yield_by_temperature) {
    s.store.plastic_yield.resize(s.store.size());
    if (!body.paints_yield)
      std::fill(s.store.plastic_yield.begin() + body.begin, s.store.plastic_yield.begin() + body.end,
                yield_of(settings));
    body.paints_yield = true;
  }
  if (!body.paints_yield) return;
  for (std::size_t row = begin; row < body.end; ++row)
    s.store.plastic_yield[row] =
        points.plastic_yield.empty() ? yield_of(settings) : points.plastic_yield[row - begin];
}

void paint_rows(Simulation::State& s, BodyState& body, std::size_t begin, const Body& points) {
  if (!points.alpha.empty() || body.material->settings.alpha_by_temperature) body.paints_alpha = true;
  if (!points.stiffness.empty()) body.paints_stiffness = true;
  paint_yields(s, body, begin, points);
  if (body.is_painted()) make_columns(s);
  if (!s.is_painted()) return;
  const float alpha = body.material->settings.alpha.at(s.time);
  for (std::size_t row = begin; row < body.end; ++row) {
    s.store.alpha[row] = points.alpha.empty() ? alpha : points.alpha[row - begin];
    s.store.stiffness[row] = points.stiffness.empty() ? 1.0f : points.stiffness[row - begin];
  }
}

namespace {

/// What the particles of a painted body span.
BlendRange blend_of(Simulation::State& s, const BodyState& body) {
  const float *const alpha = s.store.alpha.data() + body.begin, *const stiffness =
                                                                    s.store.stiffness.data() + body.begin;
  const auto both = [](const BlendRange& a, const BlendRange& b) {
    return BlendRange{.least_alpha = std::min(a.least_alpha, b.least_alpha),
                      .most_alpha = std::max(a.most_alpha, b.most_alpha),
                      .most_elasticity = std::max(a.most_elasticity, b.most_elasticity)};
  };
  const BlendRange none{.least_alpha = 1, .most_alpha = 0, .most_elasticity = 0};
  const auto of_block = [&](std::size_t begin, std::size_t end) {
    BlendRange blend = none;
    for (std::size_t i = begin; i < end; ++i)
      blend = both(blend, {.least_alpha = alpha[i],
                           .most_alpha = alpha[i],
                           .most_elasticity = (1.0f - alpha[i]) * stiffness[i]});
    return blend;
  };
  return parallel_reduce(s.execution.threads, body.size(), s.partial_blends, none, of_block, both);
}

}  // namespace

void paint_alike(Simulation::State& s, BodyState& body, BodyState& other) {
  if (body.paints_yield != other.paints_yield) {
    const BodyState& plain = body.paints_yield ? other : body;
    std::fill(s.store.plastic_yield.begin() + plain.begin, s.store.plastic_yield.begin() + plain.end,
              yield_of(plain.material->settings));
  }
  body.paints_alpha = body.paints_alpha || other.paints_alpha;
  body.paints_stiffness = body.paints_stiffness || other.paints_stiffness;
  body.paints_yield = body.paints_yield || other.paints_yield;
}

void blend_bodies(Simulation::State& s) {
  if (!s.blend_changed) return;
  s.blend_changed = false;
  if (std::ranges::none_of(s.bodies, &BodyState::is_painted)) {
    s.store.alpha.release();
    s.store.stiffness.release();
  }
  for (MaterialState& material : s.materials) {
    material.most_alpha = material.alpha;
    material.most_elasticity = 1.0f - material.alpha;
  }
  if (!s.is_painted()) return;
  for (BodyState& body : s.bodies) body.material->most_alpha = body.material->most_elasticity = 0;
  for (BodyState& body : s.bodies) {
    MaterialState& material = *body.material;
    float* const alpha = s.store.alpha.data();
    if (!body.paints_alpha) std::fill(alpha + body.begin, alpha + body.end, material.alpha);
    if (!body.is_painted()) {
      material.most_alpha = std::max(material.most_alpha, material.alpha);
      material.most_elasticity = std::max(material.most_elasticity, 1.0f - material.alpha);
      continue;
    }
    body.blend = blend_of(s, body);
    material.most_alpha = std::max(material.most_alpha, body.blend.most_alpha);
    material.most_elasticity = std::max(material.most_elasticity, body.blend.most_elasticity);
  }
}

void check_elasticity(const Simulation::State& s, const BodyState& body, const Body& points) {
  const Material& settings = body.material->settings;
  if (points.alpha.empty() && points.stiffness.empty() && !settings.alpha_by_temperature) return;
  const bool own = !points.alpha.empty() && !settings.alpha_by_temperature;
  const float alpha = lowest_alpha(settings);
  float most = 0;
  for (std::size_t k = 0; k < points.positions.size(); ++k)
    most = std::max(most, (1 - (own ? points.alpha[k] : alpha)) *
                              (points.stiffness.empty() ? 1.0f : points.stiffness[k]));
  Checks checks;
  check_springs(s, body, most, checks);
  checks.finish();
}

void check_elasticities(const Simulation::State& s) {
  for (const BodyState& body : s.bodies) {
    if (!body.is_painted()) continue;
    Checks checks;
    check_elasticity(s, body, checks);
    try {
      checks.finish();
    } catch (const ConfigError& error) {
      throw ConfigError("body '" + body.name + "'", error.what());
    }
  }
}

namespace {

/// Writes value(row of its owner) for each region of a body, or nothing where the column is empty.
template <class Value>
void fill_regions(const Threads& threads, const BodyState& body, Column<float>& column, const Value& value) {
  parallel_for(threads, column.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) column[j] = value(body.begin + body.shape.owner(j));
  });
}

void limit_regions(const Threads& threads, const ParticleStore& store, BodyState& body) {
  Column<float>& yield = body.shape.plastic.yield;
  yield.resize(body.paints_yield ? body.shape.region_weight.size() : 0);
  fill_regions(threads, body, yield, [&](std::size_t row) { return store.plastic_yield[row]; });
}

}  // namespace

void weigh_regions(const Threads& threads, const ParticleStore& store, BodyState& body) {
  ShapeMatching& shape = body.shape;
  shape.elasticity.resize(body.is_painted() ? shape.region_weight.size() : 0);
  fill_regions(threads, body, shape.elasticity,
               [&](std::size_t row) { return (1.0f - store.alpha[row]) * store.stiffness[row]; });
}

void weigh_regions(Simulation::State& s) {
  for (BodyState* body : s.awake) {
    if (body->matches_shape() && body->shape.flows) limit_regions(s.execution.threads, s.store, *body);
    if (body->matches_shape() && (body->is_painted() || !body->shape.elasticity.empty()))
      weigh_regions(s.execution.threads, s.store, *body);
  }
}

bool update_part(Simulation::State& s, BodyState& body) {
  if (!body.paints_alpha) return false;
  std::vector<std::uint8_t> yields(body.size());
  const auto mean = static_cast<float>(body.judged_external);
  for (std::size_t i = 0; i < yields.size(); ++i)
    yields[i] = mean > body.material->update_threshold * (1.0f - s.store.alpha[body.begin + i]);
  if (std::ranges::find(yields, 0) == yields.end()) return false;
  // What the old shape pulled in half a step, less what the new one will: as where the whole is updated,
  // where that is nothing.
  kick_by_pull(s, body, 0.5f);
  CarriedRegions carried = carry_regions(body.shape);
  rest_anew(s.store.position, body.begin, yields, s.execution, carried, body.shape);
  const std::vector<ParticleId> ids(s.store.id.begin() + body.begin, s.store.id.begin() + body.end);
  rebuild_shape(s, body, carried);
  std::vector<std::uint32_t> order(ids.size());
  for (std::uint32_t i = 0; i < ids.size(); ++i) order[*s.store.slots.find(ids[i]) - body.begin] = i;
  sort_parts(order, s.parts_before);
  s.rows_moved();
  kick_by_pull(s, body, -0.5f);
  return true;
}

void Simulation::set_alpha(std::span<const ParticleId> ids, float alpha) {
  paint(*state_, ids, alpha, "alpha", range_of(&Material::alpha), &BodyState::paints_alpha,
        &ParticleStore::alpha);
}

void Simulation::set_stiffness(std::span<const ParticleId> ids, float stiffness) {
  paint(*state_, ids, stiffness, "stiffness", k_stiffness_factor, &BodyState::paints_stiffness,
        &ParticleStore::stiffness);
}

std::span<const float> Simulation::alphas() const {
  return state_->store.alpha.span();
}

std::span<const float> Simulation::stiffnesses() const {
  return state_->store.stiffness.span();
}

float Simulation::alpha(ParticleId id) const {
  const std::size_t at = row(id);
  return state_->is_painted() ? state_->store.alpha[at] : state_->body_of(at).material->alpha;
}

}  // namespace mallow
