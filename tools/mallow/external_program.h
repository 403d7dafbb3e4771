#pragma once

#include <string>
#include <vector>

namespace mallow::cli {

/// Whether a program is found on the PATH.
bool is_installed(const std::string& program);

/// Runs a program without a shell and waits for it; gives its exit status. Throws RunFailure where it cannot
/// be started.
int run_program(std::vector<std::string> arguments);

}  // namespace mallow::cli
