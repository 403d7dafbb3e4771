#pragma once

#include <span>

#include "contact/contact_points.h"

namespace mallow {

/// Pairs of the points of one block with those of later ones, in the order of both.
struct BlockPairs {
  std::size_t count = 0;
  std::size_t first = 0;  ///< number of the first among the pairs of all blocks
  std::vector<std::uint32_t> own, other;
  std::vector<float> normal_x, normal_y, normal_z, target, sticks, friction;

  std::span<const std::uint32_t> others() const { return {other.data(), count}; }
  PairColumns columns();
  /// Room for so many pairs, and what lanes write behind them.
  void reserve(std::size_t pairs);
  std::size_t bytes() const;
};

/// For each few of one block those of later blocks of other bodies near it, one's behind the other's.
struct BlockCandidates {
  std::vector<std::uint32_t> fews;
  std::vector<float> squares;       ///< of how near each other points of the two are that may touch [m²]
  std::vector<std::uint32_t> ends;  ///< of each few of the block

  void reserve(std::size_t room);
  std::size_t bytes() const;
};

/// The points of one block that have pairs, and those of earlier blocks' in which they are the second.
struct BlockSides {
  std::vector<TouchingPoint> points;
  std::vector<std::uint32_t> others;

  TouchingPoints touching() const { return {points.data(), points.size(), others.data()}; }
};

/// What a step of contact between bodies needs and finds.
struct ContactPairs {
  NearBlocks near;
  ContactPoints points;
  // By block.
  std::vector<BlockCandidates> candidates;
  std::vector<BlockPairs> blocks;
  std::vector<BlockSides> sides;
  // By pair, of a round: see RoundColumns.
  Column<float> acts, own_share, other_share;
  VectorColumn closing;
  Column<float> impulses;
  bool keeps_sums = false;  ///< somebody asks what pairs gave
  Column<float> sums;       ///< of the impulses of all rounds; empty where nobody asks

  std::vector<float> partial_miss;  ///< scratch

  /// From a pair on.
  RoundColumns round(std::size_t pair);
  std::size_t bytes() const;
};

/// positions, predicted velocities -> pairs, with their normals and targets. [model 2, section 4 C]
/// pin: null where nothing is pinned. Returns whether there is any.
bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs);

}  // namespace mallow
