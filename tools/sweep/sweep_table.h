#pragma once

#include <vector>

#include "sweep/sweep_points.h"

namespace mallow::sweep {

/// The names of the table's columns: point, the keys, status, the measures, message.
std::vector<std::string> table_columns(const SweepFolder& sweep);
/// DIR/table.csv, and DIR/table.sqlite with a table `points`. Both depend on the outcomes alone. Throws
/// IoError.
void write_table(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);
/// Throws ConfigError where the table would have a column twice, or a plot names none of its columns, or one
/// of texts: before anything is run.
void check_table(const SweepFolder& sweep);
/// DIR/plot_0.svg, ...: where gnuplot is installed, of those that have a point. Throws what check_table()
/// throws. Returns how many were drawn.
int draw_plots(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);
/// DIR/sheet.html, the last picture of each point that is done, under its number and values. Returns whether
/// there are any. Throws IoError.
bool make_sheet(const SweepFolder& sweep, const std::vector<Outcome>& outcomes);

}  // namespace mallow::sweep
