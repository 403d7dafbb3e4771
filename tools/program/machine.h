#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace mallow::program {

/// The machine as reports name it: processor, cores, memory.
nlohmann::ordered_json machine_json();

/// Memory that can be had without swapping [bytes]; 0 where the system does not say.
std::size_t available_memory();

/// A line of a file of the system's in /proc that counts kB [bytes]; 0 where there is none.
std::size_t proc_bytes(const char* file, const std::string& line);

/// Threads that a run may have, at most.
int most_threads();

/// Processors that this process may use: those of its slot where Slurm gave it one, else those that the
/// system lets it run on.
int own_processors();

/// Threads that a command line's 0 stands for: own_processors().
int resolve_threads(int threads);

}  // namespace mallow::program
