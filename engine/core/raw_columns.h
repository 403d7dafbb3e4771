#pragma once

#include <cstddef>
#include <cstdint>

/// What lanes see of columns: plain pointers, nothing inline (core/isa.h says why).
namespace mallow {

/// Lanes that are handled at once, at every instruction level: columns are padded to whole blocks of it.
inline constexpr std::size_t k_lanes = 16;
/// Particles that share one neighbour list in the sums of SPH, a lane each.
inline constexpr std::size_t k_cluster = 8;

struct ConstVectors {
  const float* x;
  const float* y;
  const float* z;
};
struct Vectors {
  float* x;
  float* y;
  float* z;
};

}  // namespace mallow
