#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// A whole program: parses the command line, which calls the command that it names, says on standard error
/// what went wrong, and returns the exit code of failure.h.
int run_program(CLI::App& app, int argc, char** argv);

}  // namespace mallow::cli
