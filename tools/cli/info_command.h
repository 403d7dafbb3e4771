#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow info SCENE: what would run.
void add_info_command(CLI::App& app);

}  // namespace mallow::cli
