#include "surface/surface_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "mallow/instruction_level.h"

namespace mallow {
namespace {

// Variance of particles about their mean that is taken for one part of a body, in squared kernel radii. A
// face of a full body has 0.19 at a fullness of 0.46, its inside 0.27; a cubic lattice of 1.3 spacings 0.32
// at 0.5. The middle of a gap of 2.2 spacings has 0.44 at 0.29, that of a pair 2.2 apart 0.30 at 0.13. With
// the default radius two faces, and a pair, part at a distance of about two spacings.
constexpr float k_spread = 0.0375f, k_extra_spread = 0.2625f;
/// The least of it, in squared spacings: a small kernel sees but few particles of a full body.
constexpr float k_least_spread = 0.15f;

/// Nodes two and four voxels apart are at most this share of the kernel radius apart. Cubic interpolation is
/// off by 0.6% of a particle's weight at a quarter. Nodes that are a wider voxel apart may be so by more
/// before the surface is off by as much of one.
constexpr double k_near_nodes = 0.22, k_far_nodes = 0.2;
/// Weights below this are no part of a body: a particle's is so far out at 0.85 of its radius.
constexpr float k_least_weight = 0.02f;
/// Probes are at most this far apart, in spacings: less than a sphere is wide at the default particle radius
/// and at most what three voxels of background bridge.
constexpr double k_probe_distance = 0.75;
constexpr std::size_t k_cubes_at_once = 4;

/// How much deeper than `z` spacings x̄ lies under a flat face, `z` above the outermost layer of a full
/// lattice with a kernel of `radius` spacings. Layers are taken as sheets: (1 − d²/R²)⁴ is the kernel's
/// integral over a sheet.
double depth_of_mean(double z, double radius) {
  double weight = 0, moment = 0;
  for (int layer = 0; z + layer < radius; ++layer) {
    const double w = std::pow(1 - (z + layer) * (z + layer) / (radius * radius), 4);
    weight += w;
    moment += w * layer;
  }
  return weight > 0 ? moment / weight : 0;
}

SurfaceShape make_shape(const SurfaceConfig& config, double spacing, double voxel_size) {
  const double radius = config.kernel_radius;
  const float per_radius = 1 / config.kernel_radius;
  return {.voxel_size = static_cast<float>(voxel_size / (radius * spacing)),
          .offset = config.particle_radius * per_radius,
          .extra_offset = static_cast<float>(depth_of_mean(config.particle_radius, radius) / radius),
          .spread = std::max(k_spread, k_least_spread * per_radius * per_radius),
          .extra_spread = k_extra_spread,
          // ∫ (1 − r²)³ dV = 64π/315 for one particle per cubic spacing.
          .full_weight = static_cast<float>(64 * std::numbers::pi / 315 * radius * radius * radius),
          .least_weight = k_least_weight,
          .threshold = 0,
          .background = SurfaceField::k_background};
}

/// k_least_weight where weights are interpolated. A cubic leaves some up to three nodes away from a body,
/// where there is none, and a mean that may be anywhere: crumbs. What is near enough to count has twice as
/// much: a lone particle where its distance is cut.
float least_interpolated_weight(const SurfaceShape& shape) {
  const float cut = shape.offset + shape.background * shape.voxel_size;
  const float t = std::max(0.0f, 1 - cut * cut);
  return std::max(k_least_weight, 0.5f * t * t * t);
}

/// The farthest from all particles that a point inside can be, in kernel radii: their mean square distance,
/// which is |x − x̄|² and the variance, is what bounds it.
double farthest_inside(const SurfaceShape& shape) {
  const float r = shape.offset + shape.extra_offset;
  return std::sqrt(r * r / k_excess_share + shape.spread + shape.extra_spread);
}

/// The largest of 4, 2, 1 voxels that is at most `distance`.
int step_within(double distance) {
  return distance >= 4 ? 4 : distance >= 2 ? 2 : 1;
}
/// Voxels from node to node where the kernel reaches over so many of them.
int node_step(double radius) {
  return std::max(step_within(k_far_nodes * radius), std::min(2, step_within(k_near_nodes * radius)));
}

void find_neighbors(const BlockMap& blocks, const Threads& threads,
                    std::vector<std::array<std::uint32_t, 27>>& neighbors) {
  neighbors.resize(blocks.size());
  parallel_for(
      threads, blocks.cubes(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) blocks.find_around(c, neighbors);
      },
      k_cubes_at_once);
}

}  // namespace

void SurfaceField::clear() {
  blocks_.clear();
  kind_.clear();
}

void SurfaceField::build(const PickedVectors& positions, float spacing, const SurfaceConfig& config,
                         const VoxelFrame& frame, const Threads& threads) {
  frame_ = frame;
  shape_ = make_shape(config, static_cast<double>(spacing), frame.voxel_size);
  surface_kind_ = config.kind;
  const double voxels = static_cast<double>(spacing) / frame.voxel_size;  // of a spacing
  double reach = 0;                                                       // of a particle [voxels]
  node_step_ = 1;
  switch (config.kind) {
    case SurfaceKind::blended:
      radius_ = config.kernel_radius * spacing;
      node_step_ = node_step(static_cast<double>(config.kernel_radius) * voxels);
      // The cells around an edge that leaves the body are less than two voxels away. Sums are interpolated
      // from nodes in all blocks that any particle reaches.
      reach = farthest_inside(shape_) * static_cast<double>(config.kernel_radius) * voxels + 2;
      if (node_step_ > 1) {
        reach = std::max(reach, static_cast<double>(config.kernel_radius) * voxels);
        shape_.least_weight = least_interpolated_weight(shape_);
      }
      break;
    case SurfaceKind::anisotropic:
      radius_ = config.kernel_radius * spacing;
      reach = static_cast<double>(config.kernel_radius) * voxels;
      break;
    case SurfaceKind::spheres:
      reach = static_cast<double>(config.particle_radius) * voxels + static_cast<double>(k_background);
      radius_ = static_cast<float>(reach * frame.voxel_size);
      shape_.voxel_size = static_cast<float>(frame.voxel_size / static_cast<double>(radius_));
      shape_.offset = config.particle_radius * spacing / radius_;
      break;
  }
  deep_ = -0.5f * shape_.offset / shape_.voxel_size;
  probe_step_ = std::max(step_within(k_probe_distance * voxels), node_step_);
  weights_ = cubic_weights(node_step_, node_step_ == 4 ? 1 : 0);

  clear();
  if (positions.size() == 0) return;
  particles_.sort(positions, spacing, radius_, threads);
  if (config.kind == SurfaceKind::anisotropic) {
    const AnisotropyModel model(config.kernel_radius, config.particle_radius);
    shape_.threshold = static_cast<float>(std::pow(model.threshold, 0.25));
    particles_.shape(model, threads);
  }
  finder_.find(particles_.cells(), frame_, reach, config.memory_limit, threads, blocks_);
  find_neighbors(blocks_, threads, neighbors_);
  particles_.find_near(blocks_, frame_, threads);
  probe(threads);
  classify(threads);
  if (node_step_ > 1) sum_at_nodes(threads);
  if (probe_step_ > 1) fill(threads);
}

/// Calls visit(block, near) for the blocks that are needed, with the particles near each.
template <class Needed, class Visit>
void SurfaceField::for_each_block(const Threads& threads, const Needed& needed, const Visit& visit) const {
  const auto groups = blocks_.groups();
  parallel_for(
      threads, groups.size(),
      [&](std::size_t begin, std::size_t end) {
        thread_local BlockNear near;
        for (std::size_t g = begin; g < end; ++g) {
          for (const std::uint32_t block : groups[g].blocks) {
            if (block == k_no_block || !needed(block)) continue;
            particles_.find(blocks_, frame_, block, near);
            visit(block, near);
          }
        }
      },
      k_groups_at_once);
}

/// Distances at points about a block. sums: room for k_sums of each.
void SurfaceField::find_distances(const PointLattice& points, BlockNear& near, float* sums,
                                  float* distances) const {
  const SumLanes& sum = best_sum_lanes();
  const SurfaceLanes& surface = best_surface_lanes();
  const float farthest = shape_.offset + shape_.background * shape_.voxel_size;
  switch (surface_kind_) {
    case SurfaceKind::blended:
      sum.sum(points, near.columns(), sums);
      surface.distances(shape_, sums, points.count(), distances);
      break;
    case SurfaceKind::anisotropic:
      sum.density(points, near.columns(), near.shapes.data(), near.reaches(), sums);
      surface.density_distances(shape_, sums, points.count(), distances);
      break;
    case SurfaceKind::spheres:
      sum.nearest(points, near.columns(), farthest * farthest, sums);
      surface.sphere_distances(shape_, sums, points.count(), distances);
      break;
  }
}

/// Whether the probes' lattice of every block is outside or inside. Probes at every voxel are the field.
void SurfaceField::probe(const Threads& threads) {
  const PointLattice points = lattice(probe_step_);
  const std::size_t n = points.count();
  outside_.resize(blocks_.size());
  inside_.resize(blocks_.size());
  signs_.resize(blocks_.size());
  if (probe_step_ == 1) distances_.resize_unset(n * blocks_.size());
  const bool keep = node_step_ == probe_step_ && node_step_ > 1;
  if (keep) node_sums_.resize_unset(k_sums * n * blocks_.size());
  for_each_block(
      threads, [](std::uint32_t) { return true; },
      [&](std::uint32_t b, BlockNear& near) {
        float sums[k_sums * k_block_voxels], scratch[k_block_voxels];
        float* const distances = probe_step_ == 1 ? distances_.data() + n * b : scratch;
        find_distances(points, near, keep ? node_sums_.data() + k_sums * n * b : sums, distances);
        if (probe_step_ == 1) best_cell_lanes().find_signs(distances, signs_[b]);
        note_sides(b, distances, near.count > 0);
        // The surface may be in it: it will be looked at again.
        if (probe_step_ > 1 && (inside_[b] & 1) == 0) particles_.keep(b, near);
      });
}

/// touched: whether any particle is near.
void SurfaceField::note_sides(std::uint32_t block, const float* distances, bool touched) {
  constexpr std::size_t k_words = k_block_voxels / 64;
  const std::size_t n = lattice(probe_step_).count(), words = (n + 63) / 64;
  std::uint64_t sides[2][k_words];
  best_surface_lanes().find_sides(distances, n, k_background, deep_, sides[0], sides[1]);
  // The first slice of a word along x, where it has several, y and z.
  struct Slices {
    std::uint64_t all, x, y, z;
  };
  const Slices slices = n == 8    ? Slices{0xFF, 0x0F, 0x33, 0x55}
                        : n == 64 ? Slices{~0ull, 0xFFFF, 0x000F000F000F000F, 0x1111111111111111}
                                  : Slices{~0ull, ~0ull, 0xFF, 0x0101010101010101};
  std::uint8_t found[2] = {};
  for (int side = 0; side < 2; ++side) {
    const std::uint64_t first = sides[side][0];
    std::uint64_t every = first;
    for (std::size_t w = 1; w < words; ++w) every &= sides[side][w];
    for (unsigned slot = 0; slot < 8; ++slot) {
      const std::uint64_t bits = slices.all & (slot & 4 ? slices.x : slices.all) &
                                 (slot & 2 ? slices.y : slices.all) & (slot & 1 ? slices.z : slices.all);
      const bool all = (~(slot & 4 ? first : every) & bits) == 0;
      found[side] = static_cast<std::uint8_t>(found[side] | (all ? 1u : 0u) << slot);
    }
  }
  // Far from it, the density overestimates distances: only where there is none is outside for certain.
  outside_[block] = surface_kind_ == SurfaceKind::anisotropic && touched ? std::uint8_t{0} : found[0];
  inside_[block] = found[1];
}

/// What the probes in a block and on the faces of those behind it say: the surface may be in it unless all
/// are on one side.
BlockKind SurfaceField::kind_by_probes(std::uint32_t block) const {
  unsigned outside = 1, inside = 1;
  for (unsigned slot = 0; slot < 8; ++slot) {
    const std::uint32_t at = neighbors_[block][neighbor_slot(slot >> 2 & 1, slot >> 1 & 1, slot & 1)];
    outside &= at == k_no_block ? 1u : static_cast<unsigned>(outside_[at]) >> slot;
    inside &= at == k_no_block ? 0u : static_cast<unsigned>(inside_[at]) >> slot;
  }
  return outside & 1 ? BlockKind::outside : inside & 1 ? BlockKind::inside : BlockKind::surface;
}

void SurfaceField::classify(const Threads& threads) {
  const std::size_t n = blocks_.size();
  kind_.resize(n);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (auto b = static_cast<std::uint32_t>(begin); b < end; ++b) kind_[b] = kind_by_probes(b);
  });
  // No block inside may touch one outside: then every sign that changes does so at a surface block.
  needs_nodes_.assign(n, 0);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (kind_[b] != BlockKind::inside) continue;
      for (const std::uint32_t other : neighbors_[b])
        if (other == k_no_block || kind_[other] == BlockKind::outside) needs_nodes_[b] = 1;
    }
  });
  std::size_t stored = 0;
  place_.resize(n);
  for (std::size_t b = 0; b < n; ++b) {
    if (needs_nodes_[b]) kind_[b] = BlockKind::surface;
    place_[b] = stored;
    if (kind_[b] == BlockKind::surface || probe_step_ == 1) stored += k_block_voxels;
  }
  if (probe_step_ > 1) distances_.resize_unset(stored);
}

/// Sums at the nodes of all blocks that interpolation reads.
void SurfaceField::sum_at_nodes(const Threads& threads) {
  const std::size_t n = lattice(node_step_).count();
  node_place_.resize(blocks_.size());
  if (node_step_ == probe_step_) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) node_place_[b] = k_sums * n * b;
    return;
  }
  std::fill(needs_nodes_.begin(), needs_nodes_.end(), std::uint8_t{0});
  std::size_t stored = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (kind_[b] != BlockKind::surface) continue;
    for (int x = 0; x <= 1; ++x)
      for (int y = 0; y <= 1; ++y)
        for (int z = 0; z <= 1; ++z)
          if (const std::uint32_t at = neighbors_[b][neighbor_slot(x, y, z)]; at != k_no_block)
            needs_nodes_[at] = 1;
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    node_place_[b] = stored;
    if (needs_nodes_[b]) stored += k_sums * n;
  }
  node_sums_.resize_unset(stored);
  for_each_block(
      threads, [&](std::uint32_t b) { return needs_nodes_[b] != 0; },
      [&](std::uint32_t b, BlockNear& near) {
        best_sum_lanes().sum(lattice(node_step_), near.columns(), node_sums_.data() + node_place_[b]);
      });
}

void SurfaceField::fill(const Threads& threads) {
  const auto to = [&](std::uint32_t b) { return distances_.data() + place_[b]; };
  const auto cut = [&](std::uint32_t b) { return kind_[b] == BlockKind::surface; };
  if (node_step_ == 1) {
    for_each_block(threads, cut, [&](std::uint32_t b, BlockNear& near) {
      float sums[k_sums * k_block_voxels];
      find_distances(lattice(1), near, sums, to(b));
      best_cell_lanes().find_signs(to(b), signs_[b]);
    });
    return;
  }
  parallel_for(
      threads, blocks_.size(),
      [&](std::size_t begin, std::size_t end) {
        NodeRows rows;
        float nodes[k_sums * k_nodes * k_nodes * k_nodes];
        for (auto b = static_cast<std::uint32_t>(begin); b < end; ++b) {
          if (!cut(b)) continue;
          if (node_step_ == 2) {
            find_rows(b, rows);
          } else {
            collect_rows(b, rows, nodes);
          }
          best_surface_lanes().fill_block(shape_, weights_, rows, to(b));
          best_cell_lanes().find_signs(to(b), signs_[b]);
        }
      },
      k_blocks_at_once);
}

std::size_t SurfaceField::bytes() const {
  return particles_.bytes() + finder_.bytes() + blocks_.bytes() + distances_.bytes() + node_sums_.bytes() +
         neighbors_.capacity() * sizeof neighbors_[0] +
         (place_.capacity() + node_place_.capacity()) * sizeof(std::size_t) + kind_.capacity() +
         signs_.capacity() * sizeof(BlockBits) + needs_nodes_.capacity() + outside_.capacity() +
         inside_.capacity();
}

}  // namespace mallow
