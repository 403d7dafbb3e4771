#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow view [SCENE]: a window to play with a scene in, by the program mallow-view beside this one.
void add_view_command(CLI::App& app);

}  // namespace mallow::cli
