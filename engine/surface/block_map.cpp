#include "surface/block_map.h"

#include <algorithm>
#include <bit>

namespace mallow {
namespace {

constexpr std::uint32_t k_no_group = UINT32_MAX;
constexpr int k_bits = 19, k_bias = 1 << (k_bits - 1);

/// Coordinates of cubes, ordered like the keys: x slowest.
std::uint64_t key_of(int x, int y, int z) {
  const auto bits = [](int c) { return static_cast<std::uint64_t>(c + k_bias); };
  return bits(x) << (2 * k_bits) | bits(y) << k_bits | bits(z);
}
BlockMap::Coord place_of(std::uint64_t key) {
  const auto coordinate = [&](int shift) {
    return static_cast<int>(key >> shift & ((1u << k_bits) - 1)) - k_bias;
  };
  return {coordinate(2 * k_bits), coordinate(k_bits), coordinate(0)};
}

/// Bits of a cube whose places along one axis are in [first, last], of which some are: by where the axis's
/// places lie, 16, 4 bits or 1 apart.
struct Places {
  unsigned first, last;
  Places(int from, int to)
      : first(static_cast<unsigned>(std::max(from, 0))), last(static_cast<unsigned>(std::min(to, 3))) {}
  std::uint64_t slab_16() const {
    return ~std::uint64_t{0} >> (48 - 16 * last) & ~std::uint64_t{0} << 16 * first;
  }
  std::uint64_t slab_4() const {
    return (0xFFFFu >> (12 - 4 * last) & 0xFFFFu << 4 * first) * 0x0001000100010001u;
  }
  std::uint64_t slab_1() const { return (0xFu >> (3 - last) & 0xFu << first) * 0x1111111111111111u; }
};

/// Numbers of the blocks of a cube and of those next to it.
class Surroundings {
 public:
  Surroundings() { std::fill_n(&numbers_[0][0][0], k_side * k_side * k_side, k_no_block); }

  /// The blocks of the cube that is `offset` cubes away (each of −1, 0, 1), as far as they are next to this
  /// one. first: number of the first of them.
  void add(const BlockMap::Coord& offset, std::uint64_t blocks, std::uint32_t first) {
    const Span x = span_of(offset.x()), y = span_of(offset.y()), z = span_of(offset.z());
    for (int i = x.first; i <= x.last; ++i) {
      for (int j = y.first; j <= y.last; ++j) {
        const int row = i << 4 | j << 2 | z.first;
        const std::uint64_t before = blocks & ((std::uint64_t{1} << row) - 1);
        std::uint32_t number = first + static_cast<std::uint32_t>(std::popcount(before));
        std::uint32_t* const to = numbers_[i + x.shift][j + y.shift] + z.first + z.shift;
        for (int k = 0; k <= z.last - z.first; ++k)
          if (blocks >> (row + k) & 1) to[k] = number++;
      }
    }
  }
  /// block: its bit in the cube.
  void copy_around(int block, std::uint32_t* to) const {
    const int x = block >> 4, y = block >> 2 & 3, z = block & 3;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j, to += 3) std::copy_n(numbers_[x + i][y + j] + z, 3, to);
  }

 private:
  static constexpr int k_side = BlockMap::k_cube_side + 2;
  /// Places along an axis of the cube `offset` away, and what they are shifted by in the table.
  struct Span {
    int first, last, shift;
  };
  static Span span_of(int offset) {
    constexpr int k_last = BlockMap::k_cube_side - 1;
    return {offset < 0 ? k_last : 0, offset > 0 ? 0 : k_last, 1 + offset * BlockMap::k_cube_side};
  }
  std::uint32_t numbers_[k_side][k_side][k_side];
};

}  // namespace

void BlockMap::clear() {
  std::fill(cubes_.begin(), cubes_.end(), Cube{});
  used_ = size_ = 0;
  keys_.clear();
  blocks_.clear();
  groups_.clear();
  group_of_.clear();
}

std::size_t BlockMap::slot_of(std::uint64_t key) const {
  // Fibonacci hashing: neighbours along z land far from each other.
  const std::size_t mask = cubes_.size() - 1;
  std::size_t slot = static_cast<std::size_t>(key * 0x9E3779B97F4A7C15u >> 32) & mask;
  while (cubes_[slot].key != k_free && cubes_[slot].key != key) slot = (slot + 1) & mask;
  return slot;
}

BlockMap::Cube& BlockMap::cube(std::uint64_t key) {
  if (last_ < cubes_.size() && cubes_[last_].key == key) return cubes_[last_];
  if (2 * (used_ + 1) > cubes_.size()) {
    std::vector<Cube> old(std::max<std::size_t>(1024, 2 * cubes_.size()));
    old.swap(cubes_);
    for (const Cube& c : old)
      if (c.key != k_free) cubes_[slot_of(c.key)] = c;
  }
  last_ = slot_of(key);
  Cube& found = cubes_[last_];
  if (found.key == k_free) {
    found.key = key;
    ++used_;
    keys_.push_back(key);
  }
  return found;
}

void BlockMap::insert(const Coord& first, const Coord& last) {
  for (int x = first.x() >> 2; x <= last.x() >> 2; ++x) {
    const std::uint64_t in_x = Places(first.x() - k_cube_side * x, last.x() - k_cube_side * x).slab_16();
    for (int y = first.y() >> 2; y <= last.y() >> 2; ++y) {
      const std::uint64_t in_xy =
          in_x & Places(first.y() - k_cube_side * y, last.y() - k_cube_side * y).slab_4();
      for (int z = first.z() >> 2; z <= last.z() >> 2; ++z) {
        const std::uint64_t in_z = Places(first.z() - k_cube_side * z, last.z() - k_cube_side * z).slab_1();
        Cube& c = cube(key_of(x, y, z));
        const std::uint64_t more = in_xy & in_z & ~c.blocks;
        if (more == 0) continue;
        c.blocks |= more;
        size_ += static_cast<std::size_t>(std::popcount(more));
      }
    }
  }
}

void BlockMap::number() {
  std::sort(keys_.begin(), keys_.end());
  blocks_.clear();
  groups_.clear();
  group_of_.clear();
  for (const std::uint64_t key : keys_) {
    Cube& c = cubes_[slot_of(key)];
    c.first = static_cast<std::uint32_t>(blocks_.size());
    const Coord first = k_cube_side * place_of(key);
    std::array<std::uint32_t, 8> in_cube;
    in_cube.fill(k_no_group);
    for (std::uint64_t left = c.blocks; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      const Coord place(bit >> 4, bit >> 2 & 3, bit & 3);
      add_to_group(first, place, in_cube);
      blocks_.push_back(first + place);
    }
  }
}

/// The block that is numbered next. in_cube: the groups of its cube so far.
void BlockMap::add_to_group(const Coord& cube, const Coord& place, std::array<std::uint32_t, 8>& in_cube) {
  const auto number = [](int x, int y, int z) { return static_cast<std::size_t>(x << 2 | y << 1 | z); };
  std::uint32_t& group = in_cube[number(place.x() >> 1, place.y() >> 1, place.z() >> 1)];
  if (group == k_no_group) {
    group = static_cast<std::uint32_t>(groups_.size());
    groups_.push_back({cube + Coord(place.x() & 2, place.y() & 2, place.z() & 2), {}});
    groups_.back().blocks.fill(k_no_block);
  }
  groups_[group].blocks[number(place.x() & 1, place.y() & 1, place.z() & 1)] =
      static_cast<std::uint32_t>(blocks_.size());
  group_of_.push_back(group);
}

const BlockMap::Cube& BlockMap::cube_at(const Coord& place) const {
  return cubes_[slot_of(key_of(place.x(), place.y(), place.z()))];
}

void BlockMap::find_around(std::size_t cube, std::span<std::array<std::uint32_t, 27>> around) const {
  Surroundings numbers;
  const Coord place = place_of(keys_[cube]);
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Cube& from = cube_at(place + Coord(x, y, z));
        if (from.blocks != 0) numbers.add({x, y, z}, from.blocks, from.first);
      }
    }
  }
  const Cube& here = cube_at(place);
  std::uint32_t number = here.first;
  for (std::uint64_t left = here.blocks; left != 0; left &= left - 1, ++number)
    numbers.copy_around(std::countr_zero(left), around[number].data());
}

std::size_t BlockMap::bytes() const {
  return cubes_.capacity() * sizeof(Cube) + keys_.capacity() * sizeof(std::uint64_t) +
         blocks_.capacity() * sizeof(Coord) + groups_.capacity() * sizeof(Group) +
         group_of_.capacity() * sizeof(std::uint32_t);
}

}  // namespace mallow
