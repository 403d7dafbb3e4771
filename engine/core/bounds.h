#pragma once

#include <vector>

#include "core/column.h"
#include "core/threads.h"

namespace mallow {

/// What holds no point: every union with it is the other box.
Aabb empty_box();
/// Smallest box around two boxes.
Aabb box_around(const Aabb& a, const Aabb& b);
/// Whether a point is in a box, or not farther from it than `reach` along any axis; numbers that are none are
/// nowhere.
bool is_near(const Vec3& x, const Aabb& box, float reach = 0);
/// The same of two boxes.
bool are_near(const Aabb& a, const Aabb& b, float reach);
/// Smallest box around the points [begin, end), numbers that are none left out.
Aabb box_around(const VectorColumn& points, std::size_t begin, std::size_t end);
/// The same for many points, which must not be none. partial: scratch.
Aabb bounds_of(const VectorColumn& points, std::size_t begin, std::size_t end, const Threads& threads,
               std::vector<Aabb>& partial);

}  // namespace mallow
