#include <CLI/CLI.hpp>
#include <cstdio>

#include "mallow/export_command.h"
#include "mallow/info_command.h"
#include "mallow/program.h"
#include "mallow/render_command.h"
#include "mallow/run_command.h"
#include "mallow/sample_command.h"
#include "mallow/scene.h"
#include "mallow/surface_command.h"
#include "mallow/version.h"

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): CLI11 throws where two options clash
  using namespace mallow::cli;
  CLI::App app("mallow: fast animation of viscoelastic materials", "mallow");
  app.set_version_flag("--version", mallow::version());
  app.footer("Exit codes: 0 done, 1 the run failed, 2 the input is wrong.");
  add_run_command(app);
  add_info_command(app);
  add_sample_command(app);
  add_surface_command(app);
  add_render_command(app);
  add_export_command(app);
  app.add_subcommand("keys", "Print every key that a scene file may hold")->callback([] {
    std::fputs(mallow::describe_scene_keys().c_str(), stdout);
  });
  return run_program(app, argc, argv);
}
