#include "sweep/point_runs.h"

#include <atomic>
#include <charconv>
#include <exception>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "mallow/errors.h"

namespace mallow::sweep {

std::vector<std::size_t> point_list(const std::string& text, std::size_t count) {
  const auto refuse = [&] {
    throw ConfigError("--point", "'" + text + "' is not allowed: points below " + std::to_string(count) +
                                     " as in 3 or 3,7,10:20");
  };
  const auto number = [&](const std::string& part) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (part.empty() || error != std::errc() || end != part.data() + part.size()) refuse();
    return value;
  };
  std::vector<std::size_t> points;
  std::set<std::size_t> seen;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t colon = part.find(':');
    const std::size_t begin = number(part.substr(0, colon));
    const std::size_t end = colon == std::string::npos ? begin + 1 : number(part.substr(colon + 1));
    if (begin >= end || end > count) refuse();
    for (std::size_t point = begin; point < end; ++point) {
      if (!seen.insert(point).second)
        throw ConfigError("--point", "'" + text + "' names point " + std::to_string(point) + " twice");
      points.push_back(point);
    }
  }
  if (points.empty()) refuse();
  return points;
}

std::vector<std::string> point_words(std::span<const std::size_t> points, std::size_t each) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % each == 0) words.emplace_back("--point=");
    words.back() += (i % each == 0 ? "" : ",") + std::to_string(points[i]);
  }
  return words;
}

void run_here(const SweepFolder& sweep, std::span<const std::size_t> points, int jobs, int threads,
              const std::function<void(std::size_t, const Outcome&)>& ran) {
  std::atomic<std::size_t> next = 0;
  std::mutex one_at_a_time;
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t i = next++; i < points.size(); i = next++) {
      try {
        const Outcome outcome = sweep.run(points[i], threads);
        const std::lock_guard lock(one_at_a_time);
        ran(points[i], outcome);
      } catch (...) {
        const std::lock_guard lock(one_at_a_time);
        if (!error) error = std::current_exception();
        next = points.size();
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int k = 1; k < jobs; ++k) workers.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace mallow::sweep
