#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "mallow/errors.h"
#include "mallow/failure.h"
#include "mallow/info_command.h"
#include "mallow/render_command.h"
#include "mallow/run_command.h"
#include "mallow/sample_command.h"
#include "mallow/scene.h"
#include "mallow/surface_command.h"

namespace {

using namespace mallow::cli;

int fail(const std::exception& error, int exit_code) {
  std::fprintf(stderr, "mallow: %s\n", error.what());
  return exit_code;
}

void add_commands(CLI::App& app) {
  add_run_command(app);
  add_info_command(app);
  add_sample_command(app);
  add_surface_command(app);
  add_render_command(app);
  app.add_subcommand("keys", "Print every key that a scene file may hold")->callback([] {
    std::fputs(mallow::describe_scene_keys().c_str(), stdout);
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("mallow: fast animation of viscoelastic materials", "mallow");
  app.set_version_flag("--version", MALLOW_VERSION);
  app.require_subcommand(0, 1);  // none is answered below, with the list of what there is
  app.footer("Exit codes: 0 done, 1 a run failed on the way, 2 the input cannot be used.");
  try {
    add_commands(app);
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      std::fputs(app.help().c_str(), stderr);
      return k_exit_bad_input;
    }
    // A full disk behind a redirected stdout shows only here.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw RunFailure("standard output cannot be written");
    return k_exit_done;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? k_exit_done : k_exit_bad_input;
  } catch (const RunFailure& error) {
    return fail(error, k_exit_run_failed);
  } catch (const mallow::StepError& error) {
    return fail(error, k_exit_run_failed);
  } catch (const mallow::Error& error) {
    return fail(error, k_exit_bad_input);
  } catch (const std::exception& error) {
    return fail(error, k_exit_run_failed);
  }
}
