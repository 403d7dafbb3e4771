#pragma once

#include <optional>

#include "mallow/export.h"
#include "mallow/schedule.h"

namespace mallow {

/// The blend parameter alpha over time, in [0, 1].
using AlphaSchedule = Schedule;

/// What bodies are made of. Symbols are those of Takamatsu & Kanai [TK].
struct Material {
  /// Elastic solid (0) to fluid (1), in [0, 1]. [TK eq. 10]
  AlphaSchedule alpha = 0.0f;
  /// Mean external acceleration above which the reference shape is updated, at alpha 0: γ_u [m/s²], >= 0.
  /// The threshold in force is γ_u (1 − alpha), and what is compared with it the largest mean over one
  /// time_step since the check before; with SolverConfig::update_interval, in steps as long as time_step,
  /// that of the one step before the check, as in the paper. Left out: 40 times gravity, see
  /// default_update_threshold(), and with plastic_yield never, unless alpha changes and rises above 0.9. [TK
  /// eq. 14]
  std::optional<float> update_threshold = {};
  /// Strain beyond which a region of shape matching flows where it is, >= 0: |Ê − I|, Ê its elastic stretch
  /// without change of volume. Pulled along one axis it flows from a strain of √1.5 of this, and a stress of
  /// √1.5 E times this; what has flowed stays when the load goes. A layer of one particle has no strain
  /// across and does not flow. Where matter has flowed by 0.5, or was pressed together, the body takes
  /// the shape that it has for its reference shape: at the next check (SolverConfig::update_period) at which
  /// no blow strains half of it by more than 0.25 and twice its yield, or at once where half of it has flowed
  /// by 1.2. What touches is one then, and what is farther apart than region_radius is not. Left out: nothing
  /// flows, only update_threshold changes shapes. [model 2, section 5]
  std::optional<float> plastic_yield = {};
  /// The same by temperature, in place of plastic_yield: keys of (temperature [K], strain >= 0).
  std::optional<Schedule> plastic_yield_by_temperature = {};
  /// Rate at which strain beyond plastic_yield flows [1/s], > 0: a plastic viscosity of E/(2 plastic_creep).
  /// Left out: at once, so that no strain stays beyond it. Asks for plastic_yield.
  std::optional<float> plastic_creep = {};
  /// How far matter must have flowed, |G − I| summed since the reference shape was taken, on both sides of
  /// where it touches itself, for the two sides to become one at the next check, >= 0. Less merges what
  /// hardly touched. Two bodies of this material that merge become one likewise: see Body::merges.
  float merge_flow = 0.1f;
  /// Where matter flows and a region has been stretched by more than this since the reference shape was
  /// taken, it tears, >= 0: what is farther apart than region_radius then is not held together any more. It
  /// is looked for at checks, and every two time_steps among regions that have flowed by more than 0.1, so
  /// that a gap counts while what made it is there; only half a body in a blow waits for the blow's end. So a
  /// blade cuts where its thickness and a spacing are more than (1 + tear_strain) region_radius; less makes
  /// matter short, more of it goes into crumbs. What is pressed together again becomes one at a check, as
  /// merge_flow says: Body::splits keeps it apart.
  float tear_strain = 0.5f;
  /// k [m²/s²], >= 0: pressure is k (ρ − ρ0). Left out: as stiff as a step can carry, see
  /// default_pressure_coefficient(); it then follows alpha, and between bodies, where pressure acts whatever
  /// alpha is, it is that of alpha 1. [TK eq. 1]
  std::optional<float> pressure_coefficient = {};
  /// μ [Pa s], >= 0. Left out: as thick as looks the same at any size, see default_kinematic_viscosity().
  /// [TK eq. 2]
  std::optional<float> viscosity = {};
  /// Δt_SM [s], > 0, at least (1 − alpha) time_step_factor² time_step/2.5, with plastic_yield /2, as a
  /// stiffer body would gain energy; left out: from youngs_modulus, or else the solver's time_step. [TK eq.
  /// 13; model 2, section 4 B]
  std::optional<float> elastic_time_step = {};
  /// Young's modulus Y at alpha 0 [Pa], > 0, in place of elastic_time_step: the stiffness in force is
  /// (1 − alpha) Y, Poisson's ratio 0 but for what pressure adds, and neither spacing nor steps change it.
  /// Steps carry (1 − alpha) Y time_step_factor² time_step² up to 2.5 ρ m2, with plastic_yield 2 ρ m2, ρ the
  /// mass by h³ and m2 the mean of x² over a region; a time_step that is left out is shortened to 1 of it,
  /// see TimeStepSource::modulus. [model 2, section 3]
  std::optional<float> youngs_modulus = {};
  /// m [kg], > 0. Left out: follows from rest_density; 1 if that is left out too.
  std::optional<float> particle_mass = {};
  /// ρ0 [kg/m³], > 0. Left out: follows from particle_mass, so that a full lattice is at rest pressure.
  std::optional<float> rest_density = {};
  /// Share of a negative pressure that acts, in [0, 1]. Where pressure_coefficient is left out it is that of
  /// a k of 0.08 σ²/Δt² at most, as soft as the paper's: the pull of a stiffer one tears bodies apart.
  float cohesion = 0.0f;
  /// Coulomb's μ_f where it touches other bodies, >= 0; that of a pair is √(μ μ'). Colliders have their own.
  float friction = 0.5f;
  /// Stress up to which it sticks to bodies that touch it [Pa], >= 0, √(a a') of a pair: friction holds with
  /// as much more. Where alpha is 1 walls hold it by its viscosity up to this, and no more by their friction.
  float adhesion = 0.0f;
  /// Damping time of elasticity, τ [s], >= 0: the pull is that at x + τ v, so that a mode of frequency ω
  /// [rad/s] has a damping ratio of ω τ/2. With the longest step Δt and a = (1 − alpha) Δt²/(time_step
  /// elastic_time_step), a (1 + 2 τ/Δt) may be 2.5 at most. It slows spin a little, by τ ω² a second.
  /// [model 2, section 4 B]
  float damping_time = 0.0f;
  /// Rate at which particles take on their body's motion as a rigid whole, ζ [1/s], >= 0: damps slow modes,
  /// keeps momentum and spin. Left out: what hardly moves comes to rest, at 0.3/time_step, and what moves
  /// faster than 0.02 spacings in a time_step is left alone more and more; a body that has come apart, as
  /// BodyEvent::torn tells, is not damped. [model 2, section 4 B]
  std::optional<float> deformation_damping = {};
  /// Radius of the shape matching regions [m], > 0; left out: the solver's support_radius. [TK eq. 7]
  std::optional<float> region_radius = {};
  /// Of this many particles, in the cell order of the reference shape, one owns a region, >= 1; particles
  /// that would be in no region own one too. Shape matching costs about 1/region_stride; goals follow fewer
  /// rotations, so a body bends and twists more coarsely and holds together by fewer overlaps. Momentum is
  /// kept and a rigid motion meets no force whatever it is; best a small share of the average number of
  /// neighbours. [model 2 with |N_i| regions; the idea of Steinemann et al. 2008]
  int region_stride = 1;
  /// Of its particles at the start [K], or in any unit that starts anywhere; left out: it carries no heat.
  /// Heat is conducted over the neighbours of SPH, which then are found in every step, and a body that
  /// carries heat does not sleep. [Cleary & Monaghan 1999; model 2, section 7]
  std::optional<float> temperature = {};
  /// κ [W/(m K)], >= 0. Steps are cut into as many parts as it takes to be stable, 200 at most.
  float conductivity = 0.0f;
  /// c [J/(kg K)], > 0.
  float specific_heat = 1000.0f;
  /// Heat that melting takes [J/kg], >= 0, evenly from solidus to liquidus.
  float latent_heat = 0.0f;
  /// It is solid below and liquid above [K], liquidus > solidus; needed where latent_heat is above 0.
  std::optional<float> solidus = {};
  /// @copydoc solidus
  std::optional<float> liquidus = {};
  /// To the air, of SolverConfig::air_temperature, where a surface touches no heated collider [W/(m² K)], >=
  /// 0.
  float heat_transfer = 0.0f;
  /// Alpha by temperature, in place of alpha over time: keys of (temperature [K], alpha in [0, 1]). Particles
  /// of a body then differ in it, as with Body::alpha; where it is high they take on where they are as what
  /// they rest in, so that what has melted sets in its new shape.
  std::optional<Schedule> alpha_by_temperature = {};
  /// μ by temperature [Pa s], >= 0, likewise, in place of viscosity.
  std::optional<Schedule> viscosity_by_temperature = {};
};

}  // namespace mallow
