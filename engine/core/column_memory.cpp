#include "core/column_memory.h"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace mallow {
namespace {

constexpr std::size_t k_cache_line = 64;
constexpr std::size_t k_huge_page = std::size_t{2} << 20;
/// From here on what is lost at the end of the last huge page is little.
constexpr std::size_t k_large = 4 * k_huge_page;

std::align_val_t alignment_of(std::size_t bytes) {
  return std::align_val_t{bytes >= k_large ? k_huge_page : k_cache_line};
}

}  // namespace

void* allocate_column(std::size_t bytes) {
  void* const memory = ::operator new[](bytes, alignment_of(bytes));
#ifdef MADV_HUGEPAGE
  // A wish: where it is not granted, pages are small as before.
  if (bytes >= k_large) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_column(void* memory, std::size_t bytes) noexcept {
  ::operator delete[](memory, alignment_of(bytes));
}

}  // namespace mallow
