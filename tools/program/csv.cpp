#include "program/csv.h"

namespace mallow::program {

std::string csv_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + quoted + '"';
}

std::string csv_cell(const std::string& text) {
  return text.find_first_of(",\"\n\r") == text.npos ? text : csv_quoted(text);
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t c = 0; c < cells.size(); ++c) line += (c == 0 ? "" : ",") + csv_cell(cells[c]);
  return line + '\n';
}

std::vector<std::string> csv_cells(const std::string& line) {
  constexpr const char* k_blank = " \t\r";
  std::vector<std::string> cells{""};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string& cell = cells.back();
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cell += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      cells.emplace_back();
    else
      cell += line[i];
  }
  for (std::string& cell : cells) {
    const std::size_t begin = cell.find_first_not_of(k_blank), end = cell.find_last_not_of(k_blank);
    cell = begin == cell.npos ? "" : cell.substr(begin, end - begin + 1);
  }
  return cells;
}

}  // namespace mallow::program
