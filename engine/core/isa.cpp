#include "core/isa.h"

#include "core/port.h"

namespace mallow {

const char* name(InstructionLevel level) {
  switch (level) {
    case InstructionLevel::v4:
      return "x86-64-v4";
    case InstructionLevel::v3:
      return "x86-64-v3";
    case InstructionLevel::baseline:
#ifdef MALLOW_X86_LEVELS
      return "x86-64-v2";
#else
      return "baseline";
#endif
  }
  return "no instruction level";
}

InstructionLevel best_instruction_level() {
  if (machine_has(InstructionLevel::v4)) return InstructionLevel::v4;
  if (machine_has(InstructionLevel::v3)) return InstructionLevel::v3;
  return InstructionLevel::baseline;
}

}  // namespace mallow
