#pragma once

#include "contact/contact_pairs.h"
#include "core/contact_sums.h"

namespace mallow {

/// Contact between bodies: no pair comes nearer than the two spacings' mean allows, and what slides rubs.
/// Changes the predicted velocities of unpinned particles that meet one of another body; impulses of a pair
/// are equal and opposite to the bit. The friction of a pair is √(μ_i μ_j), as Jolt and Box2D have it. [model
/// 2, section 4 C]
void resolve_body_contacts(const VectorColumn& positions, const std::uint16_t* pin,
                           const std::vector<TouchingBody>& bodies, const BodyContactStep& step,
                           const Execution& execution, VectorColumn& velocities, ContactPairs& pairs);

/// What one body got from another in a block of its pairs.
struct BodyTouch {
  std::uint32_t body, other;  ///< in the order of TouchingBody, body < other
  ContactSums sums;           ///< velocity: seen from `other`
};
/// Pairs of a step whose impulses were kept -> those bodies that touch, block by block; behind what is there.
/// before: velocities at the start of the step.
void list_touches(const VectorColumn& before, const ContactPairs& pairs, std::vector<BodyTouch>& touches);

}  // namespace mallow
