#pragma once

#include <vector>

#include "mallow/instruction_level.h"

namespace mallow {

/// Every instruction level that this machine has.
inline std::vector<InstructionLevel> levels() {
  std::vector<InstructionLevel> all;
  for (const InstructionLevel level : k_instruction_levels)
    if (level <= best_instruction_level()) all.push_back(level);
  return all;
}

}  // namespace mallow
