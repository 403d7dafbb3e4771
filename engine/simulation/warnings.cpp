#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>
#include <utility>

#include "colliders/shapes.h"
#include "config/gravity_units.h"
#include "core/bounds.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"
#include "simulation/warning_list.h"

namespace mallow {
namespace {

/// Weight and rest make a mean |a_ext| of up to about this many |g|.
constexpr float k_resting = 2;
/// From foam to the heaviest metals [kg/m³]. 1 is nobody's: water in g/cm³.
constexpr float k_least_density = 5, k_most_density = 30000;
/// Share of the longest step to which a limit may shorten all of them.
constexpr double k_short_steps = 0.5;
/// The same for viscosity, which matter has: honey and chocolate at 2 mm have more, and who pours them knows.
constexpr double k_thick_steps = 0.05;
/// Neighbours that slow a step down and show nothing: those of ten spacings.
constexpr double k_many_neighbors = 4000;
/// Support radius in spacings beyond which what flows no longer keeps its volume.
constexpr float k_wide_radius = 3.6f;
/// The same beyond which it is more than is usual.
constexpr float k_usual_radius = 3.05f;
/// Strain by the own weight from which on a body is hardly meant to stand.
constexpr float k_own_weight = 0.5f;
/// Height [m] from which on nobody makes matter that bears less than itself: a room full of dough.
constexpr float k_room = 3;
/// Stiffness that holds nothing, and alpha whose share of pressure does not either.
constexpr float k_limp = 1e-3f, k_no_pressure = 0.05f;
/// Damping times as long as so many steps that follow from them.
constexpr float k_long_damping = 3;
/// Spacings within which there are the six nearest and the twelve of diagonals: fewer hold no body together.
constexpr float k_least_radius = 1.45f;
/// Of what an iteration of the volume constraint may do, a share that hardly shows.
constexpr float k_least_share = 0.3f;
/// So many particles of other bodies within a spacing are inside of these: a lattice has four there on the
/// mean, and one that touches has one.
constexpr std::ptrdiff_t k_inside = 3;
/// Of the particles of a region, the stride that leaves fewest regions.
constexpr double k_best_stride = 0.2;
std::string number_text(float value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Nobody means a share of the spacing that is as small as this.
constexpr float k_rounding_depth = 0.01f;

class Warnings {
 public:
  explicit Warnings(const Simulation::State& state)
      : state_(state),
        needs_sph_(state.needs_sph()),
        keeps_volume_(state.keeps_volume()),
        volume_iterations_(state.volume_iterations()),
        merging_(state.materials.size(), 0) {
    for (const BodyState& body : state.bodies) merging_[slot_of(body.material->id)] += body.merges ? 1 : 0;
  }

  std::vector<std::string> list() && {
    for (const BodyState& body : state_.bodies) {
      look_at_threshold(body);
      look_at_merging(body);
      look_at_lone_merging(body);
      look_at_pressure(body);
      look_at_density(body);
      look_at_limits(body);
      look_at_weight(body);
      look_at_damping(body);
      look_at_neighbors(body);
      look_at_stride(body);
      look_at_volume(body);
      look_at_limp(body);
      look_at_sleep(body);
    }
    look_at_sleeping();
    if (state_.step == 0 && state_.bodies.size() > 1) look_at_overlaps();
    if (state_.step == 0)
      for (const BodyState& body : state_.bodies) look_at_colliders(body);
    std::vector<std::string> all = list_.take();
    for (const auto& more : {source_warnings, heat_warnings, matter_warnings})
      std::ranges::copy(more(state_), std::back_inserter(all));
    return all;
  }

 private:
  template <class... Words>
  void add(const BodyState& body, const Words&... words) {
    list_.add(body, words...);
  }

  const char* unit(const char* name) const { return unit_of(state_.config.gravity, name); }

  void look_at_threshold(const BodyState& body) {
    if (!body.material->settings.update_threshold) return;
    const float gravity = state_.config.gravity.norm();
    float alpha = -1;  // the largest below 1 that the schedule names: there the threshold is lowest
    for (const ScheduleKey& key : body.material->settings.alpha.keys())
      if (key.value < 1) alpha = std::max(alpha, key.value);
    const float threshold = body.material->update_threshold * (1 - alpha);
    if (alpha < 0 || threshold >= k_resting * gravity) return;
    add(body, "update_threshold ", body.material->update_threshold, " times 1 - alpha (", alpha, ") is ",
        threshold, unit(" m/s2"), ", below twice gravity (", k_resting * gravity, unit(" m/s2"),
        "): at rest its own weight updates the reference shape, so that it sinks like clay; 40 times "
        "gravity is ",
        40 * gravity);
  }

  /// What is let go is as fast as gravity makes it in the time after which it sleeps.
  void look_at_sleep(const BodyState& body) {
    const double gravity = static_cast<double>(state_.config.gravity.norm());
    const double speed = sleep_speed(state_, body), time = sleep_time(state_, body);
    if (gravity > 0 && speed > gravity * time)
      add(body, "falls asleep in the air, as in sleep_time, ", time,
          " s, gravity makes nothing as fast as sleep_speed, ", speed, unit(" m/s"),
          ": lower sleep_speed, or raise sleep_time above ", speed / gravity, " s");
  }

  void look_at_sleeping() {
    const SolverConfig& config = state_.config;
    if (state_.bodies_sleep() || !(config.sleep_time || config.sleep_speed.value_or(0) > 0)) return;
    const bool by_pressure = config.contact == BodyContact::pressure;
    list_.add(config.sleep_speed.value_or(0) > 0 ? "solver.sleep_speed" : "solver.sleep_time",
              by_pressure ? " has no effect where solver.contact is \"pressure\": nothing sleeps there"
                          : " has no effect where solver.sleep_speed is 0: nothing sleeps");
  }

  /// Whoever merges needs somebody to merge with.
  void look_at_lone_merging(const BodyState& body) {
    if (!body.merges || state_.bodies.size() < 2 || merging_[slot_of(body.material->id)] > 1) return;
    add(body, "merges with nobody: no other body of its material '", body.material->name,
        "' merges; give both one material, and merges on both");
  }

  /// What bodies rub and stick by is of the contact by constraint.
  void look_at_pressure(const BodyState& body) {
    if (state_.config.contact == BodyContact::constraint || state_.bodies.size() < 2) return;
    const Material& material = body.material->settings;
    const bool rubs = material.friction != Material{}.friction;
    if (rubs)
      add(body, "friction ", material.friction,
          " has no effect where solver.contact is \"pressure\": bodies "
          "drag each other by their viscosity");
    if (material.adhesion > 0 && body.matches_shape())
      add(body, "adhesion ", material.adhesion,
          " has no effect where solver.contact is \"pressure\"; leave that "
          "out");
  }

  /// What acts on another body as on itself rubs it only as a fluid does.
  void look_at_merging(const BodyState& body) {
    if (!body.merges || body.touches_what_it_merges_with() ||
        body.material->settings.alpha.lowest() > k_all_but_fluid || merging_[slot_of(body.material->id)] < 2)
      return;
    add(body, "slides along bodies that it merges with, as friction is between bodies that do not",
        body.shape.flows ? ": where they are not pressed together at once, leave merges out"
                         : ", and never becomes one with them, as it has no plastic_yield: leave merges out");
  }

  void look_at_density(const BodyState& body) {
    const float density = body.rest_density;
    if (!is_in_metres(state_.config.gravity)) return;
    if (density >= k_least_density && density <= k_most_density) return;
    std::ostringstream source;
    if (body.material->settings.rest_density)
      source << "is given";
    else
      source << "follows from the spacing and particles of " << body.mass << " kg";
    add(body, "a rest density of ", density, " kg/m3 ", source.str(),
        ": no material has it, if gravity is in metres and seconds; give rest_density, 1000 for water");
  }

  void look_at_limits(const BodyState& body) {
    if (!needs_sph_ || !state_.config.acoustic_limit) return;
    const double longest = static_cast<double>(state_.longest_step());
    const MaterialLimits limits = material_limits(state_, body);
    const auto shortens = [&](double step) {
      std::ostringstream text;
      text << " shortens every step from " << longest << " s to " << step << " s or less; ";
      return text.str();
    };
    const Material& material = body.material->settings;
    const std::string viscosity =
        material.viscosity_by_temperature
            ? "viscosity_by_temperature, " + number_text(body.viscosity) + " at its thickest,"
            : "viscosity " + number_text(body.viscosity);
    if (limits.by_viscosity < k_thick_steps * longest)
      add(body, viscosity, shortens(limits.by_viscosity), "lower it, or raise the spacing, ", body.spacing,
          " m, with whose square steps grow");
    if (limits.by_pressure >= k_short_steps * longest) return;
    if (material.pressure_coefficient)
      add(body, "pressure_coefficient ", *material.pressure_coefficient, shortens(limits.by_pressure),
          material.cohesion > 0 ? "lower it, or cohesion, or solver.time_step, or raise viscosity"
                                : "lower it, or solver.time_step, or raise viscosity");
    else if (material.viscosity || material.viscosity_by_temperature)
      add(body, viscosity, " is too low to calm the pressure that keeps the volume, and",
          shortens(limits.by_pressure), "leave it out, raise it, or give a lower pressure_coefficient");
    else {
      const auto [why, what_to_do] = why_pressure_shortens(body);
      add(body, why, shortens(limits.by_pressure), what_to_do);
    }
  }

  bool is_damped_long(const BodyState& body) const {
    return state_.time_step_source == TimeStepSource::modulus &&
           body.material->settings.damping_time > k_long_damping * state_.base_step();
  }

  /// Where pressure and viscosity are left out: what makes steps so short, or neighbours so many, that
  /// viscosity does not calm the pressure that follows. First what it is, then what to do.
  std::pair<std::string, std::string> why_pressure_shortens(const BodyState& body) const {
    const std::string pressure = "pressure as stiff as they carry",
                      lower = "give a lower pressure_coefficient";
    const float radius = state_.support_radius() / body.spacing;
    const std::optional<float> usual = default_time_step(state_.scale);
    const bool is_usual = radius >= k_least_radius && radius <= k_usual_radius;
    if (!is_usual || !usual || state_.base_step() >= *usual)
      return {"support_radius " + number_text(state_.support_radius()) + ", " + number_text(radius) +
                  " spacings,",
              "2 to 3 spacings are usual, or " + lower};
    if (state_.time_step_source == TimeStepSource::given)
      return {"solver.time_step " + number_text(state_.base_step()) + " s is shorter than the " +
                  number_text(*usual) + " s that suit spacing and gravity: such steps are so short that " +
                  pressure,
              "leave it out, or " + lower + ", or a higher viscosity"};
    if (is_damped_long(body))
      return {"damping_time " + number_text(body.material->settings.damping_time) +
                  " s asks for steps so short that " + pressure,
              "lower it"};
    return {"youngs_modulus asks for steps so short that " + pressure, lower + ", or a higher viscosity"};
  }

  /// What is as stiff as a step can carry leaves no room for another spring.
  void look_at_volume(const BodyState& body) {
    if (volume_iterations_ == 0) return;
    const float share = 2 * volume_relaxation(state_, body, state_.longest_step());
    if (share < k_least_share && !(state_.support_radius() > k_wide_radius * body.spacing))
      add(body, "elasticity and damping are so stiff for a step of ", state_.longest_step(),
          " s that a volume iteration takes ", share,
          " of its share; raise material.elastic_time_step, or lower solver.time_step and give "
          "material.elastic_time_step");
  }

  /// Particles without stiffness, pressure and volume: nothing keeps them apart.
  void look_at_limp(const BodyState& body) {
    if (!body.paints_stiffness || volume_iterations_ > 0) return;
    std::size_t limp = 0;
    for (std::size_t row = body.begin; row < body.end; ++row)
      limp += state_.store.stiffness[row] < k_limp && state_.store.alpha[row] < k_no_pressure ? 1u : 0u;
    if (limp == 0) return;
    add(body, limp,
        " of its particles have a stiffness of 0 or nearly, and an alpha at which no pressure parts ",
        "them: they fall together; give solver.volume_iterations = 2, or them a stiffness or an alpha");
  }

  /// Where elasticity alone bears it, or where it is as high as nobody means.
  void look_at_weight(const BodyState& body) {
    const float modulus =
        state_.stiffness(body, 1 - body.most_alpha()) *
        static_cast<float>(stiffness_scale(state_.config, body.material->settings, body.spacing));
    const Aabb box = box_around(state_.store.position, body.begin, body.end);
    const float height =
        (box.max - box.min).cwiseAbs().dot(state_.config.gravity.cwiseAbs().stableNormalized());
    const float weight =
        body.mass / (body.spacing * body.spacing * body.spacing) * state_.config.gravity.norm() * height;
    if (!body.matches_shape() || !(weight > k_own_weight * modulus)) return;
    if (body.material->settings.youngs_modulus && height > k_room && is_in_metres(state_.config.gravity))
      return add(body, "it is ", height, " m high, and presses with ", weight, " Pa where it is as stiff as ",
                 modulus, " Pa: under a gravity of ", state_.config.gravity.norm(),
                 " m/s2 lengths are in metres; give a hundredth of them if these are centimetres");
    if (body.most_alpha() > 0.2f) return;
    add(body, "its own weight presses with ", weight, unit(" Pa"), ", where it is as stiff as ", modulus,
        unit(" Pa"),
        ": it ends as a layer; raise material.youngs_modulus, or lower solver.time_step where that is "
        "left out");
  }

  void look_at_damping(const BodyState& body) {
    const float time = body.material->settings.damping_time;
    if (!is_damped_long(body)) return;
    add(body, "damping_time ", time, " s shortens every step to ", state_.base_step(),
        " s, as a step carries no stronger damper; lower it");
  }

  void look_at_neighbors(const BodyState& body) {
    const auto look = [&](const char* field, float radius, std::size_t most) {
      const double each = std::min(static_cast<double>(most), full_neighbors(radius, body.spacing));
      if (each > k_many_neighbors)
        add(body, field, ' ', radius, " is ", radius / body.spacing, " spacings: up to ", each,
            " neighbours each, where 30 to 80 are usual, and steps take that much longer");
      if (radius < k_least_radius * body.spacing && body.size() > 1)
        add(body, field, ' ', radius, " is ", radius / body.spacing, " spacings: about ", std::round(each),
            " neighbours each, where 30 to 80 are usual; so few hold no body together, 2.1 spacings do");
    };
    if (needs_sph_ || keeps_volume_) {
      look("support_radius", state_.support_radius(), state_.store.size());
      if (state_.support_radius() > k_wide_radius * body.spacing && body.size() > 1)
        add(body, "support_radius ", state_.support_radius(), " is ", state_.support_radius() / body.spacing,
            " of its spacings: it loses volume, and what rests on it, where 2 to 3 are usual; give bodies of "
            "one scene "
            "alike spacings");
    }
    if (body.keeps_reference()) look("the radius of its regions,", body.shape.region_radius, body.size());
  }

  /// Particles that are in no region own one, so that there are more again beyond a stride of about a fifth
  /// of the particles of a region: of a cube of 20³ 4000 at a stride of 2, 1111 at 8, 3182 at 32.
  void look_at_stride(const BodyState& body) {
    const int stride = body.material->settings.region_stride;
    const double each = full_neighbors(body.shape.region_radius, body.spacing);
    if (!body.shape.built || !(stride > std::max(1.0, each))) return;
    add(body, "region_stride ", stride, " is more than the ", std::round(each),
        " particles of a region: those that would be in none own one too, so that there are ",
        body.shape.region_weight.size(), " for ", body.size(), " particles; about ",
        std::max(1.0, std::round(k_best_stride * each)), " leaves fewest");
  }

  /// Particles that start within another body: contact pushes those apart that are near, by lines between
  /// them, and bodies that stand deep in each other may stay so.
  void look_at_overlaps() {
    float reach = std::numeric_limits<float>::infinity();
    for (const BodyState& body : state_.bodies) reach = std::min(reach, body.spacing);
    const std::size_t n = state_.store.size();
    CellGrid grid;
    NeighborLists lists;
    build_cell_grid(state_.store.position, 0, n, reach, state_.execution, grid);
    build_neighbor_lists(grid, reach, state_.execution, lists);
    std::vector<std::size_t> body_of(n);
    for (std::size_t g = 0; g < state_.bodies.size(); ++g)
      for (std::size_t row = state_.bodies[g].begin; row < state_.bodies[g].end; ++row) body_of[row] = g;
    std::vector<std::size_t> overlapping(state_.bodies.size());
    for (std::size_t s = 0; s < n; ++s) {
      const std::size_t own = body_of[grid.order[s]];
      const auto list = lists.of(s);
      const auto is_another = [&](std::uint32_t t) { return body_of[grid.order[t]] != own; };
      if (std::count_if(list.begin(), list.end(), is_another) >= k_inside) ++overlapping[own];
    }
    for (std::size_t g = 0; g < overlapping.size(); ++g)
      if (overlapping[g] > 0)
        add(state_.bodies[g], overlapping[g], " of ", state_.bodies[g].size(),
            " particles start within another body, and may stay there; move one of the two");
  }

  /// Particles that start within a collider, which drives them out; pinned ones feel none.
  void look_at_colliders(const BodyState& body) {
    const ParticleStore& store = state_.store;
    for (std::size_t c = 0; c < state_.colliders.size(); ++c) {
      std::size_t inside = 0;
      float deepest = -k_rounding_depth * body.spacing;
      for (std::size_t row = body.begin; row < body.end; ++row) {
        if (!store.pin.empty() && store.pin[row] != 0) continue;
        const float distance = nearest(state_.colliders[c], state_.far(store.position.get(row))).distance;
        if (distance < -k_rounding_depth * body.spacing) ++inside;
        deepest = std::min(deepest, distance);
      }
      if (inside > 0)
        add(body, inside, " of ", body.size(), " particles start inside collider ", c, ", up to ", -deepest,
            " m deep, and are driven out; move one of the two");
    }
  }

  const Simulation::State& state_;
  // Of all bodies: asked once, not for each of them.
  const bool needs_sph_, keeps_volume_;
  const int volume_iterations_;
  std::vector<std::size_t> merging_;  ///< bodies of each material that merge
  WarningList list_;
};

}  // namespace

std::vector<std::string> warnings(const Simulation::State& state) {
  return Warnings(state).list();
}

}  // namespace mallow
