#pragma once

#include <string>

#include "config/validation.h"
#include "mallow/export.h"

/// Young's modulus, the spring of shape matching that it asks for, and the steps that carry it.
/// [model 2, sections 3 and 4 B]
///
/// symbol | here                     | unit
/// Y      | youngs_modulus           | Pa
/// Δt_SM  | elastic_time_step        | s
/// ρ m2   | stiffness_scale()        | kg/m
namespace mallow {

struct BodyState;

/// ρ m2 of a body of this material: Y = ρ m2/(Δt0 Δt_SM). ρ is mass by h³, as that is what a body weighs, and
/// not rest_density, which is what SPH takes a full lattice for. A region_stride changes nothing: there are
/// fewer regions, each with as many points as before, and the pull is their mean.
double stiffness_scale(const SolverConfig& config, const Material& material, float spacing);

/// Δt_SM in force, Δt0 settled.
float elastic_time_step(const SolverConfig& config, const Material& material, float spacing);

/// The material with that in place of a modulus.
Material with_springs(const SolverConfig& config, const Material& material, float spacing);

/// The least alpha that a material may come to, over time or by temperature.
float lowest_alpha(const Material& material);

/// The largest Y that the longest step carries, at the lowest alpha and with the damping that there is [Pa];
/// infinite for fluids.
double most_modulus(const SolverConfig& config, const Material& material, float spacing);

/// Δt0 that Y asks for where it is left out; infinite where there is no Y. At it the pull of a step is 1, as
/// it is by default without Y: that leaves room for pressure; less where the longest step would carry no
/// more. painted: the largest (1 − α) times stiffness of particles that have their own, 0 where none has;
/// what the material has counts where it is more.
double modulus_time_step(const SolverConfig& config, const Material& material, float spacing, double painted);

/// Whether steps are short enough for Y, and for its damping; nothing where Δt0 is not known yet. body: that
/// the message names, with its material.
void check_modulus(const SolverConfig& config, const Material& material, const BodyState& body,
                   Checks& checks);

}  // namespace mallow
