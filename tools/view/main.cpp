#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include "mallow/errors.h"
#include "mallow/version.h"
#include "program/failure.h"
#include "program/threads_option.h"
#include "view/gallery.h"
#include "view/script.h"
#include "view/viewer.h"

namespace {

/// The scenes that the gallery shows where nothing else is said: those beside, or of the project's folder.
std::filesystem::path default_scenes() {
  const std::filesystem::path beside = "data/scenes";
  return std::filesystem::is_directory(beside) ? beside : std::filesystem::path(MALLOW_DATA_DIR) / "scenes";
}

/// One processor is left to the window, where there are several.
int default_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
}

int play(const mallow::view::ViewerOptions& options, const std::filesystem::path& script_file) {
  mallow::view::Viewer viewer(options);
  std::unique_ptr<mallow::view::Script> script;
  if (!script_file.empty()) script = std::make_unique<mallow::view::Script>(script_file);
  while (viewer.is_open()) {
    viewer.draw_next(!script || script->may_wait());
    if (script && !script->advance(viewer)) break;
  }
  return mallow::program::k_exit_done;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): CLI11 throws where two options clash
  using namespace mallow;
  CLI::App app("Play with a scene: grab it, throw balls at it, turn its settings", "mallow view");
  view::ViewerOptions options;
  options.threads = default_threads();
  std::filesystem::path script;
  std::string scene, scenes = default_scenes().string();
  app.set_version_flag("--version", mallow::version());
  app.add_option("scene", scene,
                 "Scene file, or a folder that mallow run or the viewer saved; none: a gallery")
      ->type_name("SCENE");
  app.add_option("--set", options.overrides, "Change a setting, as section.key=value")
      ->type_name("KEY=VALUE");
  const CLI::Option* const chosen_scenes =
      app.add_option("--scenes", scenes, "Folder of scenes that the gallery shows")->type_name("DIR");
  program::add_threads_option(
      app, options.threads,
      "Threads of the simulation; left out: all but one, and fewer beside other programs", 1);
  app.add_option("--samples", options.samples, "Samples a pixel; 0: 4, or 1 where no graphics card draws")
      ->check(CLI::Range(0, 16));
  app.add_option("--width", options.window.width, "Of the window, pixels")->check(CLI::Range(64, 16384));
  app.add_option("--height", options.window.height, "Of the window, pixels")->check(CLI::Range(64, 16384));
  app.add_flag("--paused", options.paused, "Stand still at the start");
  app.add_option("--script", script, "Play by a text in place of a hand")->group("");
  return program::run_main("mallow view", [&] {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? program::k_exit_done : program::k_exit_bad_input;
    }
    options.lowers_threads = app.count("--threads") == 0;
    options.scene = scene;
    options.scenes = scenes;
    options.window.wait_for_screen = script.empty();
    if (scene.empty() || chosen_scenes->count() > 0) view::check_scenes(options.scenes, "--scenes");
    return play(options, script);
  });
}
