#pragma once

#include "config/field.h"
#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/emitter.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"

/// The settings of every config of the engine; those of runs are in run_field_tables.h. The order is that of
/// printed scenes and of saved states: a change to what states hold of SolverConfig, Material, Collider or a
/// shape counts up their version (saved_state.cpp).
namespace mallow {

/// Particles of one body and of all together, at most: what 32-bit ids and the memory of one machine leave
/// room for.
inline constexpr int k_most_particles = 100'000'000;

template <>
struct FieldTable<SolverConfig> {
  using Config = SolverConfig;
  static constexpr std::tuple k_fields{
      Field{"time_step", &Config::time_step, k_positive, "s", "upper bound of a step, Δt0",
            "from spacing and gravity"},
      Field{"time_step_factor", &Config::time_step_factor, between(0.01, 4), "",
            "steps are this share of time_step, and the material stays what it is"},
      Field{"support_radius", &Config::support_radius, k_positive, "m", "radius of the SPH kernels, σ",
            "2.1 spacings"},
      Field{"gravity", &Config::gravity, k_finite, "m/s²", "acceleration of every particle"},
      Field{"update_period", &Config::update_period, k_positive, "s",
            "time between the checks that update reference shapes, m_u; give this or update_interval",
            "60 time_step"},
      Field{"update_interval", &Config::update_interval, at_least(1), "steps",
            "the same in steps; give this or update_period", "from update_period"},
      Field{"formulation", &Config::formulation, k_any, "",
            "SPH sums that keep momentum, or the paper's to the letter"},
      Field{"acoustic_limit", &Config::acoustic_limit, k_any, "",
            "also bound the step by the speed of sound and by viscous diffusion"},
      Field{"contact", &Config::contact, k_any, "",
            "how bodies keep out of each other: touch and rub, or by SPH pressure as in the paper"},
      Field{"contact_offset", &Config::contact_offset, k_not_negative, "m",
            "distance from a collider at which a particle touches it", "half the spacing"},
      Field{"wall_pressure", &Config::wall_pressure, k_any, "",
            "colliders count in the density of fluids and press back; false in the paper's scenes"},
      Field{"volume_iterations", &Config::volume_iterations, between(0, 50), "",
            "most iterations a step that keep matter from being pressed together; 0: pressure alone does",
            "2 with plastic_yield, else 0"},
      Field{"volume_tolerance", &Config::volume_tolerance, between(0, 1), "",
            "they end at this mean compression; 0: all are taken"},
      Field{"sleep_speed", &Config::sleep_speed, k_not_negative, "m/s",
            "what is slower for sleep_time, with all that it touches, sleeps until something wakes it; 0: "
            "none; "
            "none either by contact = pressure",
            "0.005 spacings in a time_step"},
      Field{"sleep_time", &Config::sleep_time, k_positive, "s", "see sleep_speed", "60 time_step"},
      Field{"air_temperature", &Config::air_temperature, k_finite, "K",
            "of the air, or keyframes of it over time; see material.heat_transfer"},
      Field{
          "rotation_iterations", &Config::rotation_iterations, between(0, 8), "",
          "most iterations for a region's rotation in a step; it stops when converged; 0 is exact and slow"},
      Field{"neighbor_slack", &Config::neighbor_slack, between(0, 1), "σ",
            "extra reach of neighbour lists, which are kept until a particle has moved half of it"},
      Field{"arithmetic", &Config::arithmetic, k_any, "",
            "rounding of SPH sums: the same on every machine, or faster and another on another machine"},
      Field{"instruction_level", &Config::instruction_level, k_any, "",
            "instructions that lanes use; the motion is the same", "the best this machine has",
            Written::in_scenes},
      Field{"memory_limit", &Config::memory_limit, k_positive, "GiB",
            "radii whose neighbour lists would need more are refused"},
      Field{"threads", &Config::threads, between(0, 1024), "",
            "threads of every phase; 0: one for each processor; the motion is the same", "",
            Written::nowhere},
  };
};

template <>
struct FieldTable<Material> {
  static constexpr std::tuple k_fields{
      Field{"alpha", &Material::alpha, between(0, 1), "",
            "elastic solid (0) to fluid (1), or keyframes of it over time"},
      Field{"update_threshold", &Material::update_threshold, k_not_negative, "m/s²",
            "mean external acceleration that updates the reference shape, at alpha 0, γ_u",
            "40 times gravity, never with plastic_yield unless it melts"},
      Field{"plastic_yield", &Material::plastic_yield, k_not_negative, "",
            "strain beyond which matter flows where it is",
            "no strain flows; update_threshold alone reshapes it"},
      Field{"plastic_yield_by_temperature", &Material::plastic_yield_by_temperature, k_not_negative, "",
            "plastic_yield by temperature, [[temperature, strain], ...]", "plastic_yield"},
      Field{"plastic_creep", &Material::plastic_creep, k_positive, "1/s",
            "rate at which strain beyond plastic_yield flows", "at once"},
      Field{"merge_flow", &Material::merge_flow, k_not_negative, "",
            "flow beyond which matter that is pressed together becomes one"},
      Field{"tear_strain", &Material::tear_strain, k_not_negative, "",
            "stretch of a region beyond which matter that flows tears"},
      Field{"pressure_coefficient", &Material::pressure_coefficient, k_not_negative, "m²/s²",
            "pressure by excess density, k", "as a step can carry"},
      Field{"viscosity", &Material::viscosity, k_not_negative, "Pa s", "viscosity coefficient, μ",
            "as looks the same at any size"},
      Field{"elastic_time_step", &Material::elastic_time_step, k_positive, "s", "Δt_SM, shorter is stiffer",
            "from youngs_modulus, or solver.time_step"},
      Field{"youngs_modulus", &Material::youngs_modulus, k_positive, "Pa",
            "stiffness at alpha 0, Y, at any spacing and step; give this or elastic_time_step",
            "from elastic_time_step"},
      Field{"particle_mass", &Material::particle_mass, k_positive, "kg", "mass of a particle, m",
            "from rest_density, or 1"},
      Field{"rest_density", &Material::rest_density, k_positive, "kg/m³", "density at rest, ρ0",
            "from particle_mass"},
      Field{"cohesion", &Material::cohesion, between(0, 1), "", "share of a negative pressure that acts"},
      Field{"friction", &Material::friction, k_not_negative, "",
            "Coulomb's μ_f where it touches other bodies"},
      Field{"adhesion", &Material::adhesion, k_not_negative, "Pa",
            "stress up to which it sticks to other bodies that touch it, the geometric mean of a pair; a "
            "fluid to walls too"},
      Field{"damping_time", &Material::damping_time, k_not_negative, "s",
            "of elasticity, τ: a mode of frequency ω has a damping ratio of ω τ/2"},
      Field{"deformation_damping", &Material::deformation_damping, k_not_negative, "1/s",
            "rate at which particles take on their body's rigid motion", "what hardly moves comes to rest"},
      Field{"region_radius", &Material::region_radius, k_positive, "m",
            "radius of the shape matching regions", "solver.support_radius"},
      Field{"region_stride", &Material::region_stride, at_least(1), "particles",
            "one region for this many particles; more is faster and coarser"},
      Field{"temperature", &Material::temperature, k_finite, "K", "of its particles at the start",
            "it carries no heat"},
      Field{"conductivity", &Material::conductivity, k_not_negative, "W/(m K)", "of heat, κ"},
      Field{"specific_heat", &Material::specific_heat, k_positive, "J/(kg K)", "heat that warms it"},
      Field{"latent_heat", &Material::latent_heat, k_not_negative, "J/kg",
            "heat that melting takes, evenly from solidus to liquidus"},
      Field{"solidus", &Material::solidus, k_finite, "K", "it is solid below", "where latent_heat is 0"},
      Field{"liquidus", &Material::liquidus, k_finite, "K", "it is liquid above", "where latent_heat is 0"},
      Field{"heat_transfer", &Material::heat_transfer, k_not_negative, "W/(m² K)",
            "from its surface to the air"},
      Field{"alpha_by_temperature", &Material::alpha_by_temperature, between(0, 1), "",
            "alpha by temperature, [[temperature, alpha], ...]", "alpha"},
      Field{"viscosity_by_temperature", &Material::viscosity_by_temperature, k_not_negative, "Pa s",
            "viscosity by temperature, [[temperature, viscosity], ...]", "viscosity"},
  };
};

/// Factor on the elastic modulus of a particle; what a step carries is another check.
inline constexpr Range k_stiffness_factor = k_not_negative;

/// Voxels along the longest side of a mesh that is an obstacle.
inline constexpr Range k_collider_voxels = between(8, 512);

/// How far points may be moved off their lattice: then they stay a tenth of the spacing apart, which is as
/// near as a simulation takes them.
inline constexpr Range k_jitter = between(0, 0.45);

template <>
struct FieldTable<Sampling> {
  static constexpr std::tuple k_fields{
      Field{"spacing", &Sampling::spacing, k_positive, "m",
            "distance of neighbouring particles, h; give this or count", "from count"},
      Field{"count", &Sampling::count, between(1, k_most_particles), "",
            "wanted number of particles, met within 1%; give this or spacing", "from spacing"},
      Field{"jitter", &Sampling::jitter, k_jitter, "h",
            "random displacement of every particle along each axis, at most"},
  };
};

template <>
struct FieldTable<Placement> {
  static constexpr std::tuple k_fields{
      Field{"rotate", &Placement::rotate, k_finite, "degrees", "turn about x, then y, then z"},
      Field{"size", &Placement::size, k_positive, "m", "longest side of the bounding box", "as the shape is"},
      Field{"center", &Placement::center, k_finite, "m", "middle of the bounding box", "where the shape is"},
  };
};

template <>
struct FieldTable<Lattice> {
  static constexpr std::tuple k_fields{
      Field{"count", &Lattice::count, between(1, k_most_particles), "",
            "cells along x, y and z, a particle each", k_required},
      Field{"spacing", &Lattice::spacing, k_positive, "m", "side of a cell, h", k_required},
      Field{"corner", &Lattice::corner, k_finite, "m", "lowest corner, half a cell from the first particle"},
      Field{"jitter", &Lattice::jitter, k_jitter, "h", "random displacement of every particle, per axis"},
  };
};

/// Without its shape, which has a table of its own, and its pose.
template <>
struct FieldTable<Collider> {
  static constexpr std::tuple k_fields{
      Field{"velocity", &Collider::velocity, k_finite, "m/s", "the obstacle moves with it"},
      Field{"angular_velocity", &Collider::angular_velocity, k_finite, "rad/s",
            "the obstacle turns with it about the origin of its shape"},
      Field{"surface_velocity", &Collider::surface_velocity, k_finite, "m/s",
            "its surface moves along with it while the shape stays, as a belt does"},
      Field{"restitution", &Collider::restitution, between(0, 1), "",
            "share of the normal velocity that bounces back, e"},
      Field{"friction", &Collider::friction, k_not_negative, "", "Coulomb's μ_f"},
      Field{"temperature", &Collider::temperature, k_finite, "K",
            "of its surface, or keyframes of it over time: it heats or cools what touches it",
            "no heat passes"},
      Field{"heat_transfer", &Collider::heat_transfer, k_positive, "W/(m² K)",
            "of what lies between it and what touches it", "nothing lies between"},
      Field{"measure_load", &Collider::measure_load, k_any, "", "sum up what particles do to it", "",
            Written::in_states},
  };
};

/// Without its points, its pose and its keyframes.
template <>
struct FieldTable<Emitter> {
  static constexpr std::tuple k_fields{
      Field{"radius", &Emitter::radius, k_positive, "m",
            "of a round nozzle; give this, or width and height, or points", "from width and height"},
      Field{"width", &Emitter::width, k_positive, "m", "of a nozzle with corners, along its x axis",
            "from radius"},
      Field{"height", &Emitter::height, k_positive, "m", "of a nozzle with corners, along its y axis",
            "from radius"},
      Field{"spacing", &Emitter::spacing, k_positive, "m", "distance of neighbouring particles, h",
            k_required},
      Field{"velocity", &Emitter::velocity, k_finite, "m/s", "the nozzle moves with it"},
      Field{"speed", &Emitter::speed, k_not_negative, "m/s",
            "of what leaves the nozzle, seen from it; 0: it does not flow"},
      Field{"start", &Emitter::start, k_not_negative, "s", "it flows from this time on", "at once"},
      Field{"stop", &Emitter::stop, k_not_negative, "s", "and until this", "it goes on"},
      Field{"jitter", &Emitter::jitter, k_jitter, "h",
            "random displacement of every particle across the flow, per axis"},
      Field{"most_particles", &Emitter::most_particles, between(1, k_most_particles), "",
            "the strand grows no longer than that"},
      Field{
          "merges", &Emitter::merges, k_any, "",
          "the strand acts on others of its material that merge as on itself; if it flows, they become one"},
  };
};

template <>
struct FieldTable<SurfaceConfig> {
  using Config = SurfaceConfig;
  static constexpr std::tuple k_fields{
      Field{"voxels_per_spacing", &Config::voxels_per_spacing, between(0.5, 16), "",
            "voxels along one spacing of the particles, if voxel_size and voxels are left out"},
      Field{"voxel_size", &Config::voxel_size, k_positive, "m", "side of a voxel", "from voxels_per_spacing"},
      Field{"voxels", &Config::voxels, between(8, 1024), "",
            "voxels along the longest side of the box around the particles, if voxel_size is left out",
            "from voxels_per_spacing"},
      Field{"kernel_radius", &Config::kernel_radius, between(1, 4), "h",
            "radius in which particles are blended"},
      Field{"particle_radius", &Config::particle_radius, between(0.1, 1), "h",
            "distance of the surface from the outermost particles"},
      Field{"kind", &Config::kind, k_any, "", "how the surface is drawn around the particles"},
      Field{"joined", &Config::joined, k_any, "", "one surface around all bodies"},
      Field{"adaptivity", &Config::adaptivity, between(0, 1), "voxels",
            "how far merging vertices on even parts may move the surface"},
      Field{"smoothing", &Config::smoothing, between(0, 100), "",
            "rounds that smooth the mesh and keep its volume"},
      Field{"memory_limit", &Config::memory_limit, k_positive, "GiB",
            "a surface that would need more is refused"},
  };
};

}  // namespace mallow
