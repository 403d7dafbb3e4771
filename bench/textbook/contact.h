#pragma once

#include "mallow/collider.h"
#include "textbook/particle.h"

/// Section 4 A of the model's second chapter.
namespace mallow::textbook {

struct Obstacle {
  Collider collider;
  Vec moved{0, 0, 0};  ///< since it was added [m]
};

struct ContactStep {
  double time_step;       ///< Δt [s]
  double contact_offset;  ///< gap at which particles touch [m]
  double max_push;        ///< speed at which a deep overlap is pushed out, σ/(10 Δt0) [m/s]
  Vec gravity;            ///< [m/s²]
};

/// The velocity v of a particle at x, which came with `before`, after it touched an obstacle; v itself where
/// it does not.
Vec resolve_contact(const Obstacle& obstacle, const ContactStep& step, const Vec& x, const Vec& before,
                    const Vec& v);

}  // namespace mallow::textbook
