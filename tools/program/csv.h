#pragma once

#include <string>
#include <vector>

namespace mallow::program {

/// A text in double quotes, those in it doubled. [RFC 4180]
std::string csv_quoted(const std::string& text);
/// A text as a cell of a CSV: in quotes where a comma or the like asks for them.
std::string csv_cell(const std::string& text);
/// A line of them, with its end.
std::string csv_line(const std::vector<std::string>& cells);
/// The cells of a line, as they were before they were written: without quotes, and without blanks around
/// them.
std::vector<std::string> csv_cells(const std::string& line);

}  // namespace mallow::program
