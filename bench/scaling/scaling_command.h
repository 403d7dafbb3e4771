#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench scaling`: time and memory of cubes of a thousand to millions of particles, on one thread and
/// on several.
void add_scaling_command(CLI::App& app);

}  // namespace mallow::bench
