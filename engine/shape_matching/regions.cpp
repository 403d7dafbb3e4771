#include <algorithm>

#include "core/parallel.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

/// Lists of all particles within the region radius of each particle.
void search(int threads, InstructionLevel level, CellGrid& grid, const ShapeMatching& shape,
            NeighborLists& lists) {
  const std::size_t n = shape.reference.size();
  build_cell_grid(shape.reference, 0, n, shape.region_radius, threads, grid);
  // The reference shape before this one had about as many pairs.
  const auto capacity = static_cast<std::size_t>(1.1 * shape.average_neighbors * static_cast<double>(n));
  build_neighbor_lists(grid, shape.region_radius, threads, level, lists, capacity);
  // The grid may order the particles of a cell border otherwise than they lie (rounding), so go through its
  // order.
  const std::uint32_t* const order = grid.order.data();
  for (std::size_t k = 0; k < lists.indices.size(); ++k) {
    std::uint32_t& index = lists.indices[k];
    if (index < n) index = order[index];
  }
  Column<std::uint32_t> begin_of(n), count_of(n);
  for (std::size_t s = 0; s < n; ++s) {
    begin_of[order[s]] = lists.begin[s];
    count_of[order[s]] = lists.count[s];
  }
  lists.begin.swap(begin_of);
  lists.count.swap(count_of);
}

/// 32 well-mixed bits of a number (Mueller's integer hash).
std::uint32_t scattered(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  return x ^ (x >> 16);
}

/// The particles that own regions, ascending.
std::vector<std::uint32_t> choose_owners(const NeighborLists& near, std::uint32_t stride) {
  std::vector<std::uint32_t> owners;
  const auto drawn = [&](std::uint32_t i) { return is_drawn(i, stride); };
  for (std::uint32_t i = 0; i < near.count.size(); ++i) {
    const std::span<const std::uint32_t> list = near.of(i);
    // i is in j's region where j is in i's list: distances are symmetric to the bit. A drawn i is in its own.
    if (drawn(i) || std::none_of(list.begin(), list.end(), drawn)) owners.push_back(i);
  }
  return owners;
}

/// Lists behind each other, without space between.
void append(std::span<const std::uint32_t> list, std::size_t row, NeighborLists& lists) {
  lists.begin[row] = static_cast<std::uint32_t>(lists.total);
  lists.count[row] = static_cast<std::uint32_t>(list.size());
  std::copy(list.begin(), list.end(), lists.indices.data() + lists.total);
  lists.total += list.size();
}

void resize(std::size_t rows, std::size_t entries, NeighborLists& lists) {
  lists.begin.resize(rows);
  lists.count.resize(rows);
  lists.indices.resize(entries);
  lists.total = 0;
}

/// Keeps the lists of the owners, and turns them around for the particles.
void keep_owned(const NeighborLists& near, const std::vector<std::uint32_t>& owners, ShapeMatching& shape) {
  const std::size_t n = near.count.size();
  constexpr std::uint32_t k_none = 0xffffffff;
  std::vector<std::uint32_t> region_of(n, k_none);
  std::size_t entries = 0;
  for (std::uint32_t j = 0; j < owners.size(); ++j) {
    region_of[owners[j]] = j;
    entries += near.count[owners[j]];
  }
  resize(owners.size(), entries, shape.regions);
  for (std::size_t j = 0; j < owners.size(); ++j) append(near.of(owners[j]), j, shape.regions);
  resize(n, entries, shape.memberships);
  std::vector<std::uint32_t> mine;
  for (std::size_t i = 0; i < n; ++i) {
    mine.clear();
    for (const std::uint32_t j : near.of(i))
      if (region_of[j] != k_none) mine.push_back(region_of[j]);
    append(mine, i, shape.memberships);
  }
}

/// W_j, c̄_j and B_j of the regions [begin, end). `owners`: empty where every particle is one.
void measure_regions(const std::vector<std::uint32_t>& owners, std::size_t begin, std::size_t end,
                     ShapeMatching& shape) {
  for (std::size_t j = begin; j < end; ++j) {
    // Relative to the owner and in double: exact enough that no step needs to do it again.
    const Eigen::Vector3d owner = shape.reference.get(owners.empty() ? j : owners[j]).cast<double>();
    double weight = 0;
    Eigen::Vector3d first(0, 0, 0);
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : shape.regions.of(j)) {
      const Eigen::Vector3d d = shape.reference.get(i).cast<double>() - owner;
      const double w = static_cast<double>(shape.weight[i]);
      weight += w;
      first += w * d;
      second += w * d * d.transpose();
    }
    const Eigen::Vector3d offset = first / weight;
    second -= weight * offset * offset.transpose();
    shape.region_weight[j] = static_cast<float>(weight);
    shape.center.set(j, (owner + offset).cast<float>());
    const double entries[6] = {second(0, 0), second(1, 1), second(2, 2),
                               second(1, 2), second(0, 2), second(0, 1)};
    for (std::size_t k = 0; k < 6; ++k) shape.moment[k][j] = static_cast<float>(entries[k]);
  }
}

}  // namespace

bool is_drawn(std::uint32_t row, std::uint32_t stride) {
  return row % stride == scattered(row / stride) % stride;
}

std::size_t ShapeMatching::bytes() const {
  std::size_t sum = reference.bytes() + regions.bytes() + memberships.bytes() + weight.bytes() +
                    region_weight.bytes() + center.bytes() + rows.bytes() + sums.bytes() + undecided.bytes() +
                    pull.bytes();
  for (const Column<float>& column : moment) sum += column.bytes();
  for (const Column<float>& column : rotation) sum += column.bytes();
  return sum;
}

void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      ShapeMatching& shape) {
  const std::size_t n = end - begin;
  Eigen::Vector3d mean(0, 0, 0);
  for (std::size_t i = begin; i < end; ++i) mean += positions.get(i).cast<double>();
  mean /= static_cast<double>(n);
  shape.reference.resize(n);
  shape.total_moment = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d x = positions.get(begin + i).cast<double>() - mean;
    shape.total_moment += x.squaredNorm();
    shape.reference.set(i, x.cast<float>());
  }
  shape.total_moment /= static_cast<double>(n);
  shape.frame = {};
  shape.built = false;
}

void build_regions(int threads, InstructionLevel level, CellGrid& grid, ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  std::vector<std::uint32_t> owners;
  if (shape.region_stride == 1) {
    search(threads, level, grid, shape, shape.regions);
    shape.average_neighbors = shape.regions.average();
  } else {
    NeighborLists near;
    search(threads, level, grid, shape, near);
    shape.average_neighbors = near.average();
    owners = choose_owners(near, static_cast<std::uint32_t>(shape.region_stride));
    keep_owned(near, owners, shape);
  }

  const std::size_t regions = shape.regions.count.size();
  shape.region_weight.resize(regions);
  shape.center.resize(regions);
  for (Column<float>& column : shape.moment) column.resize(regions);
  for (std::size_t k = 0; k < 4; ++k) {
    shape.rotation[k].resize(regions);
    // Also the padding, where a zero quaternion would have no direction.
    std::fill_n(shape.rotation[k].data(), padded(regions), k == 3 ? 1.0f : 0.0f);
  }
  shape.sums.resize(regions * k_row);
  shape.undecided.resize(regions);
  shape.weight.resize(n);
  shape.rows.resize(n * k_row);
  shape.pull.resize(n);

  const Column<std::uint32_t>& memberships = owners.empty() ? shape.regions.count : shape.memberships.count;
  for (std::size_t i = 0; i < n; ++i) shape.weight[i] = 1.0f / static_cast<float>(memberships[i]);
  parallel_for(threads, regions,
               [&](std::size_t begin, std::size_t end) { measure_regions(owners, begin, end, shape); });
  shape.built = true;
}

}  // namespace mallow
