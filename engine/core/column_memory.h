#pragma once

#include <cstddef>

#include "mallow/export.h"

namespace mallow {

/// Memory on a cache line boundary; large blocks on huge pages where the system has them: gathers from
/// columns of a million particles otherwise spend their time on address translation. Throws std::bad_alloc.
MALLOW_EXPORT void* allocate_column(std::size_t bytes);
/// bytes: as allocated.
MALLOW_EXPORT void free_column(void* memory, std::size_t bytes) noexcept;

}  // namespace mallow
