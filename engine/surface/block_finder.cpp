#include "surface/block_finder.h"

#include <algorithm>
#include <sstream>

#include "core/parallel.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

/// Bytes of a block that the surface passes through: distances, sums, neighbours, mesh.
constexpr double k_block_bytes = 8192, k_gibibyte = 1 << 30;
/// A box that goes farther from where it starts is refused before its numbers are too large for an int.
constexpr double k_farthest = 1 << 28;

[[noreturn]] void refuse_memory(double blocks, const VoxelFrame& frame, float memory_limit) {
  std::ostringstream text;
  text << "voxels of " << frame.voxel_size
       << " m are too small for these particles: the surface would take at least "
       << blocks * k_block_bytes / k_gibibyte << " GiB, and surface.memory_limit allows " << memory_limit
       << " GiB";
  throw ConfigError("surface.voxel_size", text.str());
}

/// Of a block whose numbers have up to 21 bits: those near each other mostly have numbers near each other.
std::uint64_t key_of(const BlockMap::Coord& block) {
  constexpr int k_bits = 21, k_bias = 1 << (k_bits - 1);
  const auto bits = [](int c) { return static_cast<std::uint64_t>(c + k_bias); };
  return bits(block.x()) << (2 * k_bits) | bits(block.y()) << k_bits | bits(block.z());
}

/// The largest whole number that is not above.
int whole(double x) {
  const int cut = static_cast<int>(x);
  return cut - (x < cut ? 1 : 0);
}

/// Low and high coordinates of particles in voxels, as blocks see them.
struct VoxelBox {
  double low[3], high[3];

  void start(const double* x) {
    for (int a = 0; a < 3; ++a) low[a] = high[a] = x[a];
  }
  void add(const double* x) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], x[a]);
      high[a] = std::max(high[a], x[a]);
    }
  }
  /// Corners of the box of blocks with a voxel within reach.
  BlockMap::Coord first(double reach) const {
    const auto of = [&](int a) { return -whole(-(low[a] - reach - (k_block_side - 1)) / k_block_side); };
    return {of(0), of(1), of(2)};
  }
  BlockMap::Coord last(double reach) const {
    const auto of = [&](int a) { return whole((high[a] + reach) / k_block_side); };
    return {of(0), of(1), of(2)};
  }
};

}  // namespace

/// Particles come sorted, so that those of a block follow each other, in a few runs: a box for each. Returns
/// how many there are.
std::size_t BlockFinder::find_runs(const ParticleCells& particles, const VoxelFrame& frame, double reach,
                                   const Threads& threads) {
  const std::size_t n = particles.count();
  runs_.resize(n);
  counts_.resize((n + k_block - 1) / k_block);
  const double per_voxel = 1 / frame.voxel_size;
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    Run* to = runs_.data() + begin;
    VoxelBox box{};
    BlockMap::Coord block(0, 0, 0);
    const auto close = [&] { *to++ = {key_of(block), box.first(reach), box.last(reach)}; };
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 position = particles.position(i);
      double x[3];
      for (int a = 0; a < 3; ++a) x[a] = (static_cast<double>(position[a]) - frame.origin[a]) * per_voxel;
      const BlockMap::Coord here(whole(x[0] / k_block_side), whole(x[1] / k_block_side),
                                 whole(x[2] / k_block_side));
      if (i > begin && here == block) {
        box.add(x);
        continue;
      }
      if (i > begin) close();
      block = here;
      box.start(x);
    }
    close();
    counts_[begin / k_block] = static_cast<std::size_t>(to - (runs_.data() + begin));
  });
  std::size_t count = 0;
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    const auto from = runs_.begin() + static_cast<std::ptrdiff_t>(c * k_block);
    std::copy(from, from + static_cast<std::ptrdiff_t>(counts_[c]),
              runs_.begin() + static_cast<std::ptrdiff_t>(count));
    count += counts_[c];
  }
  return count;
}

void BlockFinder::find(const ParticleCells& particles, const VoxelFrame& frame, double reach,
                       float memory_limit, const Threads& threads, BlockMap& blocks) {
  const double most = static_cast<double>(memory_limit) * k_gibibyte / k_block_bytes;
  // More than the memory of one particle's blocks is not to be counted.
  if (const double side = 2 * reach / k_block_side; side > k_farthest)
    refuse_memory(side * side * side, frame, memory_limit);
  const std::size_t count = find_runs(particles, frame, reach, threads);
  const auto end = runs_.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(runs_.begin(), end, [](const Run& a, const Run& b) { return a.block < b.block; });
  blocks.clear();
  for (auto run = runs_.begin(); run != end;) {
    Run all = *run;
    for (++run; run != end && run->block == all.block; ++run) {
      all.first = all.first.cwiseMin(run->first);
      all.last = all.last.cwiseMax(run->last);
    }
    const double in_box = ((all.last - all.first).cast<double>().array() + 1).prod();
    if (in_box > most) refuse_memory(in_box, frame, memory_limit);
    blocks.insert(all.first, all.last);
    if (static_cast<double>(blocks.size()) > most)
      refuse_memory(static_cast<double>(blocks.size()), frame, memory_limit);
  }
  blocks.number();
}

}  // namespace mallow
