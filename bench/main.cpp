#include <CLI/CLI.hpp>

#include "drift/drift_command.h"
#include "figures/figures_command.h"
#include "kernels/kernels_command.h"
#include "mallow/version.h"
#include "materials/materials_command.h"
#include "program/parse_and_run.h"
#include "scaling/scaling_command.h"
#include "stability/stability_command.h"
#include "table1/table1_command.h"
#include "threads/threads_command.h"
#include "tradeoff/tradeoff_command.h"

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): CLI11 throws where two options clash
  using namespace mallow::bench;
  CLI::App app("mallow-bench: what mallow costs and how right it is", "mallow-bench");
  app.set_version_flag("--version", mallow::version());
  app.footer("Exit codes: 0 done, 1 a run failed or a claim does not hold, 2 the input cannot be used.");
  add_table1_command(app);
  add_tradeoff_command(app);
  add_scaling_command(app);
  add_kernels_command(app);
  add_figures_command(app);
  add_stability_command(app);
  add_drift_command(app);
  add_threads_command(app);
  add_materials_command(app);
  app.require_subcommand(0, 1);  // none is answered below, with the list of what there is
  return mallow::program::parse_and_run(app, argc, argv);
}
