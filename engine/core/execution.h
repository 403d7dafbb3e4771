#pragma once

#include "core/threads.h"
#include "mallow/instruction_level.h"

namespace mallow {

/// How loops over many particles run: on which threads, with which instructions. Neither changes a bit of
/// what comes out.
struct Execution {
  Threads threads = 1;
  InstructionLevel level = InstructionLevel::baseline;
};

}  // namespace mallow
