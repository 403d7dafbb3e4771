#pragma once

#include <cstddef>

namespace mallow::test {

/// Whether this program counts what it allocates: with glibc, and without sanitizers, which bring an
/// allocator of their own.
extern const bool k_counts_allocations;

/// Allocations by any thread between start_counting() and stop_counting(): malloc and its kin, and with them
/// every operator new, what libraries allocate and the OpenMP runtime.
void start_counting();
struct Allocations {
  std::size_t count = 0;
  std::size_t bytes = 0;
  std::size_t largest = 0;
};
Allocations stop_counting();

}  // namespace mallow::test
