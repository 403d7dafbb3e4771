#include "program/machine.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

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

/// A line of /proc/meminfo [bytes]; 0 where there is none.
std::size_t memory(const std::string& name) {
  std::ifstream file("/proc/meminfo");
  for (std::string key; file >> key;) {
    std::size_t kibibytes = 0;
    if (key == name + ":" && file >> kibibytes) return 1024 * kibibytes;
    std::getline(file, key);
  }
  return 0;
}

}  // namespace

nlohmann::ordered_json machine_json() {
  return {{"processor", processor_name()},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_gib", static_cast<double>(memory("MemTotal") >> 20) / 1024}};
}

std::size_t available_memory() {
  return memory("MemAvailable");
}

int resolve_threads(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace mallow::program
