#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow surface DIR: draws the surfaces of a cache again.
void add_surface_command(CLI::App& app);

}  // namespace mallow::cli
