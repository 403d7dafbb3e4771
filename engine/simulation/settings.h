#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/column.h"
#include "mallow/export.h"
#include "mallow/simulation.h"

/// What configs leave out, and what they ask for: settled in prepare(), before anything is allocated.
namespace mallow {

struct BodyState;
struct MaterialState;

/// The longest of some vectors.
float largest_norm(const VectorColumn& vectors);
/// Share of k that acts between bodies where k follows alpha: what makes it that of alpha 1.
float contact_share(float alpha);
/// Share of a default k that negative pressures have before cohesion takes its own.
float cohesive_share(float support_radius, float pressure_coefficient, float time_step);

/// m [kg] and ρ0 [kg/m³]; what the material leaves out follows from ρ0 = m Σ W over the lattice. [model 1]
struct ParticleDensity {
  float mass, rest_density;
};
ParticleDensity particle_density(const SolverConfig& config, const Material& material, float spacing);
/// Radii of SPH and of the regions of a body [m]; of SPH that of its own spacing where it is left out and not
/// settled.
float support_radius(const SolverConfig& config, float spacing);
float region_radius(const SolverConfig& config, const Material& material, float spacing);

/// Spacing and speeds -> scale, support_radius, time_step and its source, if this is the first prepare(); γ_u
/// of every material, μ and Δt_SM of every body. Throws ConfigError where nothing says how long a step is,
/// where steps are too long for a material's springs, or where a default is beyond single precision.
void resolve_settings(Simulation::State& state);
/// How steps are taken from now on: Simulation::set_solver().
void change_solver(Simulation::State& state, const SolverConfig& config);
/// Whether a setting of SolverConfig may change while a simulation runs. field: its name in the field table.
MALLOW_EXPORT bool changes_while_running(std::string_view field);
/// α, settings -> k of every body in the sums of SPH.
void resolve_pressures(Simulation::State& state);
/// k in force.
float pressure_coefficient(const Simulation::State& state, const BodyState& body);

/// Time between checks of the reference shapes, where no step is shortened [s].
double update_period(const Simulation::State& state);
/// Whether the step that starts now begins with a check of the reference shapes.
bool update_is_due(const Simulation::State& state);
/// Whether it begins with a look for what tears: a gap is judged while what made it is still there. By time,
/// so that neither steps nor checks change what tears.
bool tear_look_is_due(const Simulation::State& state);
/// Whether the next check judges what acts on bodies in the step that starts now.
bool is_judged(const Simulation::State& state);
/// At the end of a step, before time moves on: what it measured counts at the check that is next, and what
/// was judged at its start no more. The largest mean over a Δt0 that ends with a step counts; where checks
/// are counted in steps, the step before the check. [TK 3.2]
void add_external(Simulation::State& state, double time_step);

/// Throws ConfigError where several points have no neighbours at all within the radii of their material.
void check_neighbors(const Simulation::State& state, const Material& material, const Body& points);
/// Throws ConfigError where neighbour lists would take more memory than allowed.
void check_memory(const Simulation::State& state);

/// To what the material of a body bounds all steps where SPH acts [s].
struct MaterialLimits {
  double by_pressure;   ///< which viscosity calms
  double by_viscosity;  ///< which diffuses
};
MaterialLimits material_limits(const Simulation::State& state, const BodyState& body);
/// Share of the compression that a volume iteration takes from a body in a step of `time_step` [s].
float volume_relaxation(const Simulation::State& state, const BodyState& body, float time_step);
/// What can be run, but is hardly meant. alpha and defaults are settled.
std::vector<std::string> warnings(const Simulation::State& state);
/// Those of them that say what comes and goes, and what acts on nothing.
std::vector<std::string> source_warnings(const Simulation::State& state);
/// Those of heat.
std::vector<std::string> heat_warnings(const Simulation::State& state);
/// Those of how matter flows, how thick it is, and how its volume is kept.
std::vector<std::string> matter_warnings(const Simulation::State& state);
/// The longest step that no limit shortens, as fast as things are now [s].
double unlimited_step(const Simulation::State& state);

}  // namespace mallow
