#include "allocation_counter.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "build_kind.h"

namespace mallow::test {
namespace {

std::atomic<bool> counting{false};
std::atomic<std::size_t> total_count{0}, total_bytes{0}, largest_bytes{0};

[[maybe_unused]] void note(std::size_t bytes) noexcept {
  if (!counting.load(std::memory_order_relaxed)) return;
  total_count.fetch_add(1, std::memory_order_relaxed);
  total_bytes.fetch_add(bytes, std::memory_order_relaxed);
  std::size_t largest = largest_bytes.load(std::memory_order_relaxed);
  while (largest < bytes && !largest_bytes.compare_exchange_weak(largest, bytes)) {
  }
}

}  // namespace

void start_counting() {
  total_count = total_bytes = largest_bytes = 0;
  counting = true;
}

Allocations stop_counting() {
  counting = false;
  return {total_count, total_bytes, largest_bytes};
}

}  // namespace mallow::test

#if defined(__GLIBC__) && !defined(MALLOW_SANITIZED)

const bool mallow::test::k_counts_allocations = true;

// glibc lets a program bring its own malloc if it brings all of it, and keeps its own under these names. The
// operators new of libstdc++ and libc++, plain and aligned, end here as well.
extern "C" {

// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  mallow::test::note(size);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  mallow::test::note(count * size);
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  mallow::test::note(size);
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  mallow::test::note(size);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  mallow::test::note(size);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  mallow::test::note(size);
  void* const result = __libc_memalign(alignment, size);
  if (!result) return ENOMEM;
  *memory = result;
  return 0;
}

}  // extern "C"

#else

const bool mallow::test::k_counts_allocations = false;

#endif
