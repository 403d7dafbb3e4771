#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mallow/vec3.h"

namespace mallow {

/// Number of a block that is not there.
inline constexpr std::uint32_t k_no_block = UINT32_MAX;

/// A set of blocks of a grid, kept as bits of cubes of 4³ blocks, which costs memory for the cubes there are
/// and not for the box they lie in. Blocks are numbered cube by cube, by coordinates (x slowest), whatever
/// the order they came in. Coordinates: −2^20 to 2^20 − 1.
class BlockMap {
 public:
  using Coord = Eigen::Vector3i;
  static constexpr int k_cube_side = 4;
  /// Those of 2 × 2 × 2 places, x slowest, of a cube; k_no_block where none is.
  struct Group {
    Coord first;  ///< place
    std::array<std::uint32_t, 8> blocks;
  };

  void clear();
  /// All blocks of a box, its corners included. Numbers hold until the next insert.
  void insert(const Coord& first, const Coord& last);
  void insert(const Coord& block) { insert(block, block); }
  /// Numbers the blocks and lists them.
  void number();
  /// Cubes there are, in the order of their blocks.
  std::size_t cubes() const { return keys_.size(); }
  /// The numbers of the 27 blocks around a block, itself included, x slowest, for each block of a cube.
  /// around: by block, of all that are numbered.
  void find_around(std::size_t cube, std::span<std::array<std::uint32_t, 27>> around) const;
  /// Blocks there are, numbered or not.
  std::size_t size() const { return size_; }
  std::span<const Coord> blocks() const { return blocks_; }
  /// Each with a block at least.
  std::span<const Group> groups() const { return groups_; }
  std::uint32_t group_of(std::uint32_t block) const { return group_of_[block]; }
  std::size_t bytes() const;

 private:
  static constexpr std::uint64_t k_free = UINT64_MAX;
  struct Cube {
    std::uint64_t key = k_free;
    std::uint64_t blocks = 0;  ///< a bit each, z fastest
    std::uint32_t first = 0;   ///< number of the first of them
  };

  std::size_t slot_of(std::uint64_t key) const;
  const Cube& cube_at(const Coord& place) const;
  Cube& cube(std::uint64_t key);
  void add_to_group(const Coord& cube, const Coord& place, std::array<std::uint32_t, 8>& in_cube);

  std::vector<Cube> cubes_;  ///< open addressing; a power of two, at most half full
  std::size_t used_ = 0, size_ = 0;
  std::size_t last_ = 0;  ///< slot of the cube that was asked for last: mostly it is asked for again
  std::vector<std::uint64_t> keys_;
  std::vector<Coord> blocks_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> group_of_;
};

}  // namespace mallow
