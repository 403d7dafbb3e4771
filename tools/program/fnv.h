#pragma once

#include <cstdint>
#include <string_view>

namespace mallow::program {

/// FNV-1a of no bytes, 64 bits.
inline constexpr std::uint64_t k_fnv_of_nothing = 14695981039346656037u;

/// Of what has the hash `hash` and these bytes behind it.
inline std::uint64_t fnv(std::string_view bytes, std::uint64_t hash = k_fnv_of_nothing) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

}  // namespace mallow::program
