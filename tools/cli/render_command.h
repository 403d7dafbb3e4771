#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow render DIR: takes the pictures of a cache again.
void add_render_command(CLI::App& app);

}  // namespace mallow::cli
