#include "core/column_memory.h"

#include <atomic>
#include <mutex>
#include <new>
#include <unordered_map>

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

/// A block that views keep.
struct KeptBlock {
  std::size_t views = 0;
  std::size_t freed_bytes = 0;  // 0 while its column is there
};
struct KeptBlocks {
  std::mutex mutex;
  std::unordered_map<const void*, KeptBlock> blocks;
  std::atomic<std::size_t> count = 0;  // of blocks: a free() without any of them takes no lock
};
/// Never destroyed: views may outlive what ends with the program.
KeptBlocks& kept_blocks() {
  static KeptBlocks& kept = *new KeptBlocks;
  return kept;
}

void free_block(void* memory, std::size_t bytes) noexcept {
  ::operator delete[](memory, alignment_of(bytes));
}

void let_go(const void* memory) {
  KeptBlocks& kept = kept_blocks();
  const std::scoped_lock lock(kept.mutex);
  const auto found = kept.blocks.find(memory);
  if (--found->second.views > 0) return;
  const std::size_t freed_bytes = found->second.freed_bytes;
  kept.blocks.erase(found);
  kept.count = kept.blocks.size();
  if (freed_bytes > 0) free_block(const_cast<void*>(memory), freed_bytes);
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
  KeptBlocks& kept = kept_blocks();
  if (kept.count > 0) {
    const std::scoped_lock lock(kept.mutex);
    const auto found = kept.blocks.find(memory);
    if (found != kept.blocks.end()) {
      found->second.freed_bytes = bytes;
      return;
    }
  }
  free_block(memory, bytes);
}

std::shared_ptr<const void> keep_column(const void* memory) {
  KeptBlocks& kept = kept_blocks();
  const std::scoped_lock lock(kept.mutex);
  ++kept.blocks[memory].views;
  kept.count = kept.blocks.size();
  return {memory, let_go};
}

}  // namespace mallow
