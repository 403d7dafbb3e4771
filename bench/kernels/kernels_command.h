#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench kernels`: the parts of a step and of a surface by themselves, in nanoseconds per neighbour,
/// matrix, pair or leaf.
void add_kernels_command(CLI::App& app);

}  // namespace mallow::bench
