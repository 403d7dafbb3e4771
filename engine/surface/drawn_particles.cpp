#include "surface/drawn_particles.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Not 0 where a bit of two vectors differs.
std::uint32_t difference(const Vec3& a, const Vec3& b) {
  std::uint32_t bits = 0;
  for (Eigen::Index k = 0; k < 3; ++k)
    bits |= std::bit_cast<std::uint32_t>(a[k]) ^ std::bit_cast<std::uint32_t>(b[k]);
  return bits;
}

/// Copies vectors, and tells whether all bits were there already.
bool note_vectors(const PickedVectors& from, const Threads& threads, std::vector<Vec3>& to) {
  const bool comparable = from.size() == to.size();
  std::atomic<bool> same = comparable;
  to.resize(from.size());
  parallel_for(threads, to.size(), [&](std::size_t begin, std::size_t end) {
    std::uint32_t bits = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 now = from[i];
      if (comparable) bits |= difference(now, to[i]);
      to[i] = now;
    }
    if (bits != 0) same.store(false, std::memory_order_relaxed);
  });
  return same;
}

bool note_bodies(std::span<const std::uint32_t> from, std::vector<std::uint32_t>& to) {
  if (std::ranges::equal(from, to)) return true;
  to.assign(from.begin(), from.end());
  return false;
}

bool is_same(const VoxelFrame& a, const VoxelFrame& b) {
  return a.voxel_size == b.voxel_size && a.origin == b.origin;
}

}  // namespace

bool DrawnParticles::note(const SurfaceSource& source, const Threads& threads) {
  bool same = source.spacing == spacing_ && is_same(source.frame, frame_);
  spacing_ = source.spacing;
  frame_ = source.frame;
  same = note_vectors(source.positions, threads, positions_) && same;
  same = note_vectors(source.velocities, threads, velocities_) && same;
  return note_bodies(source.bodies, bodies_) && same;
}

}  // namespace mallow
