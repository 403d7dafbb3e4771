#pragma once

#include <cstddef>
#include <memory>

#include "mallow/export.h"

namespace mallow {

/// Memory on a cache line boundary; large blocks on huge pages where the system has them: gathers from
/// columns of a million particles otherwise spend their time on address translation. Throws std::bad_alloc.
MALLOW_EXPORT void* allocate_column(std::size_t bytes);
/// bytes: as allocated.
MALLOW_EXPORT void free_column(void* memory, std::size_t bytes) noexcept;

/// Keeps a column's memory from being given back as long as what is returned lives: a view of it then reads
/// memory of its own, whatever became of the column. For languages in which a view may outlive what it shows.
/// memory: the first byte of a column that is there. Any thread may call it, and let go of it.
MALLOW_EXPORT std::shared_ptr<const void> keep_column(const void* memory);

}  // namespace mallow
