#pragma once

namespace mallow {

/// Squared lengths [m²] whose roots are as good as any; of what is shorter or longer a float does not hold
/// the square, and the length is found another way.
inline constexpr float k_least_square = 1e-30f, k_greatest_square = 1e30f;

}  // namespace mallow
