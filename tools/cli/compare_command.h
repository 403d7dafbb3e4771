#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// `mallow compare`: how two runs or states differ.
void add_compare_command(CLI::App& app);

}  // namespace mallow::cli
