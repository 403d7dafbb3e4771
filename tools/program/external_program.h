#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mallow::program {

/// Whether a program is found on the PATH.
bool is_installed(const std::string& program);

/// Runs a program in a folder, without a shell, and waits for it; gives its exit status. Names of files in
/// that folder need no path then, which could hold what means something to the program: '%', quotes, '-' at
/// the beginning. Throws RunFailure where it cannot be started.
int run_program(std::vector<std::string> arguments, const std::filesystem::path& folder);
/// The same here, with all that it says in a file. Where this program is asked to end, so is that one.
int run_logged(std::vector<std::string> arguments, const std::filesystem::path& log);

}  // namespace mallow::program
