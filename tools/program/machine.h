#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

namespace mallow::program {

/// The machine as reports name it: processor, cores, memory.
nlohmann::ordered_json machine_json();

/// Memory that can be had without swapping [bytes]; 0 where the system does not say.
std::size_t available_memory();

/// Threads that a command line's 0 stands for: all the machine has.
int resolve_threads(int threads);

}  // namespace mallow::program
