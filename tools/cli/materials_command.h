#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// `mallow materials`: what scenes know by name.
void add_materials_command(CLI::App& app);

}  // namespace mallow::cli
