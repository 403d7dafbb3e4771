#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/compare_command.h"
#include "cli/export_command.h"
#include "cli/info_command.h"
#include "cli/materials_command.h"
#include "cli/render_command.h"
#include "cli/run_command.h"
#include "cli/sample_command.h"
#include "cli/surface_command.h"
#include "cli/sweep_command.h"
#include "cli/view_command.h"
#include "cli/tradeoff_command.h"
#include "mallow/scene.h"
#include "mallow/version.h"
#include "program/parse_and_run.h"

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): CLI11 throws where two options clash
  using namespace mallow::cli;
  CLI::App app("mallow: fast animation of viscoelastic materials", "mallow");
  app.set_version_flag("--version", mallow::version());
  app.footer("Exit codes: 0 done, 1 the run failed, 2 the input is wrong, 130 Ctrl-C ended it, 143 SIGTERM.");
  add_run_command(app);
  add_info_command(app);
  add_sample_command(app);
  add_materials_command(app);
  add_surface_command(app);
  add_render_command(app);
  add_export_command(app);
  add_compare_command(app);
  add_sweep_command(app);
  add_view_command(app);
  add_tradeoff_command(app);
  add_tune_command(app);
  app.add_subcommand("keys", "Print every key that a scene file may hold")->callback([] {
    std::fputs(mallow::describe_scene_keys().c_str(), stdout);
  });
  app.require_subcommand(0, 1);  // none is answered below, with the list of what there is
  return mallow::program::parse_and_run(app, argc, argv);
}
