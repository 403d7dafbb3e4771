#include "cli/view_command.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "program/failure.h"

namespace mallow::cli {
namespace {

constexpr const char* k_program = "mallow-view";

/// The program takes the place of this one; it is looked for beside it, then on the PATH.
[[noreturn]] void start_viewer(std::vector<std::string> arguments) {
  std::error_code unknown;
  const std::filesystem::path beside =
      std::filesystem::read_symlink("/proc/self/exe", unknown).replace_filename(k_program);
  arguments.insert(arguments.begin(), k_program);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ::execv(beside.c_str(), argv.data());
  ::execvp(k_program, argv.data());
  throw program::RunFailure(
      "the viewer is not part of this build: it needs GLFW, Dear ImGui and libepoxy (Debian: libglfw3-dev "
      "libimgui-dev libepoxy-dev), and a new build after they were installed");
}

}  // namespace

void add_view_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("view", "Play with a scene in a window; without one, a gallery");
  command->prefix_command();
  command->set_help_flag();  // it is the viewer's
  command->callback([command] { start_viewer(command->remaining()); });
}

}  // namespace mallow::cli
