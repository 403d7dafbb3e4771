#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/checks.h"
#include "shape_matching/reshape.h"
#include "simulation/state.h"

/// What of coming and going more than applications do.
namespace mallow {

/// A material as Simulation::add_material() takes it. Throws ConfigError.
MaterialState checked_material(const Simulation::State& state, const Material& material, std::string name);
/// It gets an id.
MaterialState& keep_material(Simulation::State& state, MaterialState material);
/// A body is made of it no more: it goes with the last one, unless it stays.
void leave_material(Simulation::State& state, MaterialState& material);
/// As Simulation::extend_body(), unchecked. Returns the ids of the new particles, in their order.
std::vector<ParticleId> extend(Simulation::State& state, BodyState& body, const Body& points);
/// The reference shape of a body has changed: its rows are sorted for it, and its regions built of what their
/// particles carried along.
void rebuild_shape(Simulation::State& state, BodyState& body, CarriedRegions& carried);
/// Where a body is becomes its reference shape, and its regions are built of what their particles carried
/// along there, see reframe_regions(). The parts before are sorted likewise.
void take_frame(Simulation::State& state, BodyState& body, CarriedRegions& carried);
/// Parts of a body become bodies: Simulation::split().
std::vector<BodyId> split_body(Simulation::State& state, BodyState& body);
/// Slots tell where bodies are in the list, after some came or went before others.
void number_bodies(Simulation::State& state);
/// Bodies that have no rows any more are taken out of the list of bodies.
void forget_bodies(Simulation::State& state, std::span<BodyState* const> gone);
/// As Simulation::remove_particles(); ids: different, and there.
void erase_particles(Simulation::State& state, std::span<const ParticleId> ids);
/// Where there can be no pin more.
void check_room_for_pin(const Simulation::State& state, Checks& checks);
/// As Simulation::unpin().
void release_pin(Simulation::State& state, PinId pin);
/// Particles answer to a pin.
void hold_particles(Simulation::State& state, PinId pin, std::span<const ParticleId> ids);

}  // namespace mallow
