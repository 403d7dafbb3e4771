#include "program/interrupt.h"

#include <csignal>

namespace mallow::program {
namespace {

volatile std::sig_atomic_t asked_by = 0;

void ask_to_stop(int signal) {
  asked_by = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void watch_for_interrupt() {
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
}

int interrupted() {
  return asked_by;
}

}  // namespace mallow::program
