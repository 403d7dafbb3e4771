#pragma once

#include <cstdint>

/// What parts of a simulation are called. A name is never given to anything else: each is a slot and its
/// generation, slot + 2^32 generation. Slots are counted from 0 in the order in which things of a kind are
/// added, and that of one that was removed is used again, in the next generation: as long as nothing is
/// removed ids are 0, 1, 2, ... They say nothing of the simulation that gave them: another one takes an id
/// for its own of that slot and generation, and refuses it only where it has none. Who has several
/// simulations keeps each one's ids apart.
namespace mallow {

/// Of Simulation::ids().
using ParticleId = std::uint64_t;
/// Of Simulation::add_body().
enum class BodyId : std::uint64_t {};
/// Of Simulation::add_collider().
enum class ColliderId : std::uint64_t {};
/// Of Simulation::pin().
enum class PinId : std::uint64_t {};
/// Of Simulation::add_emitter().
enum class EmitterId : std::uint64_t {};
/// Of Simulation::add_sink().
enum class SinkId : std::uint64_t {};
/// Of Simulation::add_material(), and of the material that Simulation::add_body() makes for a body.
enum class MaterialId : std::uint64_t {};

/// The slot of a particle, body, collider, pin or material.
template <class Id>
constexpr std::uint32_t slot_of(Id id) {
  return static_cast<std::uint32_t>(id);
}
/// How many had its slot before.
template <class Id>
constexpr std::uint32_t generation_of(Id id) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(id) >> 32);
}

}  // namespace mallow
