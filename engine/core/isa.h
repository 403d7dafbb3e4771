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
#else
#define MALLOW_SELECT(level, table) ((void)(level), level_baseline::table)
#define MALLOW_DECLARE_LEVELS(type, table) \
  namespace level_baseline {               \
  extern MALLOW_EXPORT const type table;   \
  }
#endif
