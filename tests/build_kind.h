#pragma once

/// MALLOW_SANITIZED: this program runs with a sanitizer, which brings its own allocator and its own pace.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MALLOW_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define MALLOW_SANITIZED
#endif
#endif

/// MALLOW_TIMED: what this program's time says is said of the engine, too.
#if defined(__OPTIMIZE__) && !defined(MALLOW_SANITIZED)
#define MALLOW_TIMED
#endif
