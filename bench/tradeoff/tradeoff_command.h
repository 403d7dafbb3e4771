#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench tradeoff`: what every knob costs and what it buys, on four scenes.
void add_tradeoff_command(CLI::App& app);

}  // namespace mallow::bench
