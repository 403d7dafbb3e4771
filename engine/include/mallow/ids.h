#pragma once

#include <cstdint>

/// What parts of a simulation are called. A name is never given to anything else.
namespace mallow {

/// A particle: a slot and its generation, slot + 2^32 generation. Slots are counted from 0 in the order in
/// which particles are added, and that of a particle that was removed is used again, in the next generation:
/// as long as nothing is removed ids are 0, 1, 2, ...
using ParticleId = std::uint64_t;
/// The slot of a particle.
constexpr std::uint32_t slot_of(ParticleId id) {
  return static_cast<std::uint32_t>(id);
}
/// How many particles had its slot before.
constexpr std::uint32_t generation_of(ParticleId id) {
  return static_cast<std::uint32_t>(id >> 32);
}

/// Materials, bodies, colliders and pins are counted from 0 in the order in which they were added.
enum class MaterialId : std::uint32_t {};
enum class BodyId : std::uint32_t {};      ///< as MaterialId
enum class ColliderId : std::uint32_t {};  ///< as MaterialId
enum class PinId : std::uint32_t {};       ///< as MaterialId

}  // namespace mallow
