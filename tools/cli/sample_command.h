#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow sample MESH: fills a closed mesh with points, as a scene would.
void add_sample_command(CLI::App& app);

}  // namespace mallow::cli
