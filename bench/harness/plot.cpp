#include "harness/plot.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "mallow/files.h"
#include "program/external_program.h"
#include "program/failure.h"

namespace mallow::bench {
namespace {

/// A string of gnuplot's, in which nothing is special.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

/// The same as a field of inline data.
std::string field(std::string text) {
  for (char& c : text)
    if (c == '"') c = '\'';
  return '"' + text + '"';
}

void run_gnuplot(const std::filesystem::path& svg, int width, int height, const std::string& commands) {
  if (!program::is_installed("gnuplot")) {
    std::fprintf(stderr, "mallow-bench: no %s, because the program gnuplot is not installed\n", svg.c_str());
    return;
  }
  write_whole(svg, [&](const std::filesystem::path& beside) {
    std::ostringstream script;
    // svg: fonts of whatever shows it; noenhanced: an underscore is an underscore.
    script << "set terminal svg size " << width << ',' << height
           << " noenhanced background rgb 'white' font 'Helvetica,13'\nset output "
           << quoted(beside.filename().string()) << '\n'
           << commands;
    const std::filesystem::path file = beside.string() + ".gp";
    write_whole(file, script.str());
    const int status = program::run_program({"gnuplot", file.filename().string()}, file.parent_path());
    std::filesystem::remove(file);
    if (status != 0) throw program::RunFailure("gnuplot failed with exit status " + std::to_string(status));
  });
}

}  // namespace

void write_svg(const std::filesystem::path& file, const Plot& plot) {
  std::ostringstream text;
  text << "set title " << quoted(plot.title) << "\nset xlabel " << quoted(plot.x_label) << "\nset ylabel "
       << quoted(plot.y_label)
       << "\nset grid\nset autoscale noextend\nset key outside right top\nset offsets graph 0.05, graph "
          "0.12, graph 0.05, graph "
          "0.05\n";
  if (plot.log_x) text << "set logscale x\n";
  if (plot.log_y) text << "set logscale y\n";
  const auto drawable = [&](double x, double y) {
    return std::isfinite(x) && std::isfinite(y) && (!plot.log_x || x > 0) && (!plot.log_y || y > 0);
  };
  std::vector<std::string> curves;
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const Series& series = plot.series[s];
    std::size_t drawn = 0;
    text << "$data" << s << " << EOD\n";
    for (std::size_t k = 0; k < series.points.size(); ++k) {
      const auto [x, y] = series.points[k];
      if (!drawable(x, y)) continue;
      ++drawn;
      text << x << ' ' << y << ' ' << field(k < series.labels.size() ? series.labels[k] : "") << '\n';
    }
    text << "EOD\n";
    if (drawn == 0) continue;
    const std::string data = "$data" + std::to_string(s);
    const std::string color = " lc " + std::to_string(s + 1);
    curves.push_back(data + " using 1:2 with " + (series.lines ? "linespoints" : "points") + color +
                     " pt 7 ps 0.6 title " + quoted(series.title));
    if (!series.labels.empty())
      curves.push_back(data + " using 1:2:3 with labels left offset 0.6,0.25 font ',8' tc lt " +
                       std::to_string(s + 1) + " notitle");
  }
  if (curves.empty()) return;
  for (std::size_t c = 0; c < curves.size(); ++c) text << (c == 0 ? "plot " : ", \\\n  ") << curves[c];
  text << '\n';
  run_gnuplot(file, plot.width, plot.height, text.str());
}

void write_svg(const std::filesystem::path& file, const BarChart& chart) {
  std::ostringstream text;
  text << "set title " << quoted(chart.title) << "\nset ylabel " << quoted(chart.y_label)
       << "\nset logscale y\nset grid y\nset style data histogram\nset style histogram clustered gap 1\n"
          "set style fill solid 0.85 border -1\nset xtics rotate by -35\nset key outside right top\n$data << "
          "EOD\n";
  for (std::size_t g = 0; g < chart.groups.size(); ++g) {
    text << field(chart.groups[g]);
    for (const std::vector<double>& values : chart.values) {
      if (values[g] > 0)
        text << ' ' << values[g];
      else
        text << " NaN";
    }
    text << '\n';
  }
  text << "EOD\nplot ";
  for (std::size_t s = 0; s < chart.series.size(); ++s)
    text << (s > 0 ? ", " : "") << "$data using " << s + 2 << ":xtic(1) title " << quoted(chart.series[s]);
  text << '\n';
  run_gnuplot(file, 1000, 520, text.str());
}

}  // namespace mallow::bench
