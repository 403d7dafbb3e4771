#include "cli/messages.h"

#include <cstdio>

#include "mallow/errors.h"

namespace mallow::cli {

void print_warning(const std::string& warning) {
  if (!warning.empty()) std::fprintf(stderr, "mallow: warning: %s\n", warning.c_str());
}

void print_notes(std::span<const std::string> notes) {
  // Names of files are in them, which to_string() makes fit for a terminal.
  for (const std::string& note : notes) print_warning(to_string(Problem{.message = note}));
}

void print_warnings(const Scene& scene, const SimulationInfo& info) {
  for (const std::string& warning : warnings(scene, info)) print_warning(warning);
}

}  // namespace mallow::cli
