// Which points a sweep has. All chance comes from the seed, by generators that are the same everywhere.
#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <fstream>
#include <random>

#include "mallow/errors.h"
#include "program/csv.h"
#include "sweep/sweep_spec.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace {

/// What stands at a share of the way through a key's values, in [0, 1).
std::string value_at(const Vary& vary, double share) {
  if (!vary.values.empty()) {
    const auto at = static_cast<std::size_t>(share * static_cast<double>(vary.values.size()));
    return vary.values[std::min(at, vary.values.size() - 1)];
  }
  if (vary.whole && !vary.logarithmic) {
    const double count = vary.to - vary.from + 1;
    return number_text(vary.from + std::min(std::floor(share * count), count - 1));
  }
  if (vary.logarithmic) {
    const double value = vary.from * std::pow(vary.to / vary.from, share);
    return number_text(vary.whole ? std::round(value) : value);
  }
  return number_text(vary.from + share * (vary.to - vary.from));
}

/// Value k of a key in a grid; the ends of a range are in it.
std::string grid_value(const Vary& vary, int k) {
  if (!vary.values.empty()) return vary.values[static_cast<std::size_t>(k)];
  const int count = *vary.count;
  const double share = count > 1 ? static_cast<double>(k) / (count - 1) : 0;
  if (k + 1 == count && count > 1) return number_text(vary.to);
  const double value = vary.logarithmic ? vary.from * std::pow(vary.to / vary.from, share)
                                        : vary.from + share * (vary.to - vary.from);
  return number_text(vary.whole ? std::round(value) : value);
}

using Points = std::vector<std::vector<std::string>>;

/// The last key turns fastest.
Points grid(const std::vector<Vary>& keys) {
  Points points{{}};
  for (const Vary& vary : keys) {
    const int count = vary.values.empty() ? *vary.count : static_cast<int>(vary.values.size());
    Points next;
    for (const std::vector<std::string>& point : points)
      for (int k = 0; k < count; ++k) {
        next.push_back(point);
        next.back().push_back(grid_value(vary, k));
      }
    points = std::move(next);
  }
  return points;
}

/// In [0, 1), by 53 bits: std's distributions differ from library to library.
double unit(std::mt19937_64& chance) {
  return static_cast<double>(chance() >> 11) * 0x1p-53;
}

Points random_points(const SweepSpec& spec) {
  std::mt19937_64 chance(spec.seed);
  Points points(static_cast<std::size_t>(spec.points));
  for (std::vector<std::string>& point : points)
    for (const Vary& vary : spec.vary) point.push_back(value_at(vary, unit(chance)));
  return points;
}

/// Each key has one point in each of as many equal parts as there are points. [McKay 1979]
Points latin_hypercube(const SweepSpec& spec) {
  std::mt19937_64 chance(spec.seed);
  const auto count = static_cast<std::size_t>(spec.points);
  Points points(count);
  std::vector<std::size_t> part(count);
  for (const Vary& vary : spec.vary) {
    for (std::size_t i = 0; i < count; ++i) part[i] = i;
    for (std::size_t i = count; i > 1; --i)
      std::swap(part[i - 1], part[static_cast<std::size_t>(unit(chance) * static_cast<double>(i))]);
    for (std::size_t i = 0; i < count; ++i)
      points[i].push_back(
          value_at(vary, (static_cast<double>(part[i]) + unit(chance)) / static_cast<double>(count)));
  }
  return points;
}

/// [Sobol 1967, directions of Joe & Kuo 2008], by Boost, without its first point, 0.
Points sobol(const SweepSpec& spec) {
  boost::random::sobol sequence(spec.vary.size());
  const double range = static_cast<double>(boost::random::sobol::max()) + 1;
  sequence.discard(spec.vary.size() * (spec.seed - (spec.seed > 0 ? 1 : 0)));
  Points points(static_cast<std::size_t>(spec.points));
  for (std::vector<std::string>& point : points)
    for (const Vary& vary : spec.vary)
      point.push_back(value_at(vary, static_cast<double>(sequence()) / range));
  return points;
}

Points points_of_file(SweepSpec& spec) {
  const std::string name = spec.points_file.string();
  std::ifstream file(spec.points_file);
  std::string line;
  if (!file || !std::getline(file, line))
    throw IoError({name, 0, 0, "points_file", "cannot be read, or is empty"});
  if (constexpr const char* k_mark = "\xEF\xBB\xBF"; line.starts_with(k_mark)) line.erase(0, 3);  // of UTF-8
  for (const std::string& key : program::csv_cells(line)) {
    if (std::ranges::count(spec.vary, key, &Vary::key))
      throw ConfigError({{name, 1, 0, "points_file", "has '" + key + "' twice"}});
    spec.vary.emplace_back().key = key;
  }
  Points points;
  std::vector<Problem> problems;
  for (int number = 2; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    points.push_back(program::csv_cells(line));
    if (points.back().size() != spec.vary.size() || std::ranges::count(points.back(), ""))
      problems.push_back({name, number, 0, "points_file",
                          "has " + std::to_string(points.back().size()) + " values, where the header names " +
                              std::to_string(spec.vary.size())});
  }
  if (points.empty() && problems.empty()) problems.push_back({name, 0, 0, "points_file", "has no points"});
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return points;
}

}  // namespace

std::vector<std::vector<std::string>> sample_points(SweepSpec& spec) {
  if (!spec.points_file.empty()) return points_of_file(spec);
  switch (spec.method) {
    case Method::random:
      return random_points(spec);
    case Method::latin_hypercube:
      return latin_hypercube(spec);
    case Method::sobol:
      return sobol(spec);
    case Method::grid:
      break;
  }
  return grid(spec.vary);
}

}  // namespace mallow::sweep
