#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench threads`: what several threads cost beside other work, with every executor.
void add_threads_command(CLI::App& app);

}  // namespace mallow::bench
