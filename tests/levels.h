#pragma once

#include <vector>

#include "core/isa.h"

namespace mallow {

/// Every instruction level that this machine has.
inline std::vector<InstructionLevel> levels() {
  std::vector<InstructionLevel> all;
  for (const auto level : {InstructionLevel::baseline, InstructionLevel::v3, InstructionLevel::v4})
    if (level <= best_instruction_level()) all.push_back(level);
  return all;
}

}  // namespace mallow
