#pragma once

#include <span>

#include "core/column.h"
#include "motion/contact.h"
#include "motion/contact_kernels.h"
#include "motion/motion_kernels.h"

namespace mallow {

/// Rows [begin, end) of the store, at most k_block of them, that meet obstacles with new velocities.
struct ContactBlock {
  std::size_t begin, end;
  const VectorColumn& position;
  const VectorColumn& before;  ///< v at the start of the step
  const std::uint16_t* pin;    ///< rows whose pin is not 0 meet nothing; null: all do
  BlockBounds bounds;          ///< of the positions and of the velocities before contact
};

/// v of every row becomes what resolve_contact makes of it with each collider in order, bit for bit. Only
/// rows within reach of a part are resolved, and only parts within reach of the block are looked at: a
/// surface farther than contact_offset + Δt |v − u| leaves v alone, for |n| = 1. [model 2, section 4 A]
void resolve_contacts(const ContactBlock& block, std::span<const Collider> colliders, const ContactStep& step,
                      const ContactKernels& kernels, VectorColumn& velocity);

}  // namespace mallow
