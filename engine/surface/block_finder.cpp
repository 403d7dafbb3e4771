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

/// Runs that are kept open, a power of two.
constexpr std::size_t k_open = 512;

/// Of a block whose numbers have up to 21 bits.
std::uint64_t key_of(const BlockMap::Coord& block) {
  constexpr int k_bits = 21, k_bias = 1 << (k_bits - 1);
  const auto bits = [](int c) { return static_cast<std::uint64_t>(c + k_bias); };
  return bits(block.x()) << (2 * k_bits) | bits(block.y()) << k_bits | bits(block.z());
}

/// Blocks near each other have different ones: eight along each axis.
std::size_t slot_of(std::uint64_t block) {
  return static_cast<std::size_t>((block >> 36 & 7u << 6) | (block >> 18 & 7u << 3) | (block & 7u));
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

/// Particles come sorted, so that those of a block follow each other, in a few runs: a box for each.
void BlockFinder::find_runs(const ParticleCells& particles, const VoxelFrame& frame, double reach,
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
}

void BlockFinder::find(const ParticleCells& particles, const VoxelFrame& frame, double reach,
                       float memory_limit, const Threads& threads, BlockMap& blocks) {
  const double most = static_cast<double>(memory_limit) * k_gibibyte / k_block_bytes;
  // More than the memory of one particle's blocks is not to be counted.
  if (const double side = 2 * reach / k_block_side; side > k_farthest)
    refuse_memory(side * side * side, frame, memory_limit);
  find_runs(particles, frame, reach, threads);
  blocks.clear();
  const auto insert = [&](const Run& run) {
    const double in_box = ((run.last - run.first).cast<double>().array() + 1).prod();
    if (in_box > most) refuse_memory(in_box, frame, memory_limit);
    blocks.insert(run.first, run.last);
    if (static_cast<double>(blocks.size()) > most)
      refuse_memory(static_cast<double>(blocks.size()), frame, memory_limit);
  };
  // Runs of a block come at several times, not far from each other: their boxes are put together first.
  open_.assign(k_open, Run{});
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    for (std::size_t k = 0; k < counts_[c]; ++k) {
      const Run& run = runs_[c * k_block + k];
      Run& open = open_[slot_of(run.block)];
      if (open.block == run.block) {
        open.first = open.first.cwiseMin(run.first);
        open.last = open.last.cwiseMax(run.last);
        continue;
      }
      if (open.block != UINT64_MAX) insert(open);
      open = run;
    }
  }
  for (const Run& run : open_)
    if (run.block != UINT64_MAX) insert(run);
  blocks.number();
}

}  // namespace mallow
