// Settings of heat that nobody means: what carries none, what never gets there, and degrees Celsius.
#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "config/gravity_units.h"
#include "mallow/materials.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/warning_list.h"

namespace mallow {
namespace {

/// Nitrogen freezes at 63 K: what is colder beside kelvins is in degrees Celsius, or in another unit. Warmer
/// plates may be of either, and are nobody's mistake.
constexpr float k_coldest_meant = 70;
constexpr float k_ice = 273.15f;  // [K]
/// [J/(kg K)]
constexpr float k_least_specific_heat = 100;

/// Least and most of some temperatures [K].
struct TemperatureRange {
  float least = std::numeric_limits<float>::infinity(), most = -least;

  void reach(float from, float to) {
    least = std::min(least, from);
    most = std::max(most, to);
  }
  void reach(const Schedule& schedule) { reach(schedule.lowest(), schedule.highest()); }
};

/// What is in kelvins, and what to do beside giving kelvins.
struct Kelvins {
  std::string of, or_else;
};

/// The air is as it is where nothing is said of it.
bool is_left_out(const Schedule& air) {
  const SolverConfig usual;
  return air.keys().size() == 1 && air.lowest() == usual.air_temperature.lowest();
}

/// Alpha at the start; nothing where it is left out.
std::optional<float> given_alpha(const Material& material) {
  return material.alpha.highest() > 0 ? std::optional(material.alpha.at(0)) : std::nullopt;
}

class HeatWarnings {
 public:
  explicit HeatWarnings(const Simulation::State& state) : state_(state) {}

  std::vector<std::string> list() && {
    find_temperatures();
    const bool is_in_kelvins = look_at_degrees();
    for (const BodyState& body : state_.bodies) {
      look_at_lack(body);
      look_at_conductivity(body);
      look_at_specific_heat(body);
      const Material& material = body.material->settings;
      look_at_both(body, "alpha", given_alpha, material.alpha_by_temperature);
      look_at_both(
          body, "viscosity", [](const Material& one) { return one.viscosity; },
          material.viscosity_by_temperature);
      look_at_both(
          body, "plastic_yield", [](const Material& one) { return one.plastic_yield; },
          material.plastic_yield_by_temperature);
      if (!is_in_kelvins) continue;
      look_at_keys(body, "alpha", material.alpha_by_temperature);
      look_at_keys(body, "viscosity", material.viscosity_by_temperature);
      look_at_keys(body, "plastic_yield", material.plastic_yield_by_temperature);
    }
    look_at_colliders();
    return list_.take();
  }

 private:
  /// What heats nothing.
  void look_at_colliders() {
    if (state_.bodies.empty() || std::ranges::any_of(state_.bodies, [](const BodyState& body) {
          return body.material->carries_heat();
        }))
      return;
    for (std::size_t c = 0; c < state_.colliders.size(); ++c)
      if (state_.colliders[c].temperature)
        list_.add("collider ", c,
                  ": its temperature has no effect, as no body carries heat; give "
                  "material.temperature and conductivity");
  }

  /// Of the particles of a body, and of those that an emitter will give it.
  TemperatureRange temperatures_of(const BodyState& body) const {
    TemperatureRange range;
    const std::optional<float>& usual = body.material->settings.temperature;
    if (!body.is_heated || !usual) return range;
    for (std::size_t row = body.begin; row < body.end; ++row)
      range.reach(state_.store.temperature[row], state_.store.temperature[row]);
    const bool grows = std::ranges::any_of(
        state_.emitters, [&](const EmitterState& emitter) { return emitter.body == body.id; });
    if (grows || body.size() == 0) range.reach(*usual);
    return range;
  }

  static bool meets_air(const BodyState& body) {
    return body.is_heated && body.material->settings.heat_transfer > 0;
  }

  /// Between which all heat is.
  void find_temperatures() {
    for (const BodyState& body : state_.bodies) {
      const TemperatureRange own = temperatures_of(body);
      all_.reach(own.least, own.most);
      if (meets_air(body)) all_.reach(state_.config.air_temperature);
    }
    for (const Collider& collider : state_.colliders)
      if (collider.temperature) all_.reach(*collider.temperature);
  }

  /// What counts for nothing without a temperature.
  void look_at_lack(const BodyState& body) {
    const Material& material = body.material->settings;
    if (material.temperature) return;
    std::ostringstream text;
    int given = 0;
    const auto name = [&](const char* field, float value, bool is_given) {
      if (!is_given) return;
      text << (given++ > 0 ? ", " : "") << field << ' ' << value;
    };
    name("conductivity", material.conductivity, material.conductivity > 0);
    name("specific_heat", material.specific_heat, material.specific_heat != Material{}.specific_heat);
    name("latent_heat", material.latent_heat, material.latent_heat > 0);
    name("solidus", material.solidus.value_or(0), material.solidus.has_value());
    name("liquidus", material.liquidus.value_or(0), material.liquidus.has_value());
    name("heat_transfer", material.heat_transfer, material.heat_transfer > 0);
    if (given > 0)
      list_.add(body, text.str(), given > 1 ? " have" : " has",
                " no effect, as it carries no heat; give material.temperature");
  }

  void look_at_conductivity(const BodyState& body) {
    const Material& material = body.material->settings;
    const bool follows = material.alpha_by_temperature || material.viscosity_by_temperature ||
                         material.plastic_yield_by_temperature;
    if (material.temperature && follows && material.conductivity == 0)
      list_.add(body, "no heat passes through it, as its conductivity is 0; give material.conductivity");
  }

  /// A specific heat in kJ/(kg K): no solid or liquid has so little but heavy metals, from 120 J/(kg K).
  void look_at_specific_heat(const BodyState& body) {
    const float heat = body.material->settings.specific_heat;
    if (!body.material->settings.temperature || heat >= k_least_specific_heat ||
        !is_in_metres(state_.config.gravity))
      return;
    list_.add(body, "specific_heat ", heat,
              " J/(kg K): no material has so little, if gravity is in metres and seconds; give ", 1000 * heat,
              " for ", heat, " kJ/(kg K)");
  }

  /// What is given beside keys by temperature, which alone count. A material by name may have what it starts
  /// with beside them, and so may who starts with that.
  void look_at_both(const BodyState& body, const char* what, std::optional<float> (*given)(const Material&),
                    const std::optional<Schedule>& keys) {
    const Material& material = body.material->settings;
    const std::optional<float> value = given(material);
    if (!keys || !material.temperature || !value) return;
    if (*value == keys->at(static_cast<double>(*material.temperature))) return;
    const MaterialPreset* known = find_preset(body.material->name);
    if (known && value == given(known->material)) return;
    list_.add(body, what, ' ', *value, " has no effect, as ", what, "_by_temperature is what it follows, ",
              keys->at(static_cast<double>(*material.temperature)), " at its temperature of ",
              *material.temperature, "; change that, or leave it out");
  }

  /// Nothing that there is gets where the schedule changes.
  bool is_never_reached(const Schedule& schedule) const {
    const std::vector<ScheduleKey>& keys = schedule.keys();
    return keys.back().time <= all_.least || keys.front().time >= all_.most;
  }

  /// What changes by temperature, where no temperature that there is changes it. What lies where alpha
  /// changes, and that change has begun, is the rest of one change: butter gets thinner as it melts, and a
  /// warm room softens it.
  void look_at_keys(const BodyState& body, const char* what, const std::optional<Schedule>& schedule) {
    if (!body.material->settings.temperature || !schedule || schedule->lowest() == schedule->highest() ||
        !is_never_reached(*schedule))
      return;
    const std::vector<ScheduleKey>& keys = schedule->keys();
    const std::optional<Schedule>& alpha = body.material->settings.alpha_by_temperature;
    if (alpha && !is_never_reached(*alpha) && keys.front().time <= alpha->keys().back().time &&
        keys.back().time >= alpha->keys().front().time)
      return;
    const bool is_warm = keys.back().time <= all_.least;
    list_.add(body, what, "_by_temperature changes from ", keys.front().time, " to ", keys.back().time,
              " K, but nothing is ", is_warm ? "colder" : "warmer", " than ",
              is_warm ? all_.least : all_.most,
              " K, neither at the start nor of colliders or the air that give heat: ", what, " stays ",
              schedule->at(static_cast<double>(all_.least)));
  }

  /// What is in kelvins whatever else is given, and what to do beside giving kelvins; nothing where all may
  /// be in another unit.
  Kelvins what_is_in_kelvins() const {
    if (is_left_out(state_.config.air_temperature) && std::ranges::any_of(state_.bodies, meets_air))
      return {"an air of 293.15 K, as solver.air_temperature is left out",
              ", or solver.air_temperature in the same unit"};
    for (const BodyState& body : state_.bodies) {
      const MaterialPreset* known = body.is_heated ? find_preset(body.material->name) : nullptr;
      if (known && known->material.solidus && body.material->settings.solidus == known->material.solidus)
        return {"the kelvins in which material '" + body.material->name + "' melts", ""};
    }
    return {};
  }

  /// Whether all is in one unit.
  bool look_at_degrees() {
    const Kelvins kelvins = what_is_in_kelvins();
    if (kelvins.of.empty()) return true;
    bool is_in_kelvins = true;
    const auto look = [&](const std::string& whose, float temperature) {
      if (temperature >= k_coldest_meant) return;
      is_in_kelvins = false;
      list_.add(whose, ": a temperature of ", temperature, " stands beside ", kelvins.of,
                ", and in kelvins nothing is so cold that is meant to flow or set; give ",
                temperature + k_ice, " for ", temperature, " degrees Celsius", kelvins.or_else);
    };
    for (const BodyState& body : state_.bodies)
      look("body '" + body.name + '\'', temperatures_of(body).least);
    for (std::size_t c = 0; c < state_.colliders.size(); ++c)
      if (const auto& temperature = state_.colliders[c].temperature)
        look("collider " + std::to_string(c), temperature->lowest());
    if (std::ranges::any_of(state_.bodies, meets_air))
      look("solver.air_temperature", state_.config.air_temperature.lowest());
    return is_in_kelvins;
  }

  const Simulation::State& state_;
  TemperatureRange all_;
  WarningList list_;
};

}  // namespace

std::vector<std::string> heat_warnings(const Simulation::State& state) {
  return HeatWarnings(state).list();
}

}  // namespace mallow
