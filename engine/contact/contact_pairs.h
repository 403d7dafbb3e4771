#pragma once

#include <span>

#include "contact/contact_lanes.h"
#include "contact/near_blocks.h"

namespace mallow {

/// A particle near another body: three rows of four floats, as lanes load them.
struct ContactPoint {
  Vec3 position;       ///< [m]
  float half_spacing;  ///< h/2 [m]
  Vec3 outward;        ///< N/|N|, which way out of its body it lies; 0 where nothing says it
  float depth;         ///< |N|, from the middle of its region to it [m]
  float inverse_mass;  ///< 1/m, 0 where it is pinned [1/kg]
  float friction;      ///< √μ_f
  float adhesion;      ///< √a [√Pa]
  float unused;
};

/// A velocity, and the inverse mass of its point times how many of its pairs act in a round: a row of four
/// floats.
struct ContactVelocity {
  Vec3 velocity;  ///< [m/s]
  float share;    ///< [1/kg]
};

/// Pairs of the points of one block with those of later ones.
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

/// Points of later blocks of other bodies near each few points of one block, one's behind the other's.
struct BlockCandidates {
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> ends;  ///< of each few
};

/// The points of one block that have pairs, and for each which, one point's behind the other's: those in
/// which it is the first, then those in which it is the second.
struct BlockSides {
  struct Touching {
    std::uint32_t point, end;
  };
  struct Side {
    std::uint32_t pair;  ///< of the pairs of all blocks
    float sign;          ///< −1 where the point is the second
  };
  std::vector<Touching> points;
  std::vector<Side> sides;
};

/// What a step of contact between bodies needs and finds.
struct ContactPairs {
  NearBlocks near;
  // By block.
  std::vector<BlockCandidates> candidates;
  std::vector<BlockPairs> blocks;
  std::vector<BlockSides> sides;
  // By point.
  std::vector<ContactPoint> points;
  std::vector<ContactVelocity> velocity;
  VectorColumn positions;
  // By k_cluster points of a block, those of one block behind those of the other.
  Column<std::uint32_t> first_few;  ///< per block, and one more
  VectorColumn few_low, few_high;   ///< corners of the box around them [m]
  // By pair, of a round.
  Column<float> acts;       ///< 1 or 0
  Column<float> impulses;   ///< on the first point, rows of four: three, and nothing [N s]
  bool keeps_sums = false;  ///< somebody asks what pairs gave
  Column<float> sums;       ///< of the impulses of all rounds; empty where nobody asks

  std::vector<float> partial_miss;  ///< scratch

  ContactRows rows() const;
  std::size_t bytes() const;
};

/// positions, predicted velocities -> pairs, with their normals and targets. [model 2, section 4 C]
/// pin: null where nothing is pinned. Returns whether there is any.
bool find_contact_pairs(const VectorColumn& positions, const VectorColumn& velocities,
                        const std::uint16_t* pin, const std::vector<TouchingBody>& bodies,
                        const BodyContactStep& step, const Execution& execution, ContactPairs& pairs);

}  // namespace mallow
