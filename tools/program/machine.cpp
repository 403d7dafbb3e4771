#include "program/machine.h"

#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "config/field_tables.h"

namespace mallow::program {
namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(':');
    if (line.starts_with("model name") && colon + 2 < line.size()) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

nlohmann::ordered_json machine_json() {
  return {{"processor", processor_name()},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_gib", static_cast<double>(proc_bytes("/proc/meminfo", "MemTotal") >> 20) / 1024}};
}

std::size_t available_memory() {
  return proc_bytes("/proc/meminfo", "MemAvailable");
}

int most_threads() {
  return static_cast<int>(range_of(&SolverConfig::threads).highest);
}

int own_processors() {
  cpu_set_t allowed;
  const bool is_known = ::sched_getaffinity(0, sizeof allowed, &allowed) == 0;
  const int processors =
      std::max(1, is_known ? CPU_COUNT(&allowed) : static_cast<int>(std::thread::hardware_concurrency()));
  // --cpus-per-task where the job asked for it; else what the job has of this machine.
  for (const char* name : {"SLURM_CPUS_PER_TASK", "SLURM_CPUS_ON_NODE"}) {
    const char* text = std::getenv(name);
    if (const int count = text ? std::atoi(text) : 0; count > 0) return std::min(count, processors);
  }
  return processors;
}

int resolve_threads(int threads) {
  return threads > 0 ? threads : own_processors();
}

std::size_t proc_bytes(const char* file, const std::string& line) {
  std::ifstream lines(file);
  for (std::string key; lines >> key;) {
    std::size_t kibibytes = 0;
    if (key == line + ":" && lines >> kibibytes) return 1024 * kibibytes;
    std::getline(lines, key);
  }
  return 0;
}

}  // namespace mallow::program
