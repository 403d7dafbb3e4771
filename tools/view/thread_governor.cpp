#include "view/thread_governor.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <string>

#include "program/machine.h"

namespace mallow::view {
namespace {

/// A busy moment is none yet, and what was just given up is not taken back at once: looks in a row.
constexpr int k_until_lower = 2, k_until_higher = 4;
/// A processor counts as free where others take less than this of it: the system itself is always at work.
constexpr double k_little = 0.4;

/// Time that all processors have worked for anybody [s]; nothing where the system does not say.
double busy_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft_interrupts = 0,
         stolen = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >> stolen))
    return 0;
  return (user + nice + system + interrupts + soft_interrupts + stolen) /
         static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

bool ThreadGovernor::add_look(double free) {
  const int wanted = std::clamp(static_cast<int>(std::floor(free + k_little)), 1, most_);
  looks_below_ = wanted < threads_ ? looks_below_ + 1 : 0;
  looks_above_ = wanted > threads_ ? looks_above_ + 1 : 0;
  if (looks_below_ < k_until_lower && looks_above_ < k_until_higher) return false;
  threads_ = wanted;
  looks_below_ = looks_above_ = 0;
  return true;
}

double ProcessorLoad::look() {
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  const double own = static_cast<double>(std::clock()) / CLOCKS_PER_SEC, busy = busy_seconds();
  const double others = busy > 0 && wall > wall_ ? (busy - busy_ - (own - own_)) / (wall - wall_) : 0;
  busy_ = busy;
  own_ = own;
  wall_ = wall;
  const auto all = static_cast<double>(sysconf(_SC_NPROCESSORS_ONLN));
  return std::min<double>(program::own_processors(), all - std::max(0.0, others));
}

}  // namespace mallow::view
