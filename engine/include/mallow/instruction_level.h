#pragma once

#include "mallow/export.h"

namespace mallow {

/// Instruction levels that the lanes of a step are compiled for. All give the same bits; higher ones are
/// faster.
enum class InstructionLevel {
  baseline,  ///< x86-64-v2 (SSE 4.2), or what the compiler takes for granted on other machines
  v3,        ///< x86-64-v3: AVX2
  v4,        ///< x86-64-v4: AVX-512
};
/// All there are, each above the one before.
inline constexpr InstructionLevel k_instruction_levels[] = {InstructionLevel::baseline, InstructionLevel::v3,
                                                            InstructionLevel::v4};

/// "x86-64-v2", "x86-64-v3", "x86-64-v4"; the lowest is "baseline" on other machines.
MALLOW_EXPORT const char* name(InstructionLevel level);

/// The highest level this machine has; it has those below, too.
MALLOW_EXPORT InstructionLevel best_instruction_level();

}  // namespace mallow
