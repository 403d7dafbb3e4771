#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench table1`: the paper's Table 1, ours beside it.
void add_table1_command(CLI::App& app);

}  // namespace mallow::bench
