#include "sweep/series_measures.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <vector>

#include "mallow/errors.h"
#include "program/csv.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

/// Of a column: one of its values, or their mean.
std::optional<double> value_of(const std::vector<double>& column, Measure::Of of) {
  if (column.empty()) return std::nullopt;
  switch (of) {
    case Measure::Of::least:
      return *std::ranges::min_element(column);
    case Measure::Of::most:
      return *std::ranges::max_element(column);
    case Measure::Of::mean: {
      double sum = 0;
      for (const double value : column) sum += value;
      return sum / static_cast<double>(column.size());
    }
    case Measure::Of::last:
      break;
  }
  return column.back();
}

}  // namespace

std::map<std::string, double> measure_series(const SweepSpec& spec, const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<std::string> names = program::csv_cells(line);
  for (std::string& column : names) column = column.substr(0, column.find(" ["));
  std::vector<std::vector<double>> columns(names.size());
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = program::csv_cells(line);
    for (std::size_t c = 0; c < std::min(cells.size(), names.size()); ++c)
      if (const auto value = number_of(cells[c])) columns[c].push_back(*value);
  }
  std::map<std::string, double> measured;
  std::vector<Problem> problems;
  for (const Measure& measure : spec.measures) {
    const auto found = std::ranges::find(names, measure.column);
    if (found == names.end()) {
      std::string all;
      for (const std::string& column : names) all += (all.empty() ? "" : ", ") + column;
      problems.push_back({spec.file.string(), measure.place.line, measure.place.column, "measures",
                          "'" + measure.name +
                              "' is no column of a series, nor one with .last, .min, .max or "
                              ".mean behind it; there are " +
                              all});
      continue;
    }
    if (const auto value = value_of(columns[static_cast<std::size_t>(found - names.begin())], measure.of))
      measured[measure.name] = *value;
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return measured;
}

}  // namespace mallow::sweep
