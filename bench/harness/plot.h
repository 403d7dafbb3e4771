#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mallow::bench {

/// Points of one name in a plot.
struct Series {
  std::string title;
  std::vector<std::pair<double, double>> points;
  std::vector<std::string> labels = {};  ///< of each point; empty: none
  bool lines = true;                     ///< joined in their order
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
  int width = 900, height = 560;  ///< [pixels]
};

/// Draws a plot as SVG with the program gnuplot. Where that is not installed, says so on stderr and draws
/// none.
void write_svg(const std::filesystem::path& file, const Plot& plot);

/// Bars in groups, on a logarithmic axis. values[s][g]: of series s in group g, > 0.
struct BarChart {
  std::string title, y_label;
  std::vector<std::string> groups, series;
  std::vector<std::vector<double>> values;
};
void write_svg(const std::filesystem::path& file, const BarChart& chart);

}  // namespace mallow::bench
