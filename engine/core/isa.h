#pragma once

#include "mallow/export.h"
#include "mallow/instruction_level.h"

/// Files of lanes, `*_lanes.cpp`, are compiled once per level, each into a namespace of its own that this
/// macro names (see mallow_add_lanes in core/lanes.cmake). All levels give the same bits: fixed lanes, no
/// contraction. They include nothing with inline functions: the linker would keep one level's copy for all.
#ifndef MALLOW_LEVEL
#define MALLOW_LEVEL level_baseline
#endif

#ifdef MALLOW_X86_LEVELS
/// Picks `table` from the namespace of a level.
#define MALLOW_SELECT(level, table)                              \
  ((level) == ::mallow::InstructionLevel::v4   ? level_v4::table \
   : (level) == ::mallow::InstructionLevel::v3 ? level_v3::table \
                                               : level_baseline::table)
#define MALLOW_DECLARE_LEVELS(type, table) \
  namespace level_baseline {               \
  extern MALLOW_EXPORT const type table;   \
  }                                        \
  namespace level_v3 {                     \
  extern MALLOW_EXPORT const type table;   \
  }                                        \
  namespace level_v4 {                     \
  extern MALLOW_EXPORT const type table;   \
  }
/// The same for files that mallow_add_native_lanes() compiles once more: where `native`, from what is as fast
/// as a level can be and has the bits of that level alone. The lowest has no fused multiply-adds: it is
/// exact.
#define MALLOW_SELECT_NATIVE(level, native, table)                           \
  (!(native)                                   ? MALLOW_SELECT(level, table) \
   : (level) == ::mallow::InstructionLevel::v4 ? level_v4_native::table      \
   : (level) == ::mallow::InstructionLevel::v3 ? level_v3_native::table      \
                                               : level_baseline::table)
#define MALLOW_DECLARE_NATIVE_LEVELS(type, table) \
  namespace level_v3_native {                     \
  extern MALLOW_EXPORT const type table;          \
  }                                               \
  namespace level_v4_native {                     \
  extern MALLOW_EXPORT const type table;          \
  }
#else
#define MALLOW_SELECT_NATIVE(level, native, table) ((void)(native), MALLOW_SELECT(level, table))
#define MALLOW_DECLARE_NATIVE_LEVELS(type, table)
#define MALLOW_SELECT(level, table) ((void)(level), level_baseline::table)
#define MALLOW_DECLARE_LEVELS(type, table) \
  namespace level_baseline {               \
  extern MALLOW_EXPORT const type table;   \
  }
#endif
