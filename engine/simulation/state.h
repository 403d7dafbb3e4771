#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "contact/body_contact.h"
#include "core/box_tree.h"
#include "core/disjoint_sets.h"
#include "core/execution.h"
#include "core/slots.h"
#include "core/stable_list.h"
#include "heat/heat.h"
#include "mallow/simulation.h"
#include "motion/motion.h"
#include "motion/time_step.h"
#include "particles/particle_store.h"
#include "shape_matching/parts.h"
#include "shape_matching/shape_matching.h"
#include "simulation/body_names.h"
#include "simulation/near_origin.h"
#include "simulation/placed_rows.h"
#include "sph/sph.h"
#include "sph/volume.h"

namespace mallow {

/// Alpha beyond which nothing to speak of is held in shape.
inline constexpr float k_all_but_fluid = 0.9f;
/// Pins are named by 16 bits a particle.
inline constexpr std::size_t k_max_pins = 65535;

/// What bodies are made of, for all of them that share it.
struct MaterialState {
  MaterialId id{};
  std::string name;        ///< never empty, but where the slot is nobody's
  bool stays = true;       ///< without bodies too
  std::size_t bodies = 0;  ///< that are made of it
  Material settings;
  float alpha = 0;  ///< at the present time
  /// Of all particles of its bodies, where some have their own: that k suits.
  float most_alpha = 0, most_elasticity = 1;
  float update_threshold = 0;  ///< γ_u in force [m/s²]

  bool is_there() const { return !name.empty(); }
  bool carries_heat() const { return settings.temperature.has_value(); }
  bool keeps_reference() const { return settings.alpha.lowest() < 1.0f; }
};

/// What the particles of a body span that differ.
struct BlendRange {
  float least_alpha = 0, most_alpha = 0;
  float most_elasticity = 1;  ///< largest (1 − α) times stiffness
};

/// A range of rows and its reference shape.
struct BodyState {
  BodyId id{};
  std::string name;
  MaterialState* material = nullptr;
  bool merges = false;             ///< Body::merges
  bool splits = false;             ///< Body::splits
  std::size_t begin = 0, end = 0;  ///< rows
  float spacing = 0;               ///< h [m]
  float mass = 0;                  ///< m [kg]
  float rest_density = 0;          ///< ρ0 [kg/m³]
  float viscosity = 0;             ///< μ in force [Pa s]
  float elastic_time_step = 0;     ///< Δt_SM in force [s]
  std::uint32_t merge_group = 0;   ///< that of bodies which may become one with this one, and its own
  std::uint32_t sph_group = 0;     ///< that of bodies which act on this one as its own parts do, and its own
  double judged_external = 0;      ///< |a_ext| that the next check judges [m/s²]
  /// Mean |a_ext| of the last steps since the last check: those that a time_step reaches back to.
  struct External {
    double seconds, mean;
  };
  std::vector<External> recent_external;
  double step_external = 0;        ///< mean |a_ext| in the step under way [m/s²]
  bool measures_external = false;  ///< in it
  RigidMotion rigid;               ///< kept where deformations are damped towards it
  bool apart = false;              ///< its reference shape was updated, and it may be in several parts
  std::string whole = {};       ///< of a part that was split off: what the body is called that it was part of
  std::uint32_t last_part = 1;  ///< the number of the last part of the same whole that was split off
  bool enabled = true;          ///< see Simulation::enable()
  std::uint64_t user_data = 0;
  std::optional<double> hit_impulse;  ///< see Simulation::report_contacts(): what says it there [N s]
  /// Those that fell asleep together share a number, that of the slot of one of them and 1, and wake
  /// together; 0: it is awake.
  std::uint32_t island = 0;
  double slow_time = 0;   ///< for how long it has been slower than what may sleep [s]
  double mean_speed = 0;  ///< of its particles, after the last step [m/s]
  Aabb box = {};          ///< around its particles while it sleeps [m]
  /// What it gives a collider a second.
  struct RestingLoad {
    std::uint64_t collider;  ///< its id
    ColliderLoad load;       ///< [N, N m]
  };
  std::vector<RestingLoad> resting;                     ///< while it sleeps, where loads are measured
  bool paints_alpha = false, paints_stiffness = false;  ///< its particles have their own
  bool paints_yield = false;                            ///< likewise, or follow temperatures in it
  bool is_heated = false;                               ///< its particles have a temperature
  BlendRange blend;                                     ///< of one that paints
  bool grew = true;                                     ///< has particles that prepare() has not seen
  ShapeMatching shape;                                  ///< empty where alpha is never below 1

  std::size_t size() const { return end - begin; }
  bool is_painted() const { return paints_alpha || paints_stiffness; }
  float most_alpha() const { return is_painted() ? blend.most_alpha : material->alpha; }
  bool keeps_reference() const { return paints_alpha || material->keeps_reference(); }
  bool matches_shape() const { return (is_painted() ? blend.least_alpha : material->alpha) < 1.0f; }
  /// Its alpha changes, up to where nothing is held: what it rested in before that is not what it rests in
  /// after.
  bool melts() const {
    const Schedule& alpha = material->settings.alpha_by_temperature.value_or(material->settings.alpha);
    return alpha.highest() > k_all_but_fluid && alpha.lowest() < alpha.highest();
  }
  /// It can become one with others and never is a fluid: until then they touch as bodies do, with friction.
  bool touches_what_it_merges_with() const {
    const Schedule& alpha = material->settings.alpha_by_temperature.value_or(material->settings.alpha);
    return material->settings.plastic_yield && !paints_alpha && alpha.highest() <= k_all_but_fluid;
  }
  /// The paper's rule updates its reference shape: where regions flow, only if it is asked for, or what has
  /// melted would set in the shape that it had, far from where it is.
  bool follows_threshold() const {
    return keeps_reference() && (!shape.flows || material->settings.update_threshold.has_value() || melts());
  }
  bool moves() const { return enabled && island == 0; }
  /// Its regions have a plastic stretch, and may have flowed.
  bool flows() const { return shape.flows && matches_shape() && shape.built; }
};

/// Particles that answer to nothing but this.
struct PinState {
  PinId id{};
  Vec3 velocity{0, 0, 0};  ///< [m/s]
  Vec3 left{0, 0, 0};      ///< way to where it is told to be [m]
  double seconds = 0;      ///< in which it gets there; 0: it is told a velocity
};

/// A nozzle and the layers of its strand that have not passed it.
struct EmitterState {
  EmitterId id{};
  Emitter settings;
  BodyId body{};
  PinId pin{};
  std::uint64_t layers = 0;  ///< that there have been
  double offset = 0;         ///< how far the first of them has come [m]
  double speed = 0;          ///< of the strand in the step under way [m/s]
  double late = 0;           ///< how long its strand was not enabled: its own clock stood still [s]
  std::deque<std::vector<ParticleId>> held = {};  ///< the last of them, the next to leave first
};

struct SinkState {
  SinkId id{};
  Aabb box;
  bool outside = false;
  std::uint64_t drained = 0;  ///< particles that it took
};

/// Who touches whom: a body, and a collider or a body of a greater id. In the order in which events tell of
/// it.
struct ContactKey {
  std::uint64_t body;
  bool of_bodies;
  std::uint64_t other;
  auto operator<=>(const ContactKey&) const = default;
};

/// Contacts that events() tells of.
struct Contacts {
  struct Lasting {
    ContactKey key;
    double apart = 0;  ///< for how long nothing has pushed [s]
  };
  std::optional<double> hit_impulse;  ///< of bodies that come [N s]
  std::vector<Lasting> lasting;       ///< ascending

  // Scratch.
  struct Found {
    ContactKey key;
    std::size_t order;  ///< in which sums are taken
    ContactSums sums;
  };
  std::vector<BodyTouch> touches;
  std::vector<Found> found;
  std::vector<Lasting> next;
};

/// Which bodies touch each other; of bodies by their index.
struct Islands {
  DisjointSets sets;
  // Scratch, by body and by number of the islands that sleep.
  std::vector<std::uint32_t> first_of_group, first_of_sleepers;
  std::vector<bool> rests;
  // Bodies by the number of their island, from first_of[island] on, ascending; empty where bodies have fallen
  // asleep or gone since. What has come or woken since is still where it was.
  std::vector<std::uint32_t> by_island, first_of;
};

/// Bodies that are pressed into each other. Scratch of join_bodies().
struct Pressed {
  struct Part {
    std::uint32_t body;      ///< its index
    std::size_t begin, end;  ///< of rows: its particles that have flowed enough to become one with others
    Aabb box;                ///< around them [m]
  };
  std::vector<std::uint32_t> bodies;  ///< that may become one with others, by their index
  std::vector<Part> parts;
  std::vector<Aabb> boxes;  ///< of the parts
  BoxTree tree;             ///< of these
  std::vector<std::uint32_t> rows;
  std::vector<std::uint32_t> owner;  ///< per point of the search: the index of its body
  DisjointSets sets;                 ///< of bodies by their index
};

/// A body that has become part of another.
struct EndedBody {
  std::uint64_t id;
  BodyId part_of;  ///< of the one that is there, or was the last
};

/// All that a simulation is.
struct Simulation::State {
  SolverConfig config;
  Execution execution;  ///< threads of config.executor
  std::int64_t step = 0;
  double time = 0;
  double last_time_step = 0;       ///< Δt of the last step; 0 before the first [s]
  double passed_periods = 0;       ///< multiples of the update period before the step under way
  SceneScale scale{.spacing = 0};  ///< of the first prepare(); spacing 0 before it
  TimeStepSource time_step_source = TimeStepSource::given;

  Vec3 origin{0, 0, 0};  ///< that positions in the store are relative to, see choose_origin() [m]
  ParticleStore store;
  std::deque<MaterialState> materials;  ///< by slot; bodies point to them
  Slots material_slots;                 ///< MaterialId -> index, which is its slot
  StableList<BodyState> bodies;         ///< in the order of their rows
  Slots body_slots;                     ///< BodyId -> index
  BodyNames body_names;
  std::vector<Collider> colliders;
  std::vector<std::uint64_t> collider_ids;  ///< of each collider
  Slots collider_slots;                     ///< ColliderId -> index
  std::vector<PinState> pins;               ///< by slot; those that are nobody's hold nothing
  Slots pin_slots;                          ///< PinId -> index, which is its slot
  std::vector<EmitterState> emitters;
  std::vector<SinkState> sinks;
  std::uint64_t emitter_count = 0, sink_count = 0;  ///< that there have been
  std::vector<BodyEvent> events;                    ///< of the last step, and of calls before it
  std::vector<BodyEvent> next_events;               ///< of calls since then
  std::size_t events_of_calls = 0;                  ///< the first of `events`, while a step is taken
  std::vector<EndedBody> ended;                     ///< as they became one with others, the last of each slot
  Contacts contacts;
  ForceCallback force;
  Sph sph;
  Heat heat;
  Column<float> viscosity;  ///< μ by row, where it follows temperatures; else empty [Pa s]
  Volume volume;
  VectorColumn user_acceleration;  ///< empty without a force callback

  /// Positions as the user sees them, of step `far_step`; empty where the origin is 0.
  VectorColumn far_position;
  std::int64_t far_step = -1;

  bool prepared = false;
  bool blend_changed = true;      ///< α or stiffness of some particles, or whose they are
  bool held = true;               ///< those that do not move lie where they are in both sets of columns
  bool density_ran = false;       ///< in the last step
  bool sph_ran = false;           ///< accelerations of SPH in the last step
  std::vector<BodyState*> awake;  ///< bodies that move in the step under way
  PlacedRows placed;              ///< between calls that add bodies
  // Scratch.
  RegionScratch region_scratch;
  Parts parts_before, parts_after;  ///< of a body whose reference shape is updated
  Pressed pressed;
  MatchedBodies matched;  ///< those whose shape is matched in the step under way
  FastestInput fastest;
  MovingBodies moving;
  Column<std::uint32_t> fluid_order;      ///< by row of the store: rows of its body
  std::vector<std::uint32_t> fluid_rows;  ///< of each body, those that are in it
  std::vector<TimeStepLimits::Pressure> pressures;
  std::vector<PlacedCollider> placed_colliders;
  /// The same without friction, for fluids that stick to walls, where there are any.
  std::vector<PlacedCollider> slippery_colliders;
  std::vector<PinMotion> pin_motions;
  Islands islands;
  RangeBlocks led_blocks;
  VectorColumn led_position;  ///< see lead_positions(); empty without damping
  std::vector<BlendRange> partial_blends;
  std::vector<TouchingBody> touching;
  ContactPairs contact_pairs;

  /// σ. Known from the first prepare() on [m].
  float support_radius() const { return *config.support_radius; }
  /// Δt0, and what bounds the steps that are taken. Known from the first prepare() on [s].
  float base_step() const { return *config.time_step; }
  float longest_step() const { return config.time_step_factor * *config.time_step; }
  /// Δt0 as spacing and gravity have it, also where a modulus asks for shorter steps: what hardly moves, and
  /// for how long, does not follow from how stiff something is [s].
  float scene_step() const {
    if (time_step_source != TimeStepSource::modulus) return base_step();
    return default_time_step(scale).value_or(base_step());
  }
  /// Throw ConfigError where there is none of this name, or no longer.
  const BodyState& body(BodyId id) const;
  BodyState& body(BodyId id) { return const_cast<BodyState&>(std::as_const(*this).body(id)); }
  std::size_t index(ColliderId id) const;
  PinState& pin(PinId id);
  MaterialState& material(MaterialId id);
  /// Its place among the bodies.
  std::uint32_t place_of(const BodyState& body) const { return body_slots.index[slot_of(body.id)]; }
  /// The body of a row.
  const BodyState& body_of(std::size_t row) const {
    return *std::ranges::upper_bound(bodies, row, {}, &BodyState::end);
  }
  BodyState& body_of(std::size_t row) { return *std::ranges::upper_bound(bodies, row, {}, &BodyState::end); }
  bool is_far() const { return origin != Vec3(0, 0, 0); }
  /// A position of the store as the user sees it.
  Vec3 far(const Vec3& x) const { return (origin.cast<double>() + x.cast<double>()).cast<float>(); }
  /// The position column as the user sees it.
  const VectorColumn& seen_positions();
  /// What knows particles by their rows forgets them.
  void rows_moved() {
    sph.kept.forget();
    placed.forget();
    far_step = -1;
  }
  /// There are other rows than before: what a step left is of no use.
  void rows_changed();
  bool in_force_callback = false;
  /// Throws ConfigError in a force callback, which sees a step half done: nothing may change then.
  void refuse_in_callback() const;
  /// Throws ConfigError where a step cannot lead towards `end`, as that is not after the present time.
  void require_ahead(double end) const;

  /// Some acceleration of SPH counts: pairs within a body that is not purely elastic, or between bodies where
  /// those are kept apart by pressure.
  bool needs_sph() const;
  /// Of a step, at most: as given, or what bodies that flow ask for.
  int volume_iterations() const;
  /// Velocities are changed so that densities stay, whatever alpha is.
  bool keeps_volume() const {
    return volume_iterations() > 0 &&
           std::ranges::any_of(bodies, [](const BodyState& body) { return body.moves(); });
  }
  /// There are bodies that do not merge, and contact keeps them apart.
  bool bodies_touch() const { return sph.apart && sph.groups.size() > 1; }
  /// What has been slow for long falls asleep.
  bool bodies_sleep() const {
    return config.contact == BodyContact::constraint && config.sleep_speed.value_or(1) > 0;
  }
  /// Some contacts are told of.
  bool reports_contacts() const {
    return std::ranges::any_of(bodies, [](const BodyState& body) { return body.hit_impulse.has_value(); });
  }
  /// Of the pull towards goals, (1 − α)/(Δt0 Δt_SM) [1/s²], where (1 − α) is `share`. [TK eq. 13]
  float stiffness(const BodyState& body, float share) const {
    return share / (base_step() * body.elastic_time_step);
  }
  /// Of a body, whose regions may have their own share already.
  float stiffness(const BodyState& body) const {
    return stiffness(body, body.is_painted() ? 1.0f : 1.0f - body.material->alpha);
  }
  /// Of the stiffest region of a body.
  float most_stiffness(const BodyState& body) const {
    return stiffness(body, body.is_painted() ? body.blend.most_elasticity : 1.0f - body.material->alpha);
  }
  /// Some particles have their own alpha or stiffness: SPH blends pair by pair.
  bool is_painted() const { return !store.alpha.empty(); }
  /// Rate at which deformations are damped, ζ [1/s].
  float deformation_damping(const BodyState& body) const;
  const VectorColumn* cross_group() const {
    return sph_ran && sph.groups.size() > 1 && !sph.apart ? &sph.cross_group : nullptr;
  }
  const VectorColumn* walls() const { return sph_ran && sph.walls.any ? &sph.walls.acceleration : nullptr; }
  /// Whether walls hold it by its viscosity where it is a fluid: see Material::adhesion.
  bool sticks_to_walls(const BodyState& body) const {
    return body.material->settings.adhesion > 0 && body.most_alpha() >= 1 && !sph.walls.bodies.empty();
  }
  /// Distance at which a particle of a body touches a collider [m].
  float contact_offset(const BodyState& body) const {
    return config.contact_offset.value_or(0.5f * body.spacing);
  }
  const VectorColumn* user() const { return force ? &user_acceleration : nullptr; }
};

}  // namespace mallow
