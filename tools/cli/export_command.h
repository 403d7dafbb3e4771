#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow export DIR: writes the frames of a cache for other programs.
void add_export_command(CLI::App& app);

}  // namespace mallow::cli
