#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mallow/defaults.h"
#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/instruction_level.h"
#include "mallow/vec3.h"

namespace mallow {

/// The phases of a step, in the order in which they run.
enum class Phase {
  reference_update,  ///< check of the update rule, new reference shapes and regions [TK 3.2]
  neighbors,         ///< cell grid and neighbour lists
  density,           ///< density and pressure [TK eq. 3]
  accelerations,     ///< pressure and viscosity [TK eq. 1, 2, 4]
  time_step,         ///< [TK eq. 12]
  region_sums,       ///< sums over the regions, first of two; all of shape matching for bodies of up to 256
                     ///< particles
  rotations,         ///< polar decompositions
  goals,             ///< goal positions, second of the sums over regions [TK eq. 7]
  volume,            ///< what keeps densities at those at rest [model 2, section 2]
  body_contact,      ///< what keeps bodies out of each other [model 2, section 4 C]
  motion,            ///< blend, contact with colliders, positions [TK eq. 10, 11]
};
inline constexpr std::size_t k_phase_count = 11;  ///< values of Phase
/// "region_sums" and the like.
MALLOW_EXPORT const char* name(Phase phase);

/// Wall time per phase [s].
using PhaseTimes = std::array<double, k_phase_count>;

/// What one step did.
struct StepReport {
  double time_step = 0;          ///< Δt taken [s]
  double max_velocity = 0;       ///< V of eq. 12 [m/s]; 0 where no SPH acts
  bool limited = false;          ///< a limit kept Δt below Δt0; not where only a time to land on did
  bool neighbors_found = false;  ///< neighbour lists were found anew, not kept (SolverConfig::neighbor_slack)
  int updated_references = 0;    ///< bodies whose reference shape was updated at the start of this step
  std::size_t awake_bodies = 0;  ///< that moved in it
  std::size_t drained = 0;       ///< particles that sinks took before it
  /// Of the volume constraint, SolverConfig::volume_iterations: those taken, and the compressions that the
  /// last look found, s = max(0, ρ/ρ0 − 1) at the end of the step as far as velocities say it: with a
  /// tolerance those that are left, without one those before the last iteration.
  int volume_iterations = 0;
  double mean_compression = 0;     ///< over all particles that moved
  double largest_compression = 0;  ///< of one
  PhaseTimes seconds{};
};

/// What happened to a body: see Simulation::events().
struct BodyEvent {
  /// What it was.
  enum class Kind {
    slept,    ///< it is at rest and costs nothing from now on
    woke,     ///< it moves again
    yielded,  ///< its reference shape was updated [TK 3.2], or taken anew as it had flowed [model 2, section
              ///< 5]
    torn,     ///< that left it in more parts than it had
    merged,   ///< that left it in fewer, or it became one with another body: see `other`
    split,    ///< one of its parts is a body of its own from now on: see `other`
    touched,  ///< it touches what it did not; this and the next two where report_contacts() asks for it
    hit,      ///< in this step it got at least the impulse that was asked for from what it touches
    parted,   ///< it touches it no more
  };
  Kind kind;
  BodyId body;
  /// Of torn and merged: those that it has now. Particles are in one part where they share a region of shape
  /// matching, directly or through others; parts of fewer than four particles are crumbs and not counted.
  std::size_t parts = 0;
  std::size_t crumbs = 0;  ///< likewise: those crumbs
  /// Of a contact between bodies: greater than `body`. Of merged: the body that has become part of `body` and
  /// is no more, see Body::merges; none where parts of one body merged. Of split: the body that is new.
  std::optional<BodyId> other = {};
  std::optional<ColliderId> collider = {};  ///< of a contact with a collider
  // Of touched and hit; what the particles that touch did in this step, in the mean by their impulses.
  Vec3 position{0, 0, 0};  ///< between the two bodies, or on the collider [m]
  Vec3 normal{0, 0, 0};    ///< unit length, from what is touched to `body`
  Vec3 impulse{0, 0, 0};   ///< momentum that `body` got from it in the step, friction and all [N s]
  /// Moment of the same about `position` [N m s], as it acts where the particles of `body` are. About another
  /// point c: torque + (position − c) × impulse.
  Vec3 torque{0, 0, 0};
  /// Moment about `position` of what `other` got, −impulse, as it acts where its particles are [N m s]; 0 of
  /// colliders, which get −torque. Particles of two bodies touch a spacing apart: where they rub, the two
  /// torques do not cancel.
  Vec3 other_torque{0, 0, 0};
  float speed = 0;  ///< along the normal at which they came nearer before the step, >= 0 [m/s]
};

/// Energies of all particles that are not pinned [J]; see Simulation::energy().
struct Energy {
  double kinetic = 0;  ///< Σ ½ m v²
  double gravity = 0;  ///< −Σ m g·x
  double elastic = 0;  ///< U of shape matching, whose slope is its pull [model 2, section 4]
  /// What elastic bodies keep exactly at a constant step, to judge them by: U − Σ m g·x + Σ ½ m v·(v + Δt
  /// a(x)), a of gravity and shape matching, Δt the last step. ½ m v² + U swings by itself, by a quarter
  /// where a body is as stiff as its step.
  double conserved = 0;
};

/// What the steps of Simulation::advance() did.
struct AdvanceReport {
  std::int64_t steps = 0;
  double smallest_step = 0;             ///< Δt [s]
  double largest_step = 0;              ///< Δt [s]
  double max_velocity = 0;              ///< largest V of eq. 12 [m/s]
  std::int64_t limited_steps = 0;       ///< StepReport::limited
  std::int64_t updated_references = 0;  ///< updates of reference shapes, summed over bodies
  std::int64_t drained = 0;             ///< particles that sinks took
  std::int64_t volume_iterations = 0;   ///< summed over steps
  double largest_compression = 0;       ///< StepReport::largest_compression, the largest
  PhaseTimes seconds{};

  /// Counts one more step.
  MALLOW_EXPORT void add(const StepReport& step);
};

/// A body in SimulationInfo.
struct BodyInfo {
  std::string name;
  std::string material;
  std::size_t particles = 0;
  float spacing = 0;
  float particle_mass = 0;
  float rest_density = 0;
  float region_radius = 0;
  float alpha = 0;                 ///< now
  float update_threshold = 0;      ///< γ_u in force, to be multiplied by 1 − alpha [m/s²]
  float pressure_coefficient = 0;  ///< k in force [m²/s²]
  float viscosity = 0;             ///< μ in force [Pa s]
  float elastic_time_step = 0;     ///< Δt_SM in force [s]
  /// Y in force, whether it was given or follows from elastic_time_step, to be multiplied by 1 − alpha [Pa].
  float youngs_modulus = 0;
  float most_youngs_modulus = 0;  ///< that the longest step carries, at the lowest alpha there is [Pa]
  double average_neighbors = 0;   ///< mean |N_i| over the reference shape, i included, whatever the stride
  std::size_t regions = 0;        ///< of shape matching, as many as are owned; 0 where none are built
  bool shape_matching = false;    ///< runs now
  /// It falls asleep where it is slower than this [m/s] for sleep_time [s], with all that it touches; in
  /// force, as set or as spacing and gravity have it. 0: it never does.
  double sleep_speed = 0;
  double sleep_time = 0;
};
/// What a simulation runs and holds; see Simulation::info().
struct SimulationInfo {
  std::size_t particles = 0;
  std::vector<BodyInfo> bodies;
  bool sph = false;                                                 ///< SPH sums run
  bool viscosity = false;                                           ///< viscous terms run
  bool cross_group = false;                                         ///< contact between bodies runs
  InstructionLevel instruction_level = InstructionLevel::baseline;  ///< that lanes use
  std::size_t bytes = 0;                                            ///< memory of columns, lists and scratch
  float support_radius = 0;                                         ///< σ [m]
  float time_step = 0;                                              ///< Δt0 [s]
  TimeStepSource time_step_source = TimeStepSource::given;
  float longest_step = 0;    ///< time_step_factor Δt0 [s]
  double update_period = 0;  ///< between checks of the reference shapes, where no step is shortened [s]
  /// The longest step that no limit would shorten, as fast as things are now [s]; infinite where no SPH acts.
  double unlimited_step = 0;
  int volume_iterations = 0;  ///< a step, at most, that keep matter from being pressed together
  /// What can be run, but is hardly meant: a sentence each that names body, setting and value.
  std::vector<std::string> warnings;
};

}  // namespace mallow
