#include "mallow/program.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "mallow/errors.h"
#include "mallow/failure.h"

namespace mallow::cli {
namespace {

int fail(const CLI::App& app, const std::exception& error, int exit_code) {
  std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
  return exit_code;
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv) {
  app.require_subcommand(0, 1);  // none is answered below, with the list of what there is
  try {
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
    return fail(app, error, k_exit_run_failed);
  } catch (const StepError& error) {
    return fail(app, error, k_exit_run_failed);
  } catch (const Error& error) {
    return fail(app, error, k_exit_bad_input);
  } catch (const std::exception& error) {
    return fail(app, error, k_exit_run_failed);
  }
}

}  // namespace mallow::cli
