#pragma once

namespace CLI {
class App;
}

namespace mallow::bench {

/// `mallow-bench materials`: does a material do what its numbers say? Bars beside the theory of beams, and
/// what each material by name does in the scenes of data/scenes/standard, at two spacings.
void add_materials_command(CLI::App& app);

}  // namespace mallow::bench
