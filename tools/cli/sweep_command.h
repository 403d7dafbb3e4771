#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// `mallow sweep`: many runs of one scene, and their table.
void add_sweep_command(CLI::App& app);

}  // namespace mallow::cli
