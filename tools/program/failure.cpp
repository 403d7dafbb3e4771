#include "program/failure.h"

#include <cstdio>
#include <exception>

#include "mallow/errors.h"

namespace mallow::program {
namespace {

int exit_code(const std::exception& error) {
  if (const auto* const told = dynamic_cast<const Interrupted*>(&error)) return told->exit_code;
  const bool in_step = dynamic_cast<const StepError*>(&error);
  return dynamic_cast<const Error*>(&error) && !in_step ? k_exit_bad_input : k_exit_run_failed;
}

}  // namespace

int run_main(const std::string& name, const std::function<int()>& work) {
  try {
    const int code = work();
    // A full disk behind a redirected stdout shows only here.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw RunFailure("standard output cannot be written");
    return code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return exit_code(error);
  }
}

}  // namespace mallow::program
