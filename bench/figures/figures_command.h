#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench figures`: what the paper's figures show, as claims that can fail.
void add_figures_command(CLI::App& app);

}  // namespace mallow::bench
