#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench stability`: settings turned to the stop, and what becomes of the motion.
void add_stability_command(CLI::App& app);

}  // namespace mallow::bench
