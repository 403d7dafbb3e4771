#pragma once

/// Marks what a shared library of mallow shows: what is declared in these headers, and the few declarations
/// of the engine that mallow::level_set, mallow::scene and the renderer use. All else is hidden. Windows has
/// no such mark that would not change with the library; CMake exports every symbol there.
#if defined(__GNUC__)
#define MALLOW_EXPORT __attribute__((visibility("default")))
#else
#define MALLOW_EXPORT
#endif
