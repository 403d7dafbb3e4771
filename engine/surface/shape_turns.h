#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "core/threads.h"
#include "mallow/vec3.h"

namespace mallow {

/// The rotations that take the regions of one shape nearest to where they are in another, as shape matching
/// does: A_i is the rotation of the polar decomposition of Σ w_j (x̄'_j − c̄') (x̄_j − c̄)ᵀ over the particles
/// within `radius` of i in the first shape, w_j = 1/|N_j| [TK eq. 7, model 2].
/// A skin could as well go to a new reference shape by the rotations of its last update, which cost nothing.
/// But what a body turned since then would be lost: a cube that turns by 8 rad and yields 39 times was 0.8
/// rad behind, and is 0.03 so, a step's turn. which: those i that are asked for; turns: one for each.
/// spacing: h, radius: of the regions [m].
void find_turns(std::span<const Vec3> from, std::span<const Vec3> to, float spacing, float radius,
                std::span<const std::uint32_t> which, const Threads& threads,
                std::span<Eigen::Quaternionf> turns);

}  // namespace mallow
