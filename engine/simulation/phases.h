#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "simulation/state.h"

namespace mallow {
class Checks;

/// Why an id names no particle.
std::string why_unknown(const ParticleStore& store, ParticleId id);

/// What Simulation::prepare() does; reads do it too, as what a step would settle is what they are asked for.
void prepare(Simulation::State& state);

// The phases of step(), in its order. Each says what it reads -> what it writes.

/// time -> alpha of every material, and k where that follows it; what particles have of their own.
void read_alphas(Simulation::State& state);
/// temperatures -> alpha of what follows them.
void follow_temperatures(Simulation::State& state);
/// temperatures -> viscosity of what follows them.
void thin_by_heat(Simulation::State& state);
/// lists of SPH, colliders, air -> temperatures. [Cleary & Monaghan 1999; model 2, section 7] Throws
/// StepError.
void conduct_heat(Simulation::State& state, float time_step);
/// Temperatures of particles that have none yet; what follows from the materials of heated bodies.
void prepare_heat(Simulation::State& state);
/// Throws ConfigError where points have a yield of their own and their body does not flow.
void refuse_yields(const BodyState& body, const Body& points);
/// Throws ConfigError where points have temperatures and their body carries no heat.
void refuse_temperatures(const BodyState& body, const Body& points);
/// Rows [begin, end) of a body, its last ones, are as warm as points say.
void warm_rows(Simulation::State& state, BodyState& body, std::size_t begin, const Body& points);
/// alpha, stiffness, yield of particles -> e_j and yield of the regions of bodies that paint. [model 2,
/// section 7]
void weigh_regions(Simulation::State& state);
/// mean |a_ext| -> reference shapes that give way, their rows sorted; regions that are due; the bodies whose
/// shapes are matched in this step. Returns how many gave way. [TK 3.2, model 6]
int update_references(Simulation::State& state);
/// Rows of bodies without a reference shape into the cell order of the last neighbour search, now and then:
/// what is near in space is near in memory.
void sort_fluids(Simulation::State& state);
/// What moves beside them, or has changed, wakes bodies -> those that move in this step.
void wake_bodies(Simulation::State& state);
/// A body sleeps that is slower than this [m/s] for so long [s], with all that it touches; 0: it never does.
double sleep_speed(const Simulation::State& state, const BodyState& body);
double sleep_time(const Simulation::State& state, const BodyState& body);
/// Bodies that have fallen asleep in this step go on giving colliders what they gave them in it.
void keep_loads(Simulation::State& state, double time_step);
/// The loads of a step begin with those of what sleeps.
void add_resting_loads(Simulation::State& state, double time_step);
/// speeds -> bodies that have been slow for long, with all that they touch, sleep: their velocities are 0.
void rest_bodies(Simulation::State& state, float time_step);
/// positions, colliders -> what walls hold of the volume around the particles of fluids. [model 2, section 2]
void find_walls(Simulation::State& state);
/// densities -> accelerations by the pressure of walls, and what these get of it.
void press_walls(Simulation::State& state);
/// What walls got besides, by block of them and in it by collider [N s], goes where their pressure went.
void add_wall_loads(Simulation::State& state, const std::vector<ColliderLoad>& given, float time_step);
/// predicted velocities, what walls have pushed with -> those that their friction has slowed.
void rub_walls(Simulation::State& state, float time_step);
/// positions, velocities -> user accelerations.
void call_force(Simulation::State& state);
/// positions, velocities -> those at which shapes are matched, x + τ v: the positions themselves where
/// nothing is damped. [model 2, section 4 B]
const VectorColumn& lead_positions(Simulation::State& state);
/// Δt [s] and the time that it leads to.
struct ChosenStep {
  float time_step;
  double end;
};
/// velocities, accelerations, time left until `end` -> Δt, with V in the report. [TK eq. 12, model 3] Throws
/// StepError.
ChosenStep choose_time_step(Simulation::State& state, double end, StepReport& report);
/// Nothing faster moves in any step [m/s]: it would be shorter than steps may be, see
/// Simulation::set_velocity().
double fastest_carried(const Simulation::State& state);
/// A problem where something would be faster than that.
void check_speed(const Simulation::State& state, const char* field, double speed, Checks& checks);
/// everything -> next positions and velocities, mean |a_ext|; one loop does what is asked for, each phase
/// once in a step. [TK eq. 10, 11, 13, model 4, 5] Throws StepError.
void move_bodies(Simulation::State& state, float time_step, const MotionPhases& phases);
/// densities, lists, predicted velocities -> those that keep volumes. [model 2, section 2]
void correct_volume(Simulation::State& state, float time_step, StepReport& report);
/// How contact between bodies is called for.
struct ContactCall {
  bool again = false;       ///< not for the first time in this step
  bool keeps_sums = false;  ///< somebody asks what it gives
};
/// velocities, predicted -> what contact between bodies makes of them.
void touch_bodies(Simulation::State& state, float time_step, const ContactCall& call,
                  VectorColumn& velocities);
/// positions, predicted velocities -> those of bodies that touch. [model 2, section 4 C]
void resolve_touching(Simulation::State& state, float time_step);
/// impulses of the step -> events of contacts that begin, hit and end.
void tell_contacts(Simulation::State& state, float time_step);
/// next positions and velocities become the present ones; time, step and colliders move on.
void finish_step(Simulation::State& state, const ChosenStep& step);

/// Parts of bodies that were torn, and are to split, -> bodies. [Body::splits]
void split_torn(Simulation::State& state);
/// κ of regions, at a check -> bodies that are pressed into each other, which are one from now on: the first
/// of them in the order of rows. Returns how many reference shapes that took anew. [model 2, section 5]
/// Throws StepError.
int join_bodies(Simulation::State& state);
/// time -> layers that leave their emitters, or are put behind them; particles that sinks take. Returns how
/// many these are.
std::size_t flow(Simulation::State& state);
/// Throws ConfigError where one lets its strand out faster than steps carry.
void check_emitters(const Simulation::State& state);
/// Those that were given before the first step said what it carries.
void check_speeds(const Simulation::State& state);
/// keyframes, speeds -> what emitters and the pins of what they hold do in a step that ends at `end` [s].
void drive_emitters(Simulation::State& state, double end, double time_step);
/// Emitters as that step has moved them.
void move_emitters(Simulation::State& state, double end, double time_step);
/// Whether keyframes move what goes through them in a step that begins at `time` [s].
bool are_due(std::span<const PoseKeyframe> keyframes, double time, double longest_step);

/// A body and those that fell asleep with it are awake.
void wake_island(Simulation::State& state, BodyState& body);
void wake_all(Simulation::State& state);
/// Bodies that a collider may touch.
void wake_near(Simulation::State& state, const Collider& collider);
/// Bodies with particles that a pin holds.
void wake_pinned(Simulation::State& state, PinId pin);
/// Bodies that do not move are left where they are: in both sets of columns that steps go to and fro between.
/// Whoever changes rows other than by a step says that they are not held.
void hold_sleepers(Simulation::State& state);

/// positions, velocities of a body -> its rigid motion, where they were changed other than by a step.
void measure_rigid(const Simulation::State& state, BodyState& body);

/// Throws ConfigError where an id names none of a kind.
[[noreturn]] void refuse_id(const char* kind, std::uint64_t id, const Slots& slots);
/// σ of the config -> SPH.
void take_support_radius(Simulation::State& state);
/// m and ρ0 of a body.
void derive_density(const SolverConfig& config, BodyState& body);

/// Takes the positions of a body as its reference shape and sorts its rows for that.
void take_reference(Simulation::State& state, BodyState& body);

/// bodies -> groups of SPH, which of them belong together, the typical spacing of particles.
void describe_bodies(Simulation::State& state);

/// Called behind every phase of a step; tests damage columns there.
using PhaseHook = std::function<void(Phase)>;
/// One step of a prepared simulation: Simulation::step_towards().
StepReport take_step(Simulation::State& state, double end, const PhaseHook& after_phase = {});

/// One body's, for whoever matches its shape outside of a step.
void weigh_regions(const Threads& threads, const ParticleStore& store, BodyState& body);
/// alpha of materials, what changed -> alpha of rows that follow them; what bodies and materials span.
void blend_bodies(Simulation::State& state);
/// Rows [begin, end) of a body, its last ones, get what points say of them.
void paint_rows(Simulation::State& state, BodyState& body, std::size_t begin, const Body& points);
/// A body is about to become one with another of its material: what either paints it paints, and particles of
/// the other one have what they follow now.
void paint_alike(Simulation::State& state, BodyState& body, BodyState& other);
/// The largest (1 − alpha) times stiffness of particles that have their own, at the least alpha that they may
/// come to; 0 where none has.
double painted_elasticity(const Simulation::State& state, const BodyState& body);
/// Throws ConfigError where points make a body too stiff.
void check_elasticity(const Simulation::State& state, const BodyState& body, const Body& points);
/// Throws ConfigError where a body is stiffer than its steps carry.
void check_elasticities(const Simulation::State& state);
/// positions -> pull; that of `share` of the last step goes into the velocities of a body.
void kick_by_pull(Simulation::State& state, BodyState& body, float share);
/// Updates the reference shape of a body where its particles yield, and leaves it where others hold. Returns
/// false where all yield: then the whole is to be taken. [model 2, section 7]
bool update_part(Simulation::State& state, BodyState& body);

/// Writes the wall time between laps into a report.
class PhaseTimer {
 public:
  PhaseTimer(PhaseTimes& seconds, const PhaseHook& after_phase)
      : seconds_(seconds), after_phase_(after_phase), last_(Clock::now()) {}
  void lap(Phase phase) {
    if (after_phase_) after_phase_(phase);
    const Clock::time_point now = Clock::now();
    seconds_[static_cast<std::size_t>(phase)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  PhaseTimes& seconds_;
  const PhaseHook& after_phase_;
  Clock::time_point last_;
};

}  // namespace mallow
