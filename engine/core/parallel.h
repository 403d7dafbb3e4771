#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mallow {

/// Particles per unit of work. Fixed, so that what is summed per block does not depend on the number of
/// threads; a whole number of lane blocks.
inline constexpr std::size_t k_block = 256;

/// Threads that a config value of `requested` means: itself, or what the machine has for 0.
int thread_count(int requested);

/// Calls body(begin, end) for every block of `block` indices of [0, n), blocks spread over `threads` threads.
/// The blocks are the same for any number of threads. body must not throw.
template <class Body>
void parallel_for(int threads, std::size_t n, const Body& body, std::size_t block = k_block) {
  const auto blocks = static_cast<std::ptrdiff_t>((n + block - 1) / block);
  const auto run = [&](std::ptrdiff_t b) {
    const std::size_t begin = static_cast<std::size_t>(b) * block;
    body(begin, std::min(n, begin + block));
  };
  if (threads == 1 || blocks <= 1) {
    for (std::ptrdiff_t b = 0; b < blocks; ++b) run(b);
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
  for (std::ptrdiff_t b = 0; b < blocks; ++b) run(b);
}

/// combine(... combine(combine(identity, map(block 0)), map(block 1)) ...): one order for any number of
/// threads. `partial` is scratch that keeps its memory between calls.
template <class T, class Map, class Combine>
T parallel_reduce(int threads, std::size_t n, std::vector<T>& partial, T identity, const Map& map,
                  const Combine& combine) {
  partial.resize((n + k_block - 1) / k_block, identity);
  parallel_for(threads, n,
               [&](std::size_t begin, std::size_t end) { partial[begin / k_block] = map(begin, end); });
  for (const T& value : partial) identity = combine(identity, value);
  return identity;
}

}  // namespace mallow
