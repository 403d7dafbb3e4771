#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>

#include "program/failure.h"

namespace mallow::program {

/// The option of a command that `typed` was meant to be, with its dashes: one that begins and ends alike, but
/// for a third of it. Empty where none does.
inline std::string nearest_option(const CLI::App& command, const std::string& typed) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, typed.size() / 3) + 1;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& long_name : option->get_lnames()) {
      const std::string name = "--" + long_name;
      const std::size_t most = std::min(name.size(), typed.size());
      const auto head = static_cast<std::size_t>(
          std::mismatch(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(most), typed.begin()).first -
          name.begin());
      const auto tail = static_cast<std::size_t>(
          std::mismatch(name.rbegin(), name.rbegin() + static_cast<std::ptrdiff_t>(most - head),
                        typed.rbegin())
              .first -
          name.rbegin());
      const std::size_t odd = std::max(name.size(), typed.size()) - head - tail;
      if (odd >= least) continue;
      least = odd;
      nearest = name;
    }
  return nearest;
}

/// What a command line has too much, with the options that were meant.
inline CLI::ParseError name_nearest(const CLI::App& app, const CLI::ExtrasError& error) {
  std::string text = error.what();
  for (const CLI::App* command : app.get_subcommands())
    for (const std::string& typed : command->remaining())
      if (typed.starts_with("--"))
        if (const std::string meant = nearest_option(*command, typed.substr(0, typed.find('=')));
            !meant.empty())
          text += "; did you mean " + meant + "?";
  return {text, CLI::ExitCodes::ExtrasError};
}

/// main() of a program with commands, which run as they are parsed. Without one it prints its help.
inline int parse_and_run(CLI::App& app, int argc, char** argv) {
  return run_main(app.get_name(), [&] {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ExtrasError& error) {
      app.exit(name_nearest(app, error));
      return k_exit_bad_input;
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? k_exit_done : k_exit_bad_input;
    }
    if (!app.get_subcommands().empty()) return k_exit_done;
    std::fputs(app.help().c_str(), stderr);
    return k_exit_bad_input;
  });
}

}  // namespace mallow::program
