#include "program/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <cstring>

namespace mallow::program {
namespace {

volatile std::sig_atomic_t asked_by = 0;

const char* volatile last_words = "";

void say(const char* words) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, words, std::strlen(words));
}

void end_at_once(int signal) {
  say("mallow: ");
  say(last_words);
  say("\n");
  ::_exit(128 + signal);
}

void ask_to_stop(int signal) {
  asked_by = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void end_at_interrupt(const char* words) {
  last_words = words;
  std::signal(SIGINT, end_at_once);
  std::signal(SIGTERM, end_at_once);
}

void watch_for_interrupt() {
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
}

int interrupted() {
  return asked_by;
}

}  // namespace mallow::program
