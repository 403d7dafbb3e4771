#include "simulation/thread_shares.h"

#include <algorithm>

#include "core/range_blocks.h"
#include "core/threads.h"

namespace mallow {

std::vector<int> thread_shares(const Simulation& simulation) {
  std::vector<int> shares(simulation.particle_count(), -1);
  std::vector<Simulation::Rows> moving;
  RangeBlocks blocks;
  for (const BodyId body : simulation.bodies()) {
    if (!simulation.is_awake(body)) continue;
    moving.push_back(simulation.rows(body));
    blocks.add(moving.back().end - moving.back().begin);
  }
  const SolverConfig& config = simulation.config();
  const std::size_t count = blocks.blocks.size();
  // No more threads join than there are blocks.
  const std::size_t ranges = SharedBlocks::ranges(Threads(config.threads, config.executor).at_most(count));
  for (std::size_t b = 0; b < count; ++b) {
    const RangeBlocks::Block& block = blocks.blocks[b];
    const auto first = shares.begin() + static_cast<std::ptrdiff_t>(moving[block.range].begin);
    std::fill(first + block.begin, first + block.end,
              static_cast<int>(SharedBlocks::range_of(b, ranges, count)));
  }
  return shares;
}

}  // namespace mallow
