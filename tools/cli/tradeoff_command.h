#pragma once

namespace CLI {
class App;
}

namespace mallow::cli {

/// mallow tradeoff SCENE --budget 60s --out DIR
void add_tradeoff_command(CLI::App& app);
/// mallow tune SCENE --frame 16ms | --error 0.1h
void add_tune_command(CLI::App& app);

}  // namespace mallow::cli
