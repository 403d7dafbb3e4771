#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mallow::program {

/// Whether a program is found on the PATH.
bool is_installed(const std::string& program);

/// Runs a program in a folder, without a shell, and waits for it; gives its exit status. Names of files in
/// that folder need no path then, which could hold what means something to the program: '%', quotes, '-' at
/// the beginning. Throws RunFailure where it cannot be started.
int run_program(std::vector<std::string> arguments, const std::filesystem::path& folder);
/// What becomes of it where this program is asked to end.
enum class AtEnd {
  end,        ///< it is asked too
  end_tasks,  ///< it is asked twice: GNU parallel lets its tasks run on at the first time
  wait,       ///< it is waited for
};
/// The same here, with all that it says in a file. kept: a descriptor that it gets, and with it a lock that
/// stays until it ends, whatever becomes of this process.
int run_logged(std::vector<std::string> arguments, const std::filesystem::path& log,
               AtEnd at_end = AtEnd::end, std::optional<int> kept = {});

}  // namespace mallow::program
