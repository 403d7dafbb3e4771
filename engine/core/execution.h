#pragma once

#include "core/threads.h"
#include "mallow/instruction_level.h"

namespace mallow {

/// How loops over many particles run: on which threads, with which instructions. Neither changes a bit of
/// what comes out.
///
/// A function takes Execution where its loops run lanes; Threads alone where they run none, or, as in
/// surface, always the best that there are; an InstructionLevel alone where it picks lanes and runs no loop
/// on threads.
struct Execution {
  Threads threads = 1;
  InstructionLevel level = InstructionLevel::baseline;
};

}  // namespace mallow
