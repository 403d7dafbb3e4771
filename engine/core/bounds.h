#pragma once

#include <vector>

#include "core/column.h"
#include "core/threads.h"

namespace mallow {

/// Smallest box around the points [begin, end), which must not be empty. partial: scratch.
Aabb bounds_of(const VectorColumn& points, std::size_t begin, std::size_t end, const Threads& threads,
               std::vector<Aabb>& partial);

}  // namespace mallow
