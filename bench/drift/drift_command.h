#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench drift`: how far the engine's single precision leads from double precision in many steps.
void add_drift_command(CLI::App& app);

}  // namespace mallow::bench
