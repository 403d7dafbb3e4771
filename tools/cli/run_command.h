#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow run SCENE: simulates, and writes what is asked for.
void add_run_command(CLI::App& app);

}  // namespace mallow::cli
