#pragma once

#include "contact/contact_lanes.h"
#include "contact/near_blocks.h"

namespace mallow {

/// How each few points move: as Moving says it.
struct FewMotion {
  VectorColumn velocity;  ///< [m/s]
  Column<float> spread;   ///< [m/s]
};

/// The particles of all blocks near another body's. Those of a block are whole fews: some of the last are
/// nowhere, and in no pair.
struct ContactPoints {
  Column<std::uint32_t> first;         ///< per block, and one more
  std::vector<std::size_t> first_row;  ///< per block, that of its first point
  VectorColumn position;               ///< [m]
  // Rows of four floats, as lanes have them.
  Column<float> place, outward, matter, velocity;
  Column<float> inverse_mass;  ///< 0 where one is pinned [kg⁻¹]
  // By few.
  VectorColumn low, high;  ///< corners of the box around its points [m]
  FewMotion motion;
  FewMotion found_motion;  ///< by which near ones were found, slack and all

  bool empty() const { return inverse_mass.empty(); }
  std::size_t size() const { return inverse_mass.size(); }
  std::size_t first_few(std::size_t block) const { return first[block] / k_cluster; }
  ContactRows rows() const { return {place.data(), outward.data(), matter.data(), velocity.data()}; }
  Vec3 velocity_of(std::size_t point) const { return Eigen::Map<const Vec3>(velocity.data() + 4 * point); }
  std::size_t bytes() const;
};

/// Blocks that are near -> points. pin: null where nothing is pinned.
void place_points(const VectorColumn& positions, const std::uint16_t* pin,
                  const std::vector<TouchingBody>& bodies, const NearBlocks& near, const Execution& execution,
                  ContactPoints& points);
/// velocities -> those of points, and how fews move.
void move_points(const VectorColumn& velocities, const NearBlocks& near, const Execution& execution,
                 ContactPoints& points);

/// Velocities of points -> velocities.
void return_points(const ContactPoints& points, const NearBlocks& near, const Execution& execution,
                   VectorColumn& velocities);

}  // namespace mallow
