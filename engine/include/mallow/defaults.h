#pragma once

#include <optional>

#include "mallow/export.h"
#include "mallow/vec3.h"

/// What holds where a config leaves a setting out. The settings follow from the spacing of the particles and
/// from gravity, so that a scene may be in any unit; at the paper's spacing of 1 and gravity of 0.3 they are
/// the numbers that suit its scenes. Simulation::info() tells what is in force.
namespace mallow {

/// What the settings follow from, as it is when a simulation is prepared for the first time.
struct SceneScale {
  float spacing = 1.0f;       ///< h, the smallest of all bodies [m], > 0
  Vec3 gravity{0, 0, -0.3f};  ///< [m/s²], finite
  float speed = 0.0f;         ///< of the fastest particle, pin or collider [m/s], finite, >= 0
};

/// Where Δt0 comes from.
enum class TimeStepSource {
  given,    ///< SolverConfig::time_step
  gravity,  ///< spacing and gravity
  speed,    ///< spacing and the fastest body, as there is no gravity
  modulus,  ///< the stiffest Material::youngs_modulus, which asks for shorter steps than spacing and gravity
};

/// Δt0 [s]: 0.082 √(h/|g|), that is 0.15 at the paper's numbers, in which a fall of ten spacings ends at 0.37
/// spacings a step. Without gravity 0.3 h/speed, so that the fastest moves about as far a step as in such a
/// fall. Nothing where neither says how long a second is.
MALLOW_EXPORT std::optional<float> default_time_step(const SceneScale& scale);

/// σ [m]: 2.1 h, which gives 38 neighbours. `spacing` is that of the coarsest body, as too few neighbours
/// hold nothing together.
MALLOW_EXPORT float default_support_radius(float spacing);

/// m2 [m²]: the mean of x² over the points of a cubic lattice within `radius` of one of them, itself
/// included. It makes a stiffness of a region's pull: E = (1 − alpha) ρ m2/(Δt0 Δt_SM), ρ the mass by
/// spacing³. About 0.2 radius², in jumps. radius, spacing > 0. [model 2, section 3]
MALLOW_EXPORT double region_moment(double radius, double spacing);

/// γ_u [m/s²]: 40 |g|, above what weight and rest do to a body at any alpha below 0.95. Without gravity
/// 0.27 h/Δt0², the same number where Δt0 follows from gravity.
MALLOW_EXPORT float default_update_threshold(const SceneScale& scale, float time_step);

/// m_u as a time [s]: 60 Δt0.
MALLOW_EXPORT double default_update_period(float time_step);

/// k [m²/s²]: x σ²/(max(alpha, 0.2) Δt²), Δt the longest step, and Δt0 where steps are shorter; x is 1 or,
/// beside an elasticity of `pull` = (1 − alpha) Δt²/(Δt0 Δt_SM), what 2 x + pull = 2.6 leaves. So it is as
/// stiff as a step carries: runs were stable up to x 1.4, and near 2 x + pull 3 some that bounce without loss
/// gained energy. Where a step of Δt0 does not carry the elasticity, Δt is the one in which `pull` is 2.5.
MALLOW_EXPORT float default_pressure_coefficient(float support_radius, float alpha, float pull,
                                                 float time_step);

/// ν [m²/s], viscosity by density, m/h³: 0.91 h √(|g| h), without gravity 0.075 h²/Δt0. Thick enough that a
/// step carries the pressure above: stiff pressure without viscosity gains energy.
MALLOW_EXPORT float default_kinematic_viscosity(const SceneScale& scale, float time_step);

/// Of SolverConfig: 2 where some body flows by Material::plastic_yield, else 0. What has flowed under a blow
/// does not spring back, and where nothing keeps its volume it stays pressed together.
MALLOW_EXPORT int default_volume_iterations(bool flows);

/// Neighbours of a particle within a body that fills all of the radius, itself not counted: 4/3 π (r/h)³.
MALLOW_EXPORT double full_neighbors(float radius, float spacing);

}  // namespace mallow
