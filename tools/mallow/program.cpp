#include "mallow/program.h"

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "mallow/errors.h"
#include "mallow/failure.h"

#ifdef __linux__
#include <omp.h>
#include <sched.h>
#include <unistd.h>

#include <vector>
#endif

namespace mallow::cli {
namespace {

/// Turns of a waiting thread before it sleeps: about as long as the longest serial part of a step. By default
/// GNU's OpenMP waits 15 times as long, so that on a machine with something else to do threads that wait keep
/// those from running that they wait for: two threads took 50 times as long as one.
constexpr const char* k_spin_count = "20000";

#ifdef __linux__
/// With OMP_PROC_BIND this thread is on one processor before main begins; a program started from here would
/// take that for all there are.
void leave_place() {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> ids(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, ids.data());
    for (const int id : ids) CPU_SET(static_cast<std::size_t>(id), &processors);
  }
  if (CPU_COUNT(&processors) > 0) sched_setaffinity(0, sizeof processors, &processors);
}
#endif

/// OpenMP reads this when it is loaded, before any line of a program, so it takes another start. Where there
/// is none, threads wait as they are used to.
void limit_spinning([[maybe_unused]] char** argv) {
#ifdef __linux__
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY")) return;
  if (setenv("GOMP_SPINCOUNT", k_spin_count, 0) != 0) return;
  leave_place();
  execv("/proc/self/exe", argv);
#endif
}

int fail(const CLI::App& app, const std::exception& error, int exit_code) {
  std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
  return exit_code;
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv) {
  limit_spinning(argv);
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
