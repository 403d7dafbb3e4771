#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mallow::bench {

/// The most memory that this process held since the watch began, above what it held then.
class PeakMemory {
 public:
  PeakMemory();
  /// [bytes]; nothing where the system does not keep count.
  std::optional<std::size_t> bytes() const;

 private:
  std::size_t before_ = 0;
  bool counted_ = false;
};

/// Memory that a scaling run of the largest of `sizes` needs [bytes a particle], from a small run of each
/// material.
double needed_bytes_per_particle(const std::vector<std::string>& materials, int threads);
/// Throws ConfigError that says what fits where the largest of `sizes` does not. available: [bytes], 0 where
/// unknown.
void check_memory(const std::vector<std::size_t>& sizes, double bytes_per_particle, std::size_t available);

}  // namespace mallow::bench
