#include "core/isa.h"

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
#ifdef MALLOW_X86_LEVELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return InstructionLevel::v4;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return InstructionLevel::v3;
#endif
  return InstructionLevel::baseline;
}

}  // namespace mallow
