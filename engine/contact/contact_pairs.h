#pragma once

#include "contact/contact_points.h"

namespace mallow {

/// Pairs of the points of one block with those of later ones: body by body, and of one body in the order of
/// both points.
struct BlockPairs {
  std::size_t count = 0;
  std::size_t first = 0;  ///< number of the first among the pairs of all blocks
  std::vector<std::uint32_t> own, other;
  std::vector<float> normal_x, normal_y, normal_z, target, sticks, friction;
  struct OtherBody {
    std::uint32_t body;
    std::uint32_t begin, end;  ///< pairs with it, at least one
  };
  std::vector<OtherBody> bodies;  ///< ascending

  PairColumns columns();
  /// Room for so many pairs, and what lanes write behind them.
  void reserve(std::size_t pairs);
  std::size_t bytes() const;
};

/// Fews of later blocks of other bodies near those of one block, body by body.
struct BlockCandidates {
  std::vector<std::uint32_t> fews;
  std::vector<float> squares;  ///< of how near each other points of the two are that may touch [m²]
  std::vector<OwnFew> own;
  std::size_t own_count = 0;
  std::vector<std::uint32_t> bodies;  ///< ascending

  void reserve(std::size_t fews_near);
  std::size_t bytes() const;
};

/// In which pairs the points of one block are: those of the block, and of earlier ones those with its body.
struct BlockSides {
  PointPairs own;
  std::vector<PointPairs> earlier;
};

/// What a step of contact between bodies needs and finds.
struct ContactPairs {
  NearBlocks near;
  ContactPoints points;
  // By block.
  std::vector<BlockCandidates> candidates;
  std::vector<BlockPairs> blocks;
  std::vector<BlockSides> sides;
  // Of a round: by pair see RoundColumns, by point see ContactLanes::share.
  Column<std::uint64_t> acts;
  VectorColumn closing;
  Column<float> impulses;
  Column<float> shares;
  bool keeps_sums = false;  ///< somebody asks what pairs gave
  Column<float> sums;       ///< of the impulses of all rounds; empty where nobody asks

  // By block, of a round.
  std::vector<float> partial_miss;
  std::vector<std::uint32_t> acting;  ///< see ContactLanes::share

  RoundColumns round(const BlockPairs& block);
  TouchingPoints touching(std::size_t block) const;
  std::size_t bytes() const;
};

/// positions, predicted velocities -> pairs, with their normals and targets. [model 2, section 4 C]
/// pin: null where nothing is pinned. Returns whether there is any.
bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs);

}  // namespace mallow
