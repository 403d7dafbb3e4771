#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "figures/figures_command.h"
#include "kernels/kernels_command.h"
#include "mallow/errors.h"
#include "mallow/failure.h"
#include "scaling/scaling_command.h"
#include "table1/table1_command.h"
#include "tradeoff/tradeoff_command.h"

namespace {

using namespace mallow;

int fail(const std::exception& error, int exit_code) {
  std::fprintf(stderr, "mallow-bench: %s\n", error.what());
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("mallow-bench: what mallow costs and how right it is", "mallow-bench");
  app.set_version_flag("--version", MALLOW_VERSION);
  app.require_subcommand(0, 1);  // none is answered below, with the list of what there is
  app.footer("Exit codes: 0 done, 1 a run failed or a claim does not hold, 2 the input cannot be used.");
  try {
    bench::add_table1_command(app);
    bench::add_tradeoff_command(app);
    bench::add_scaling_command(app);
    bench::add_kernels_command(app);
    bench::add_figures_command(app);
    app.parse(argc, argv);
    if (!app.get_subcommands().empty()) return cli::k_exit_done;
    std::fputs(app.help().c_str(), stderr);
    return cli::k_exit_bad_input;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::k_exit_done : cli::k_exit_bad_input;
  } catch (const cli::RunFailure& error) {
    return fail(error, cli::k_exit_run_failed);
  } catch (const StepError& error) {
    return fail(error, cli::k_exit_run_failed);
  } catch (const Error& error) {
    return fail(error, cli::k_exit_bad_input);
  } catch (const std::exception& error) {
    return fail(error, cli::k_exit_run_failed);
  }
}
