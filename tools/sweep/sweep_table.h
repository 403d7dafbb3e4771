#pragma once

#include <vector>

#include "sweep/sweep_points.h"

namespace mallow::sweep {

/// The names of the table's columns: point, the keys, status, the measures, message.
std::vector<std::string> table_columns(const SweepFolder& sweep);
/// DIR/table.csv, and DIR/table.sqlite with a table `points`. Both depend on the outcomes alone. Throws
/// IoError.
void write_table(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);
/// Throws ConfigError where a plot names no column of the table.
void check_plots(const SweepFolder& sweep);
/// DIR/plot_0.svg, ...: where gnuplot is installed. Throws what check_plots() throws. Returns how many were
/// drawn.
int draw_plots(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);
/// DIR/sheet.html, the last picture of each point that is done, under its number and values. Returns whether
/// there are any. Throws IoError.
bool make_sheet(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);

}  // namespace mallow::sweep
