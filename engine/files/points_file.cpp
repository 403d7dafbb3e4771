#include <algorithm>
#include <array>
#include <optional>

#include "files/byte_reader.h"
#include "files/ply.h"
#include "files/text_reader.h"
#include "mallow/files.h"

namespace mallow {
namespace {

/// The columns that a point file may hold, in the order of a row's numbers below.
constexpr std::array<const char*, 6> k_columns = {"x", "y", "z", "vx", "vy", "vz"};

struct CsvColumns {
  std::vector<std::optional<std::size_t>> meaning;  ///< by column of the file: index into k_columns
  bool velocities = false;
};

CsvColumns read_csv_header(TextReader& text) {
  if (!text.next_filled_line())
    text.fail("header", "is missing: a line that names the columns, such as x,y,z");
  CsvColumns columns;
  std::array<bool, k_columns.size()> found{};
  while (const auto name = text.cell()) {
    const auto known = std::find(k_columns.begin(), k_columns.end(), *name);
    if (known == k_columns.end()) {
      columns.meaning.emplace_back();
      continue;
    }
    const auto index = static_cast<std::size_t>(known - k_columns.begin());
    if (found[index]) text.fail("header", "column " + in_quotes(*name) + " is given twice");
    found[index] = true;
    columns.meaning.emplace_back(index);
  }
  columns.velocities = found[3] || found[4] || found[5];
  for (std::size_t k = 0; k < (columns.velocities ? 6u : 3u); ++k) {
    if (found[k]) continue;
    text.fail("header",
              "lacks column " + in_quotes(k_columns[k]) + "; x, y, z are needed, and vx, vy, vz all or none");
  }
  return columns;
}

Body read_csv_points(const std::filesystem::path& file) {
  const std::string content = read_whole_file(file);
  TextReader text(file, content);
  const CsvColumns columns = read_csv_header(text);
  Body body;
  while (text.next_filled_line()) {
    std::array<float, k_columns.size()> row{};
    std::size_t cells = 0;
    while (const auto cell = text.cell()) {
      if (cells < columns.meaning.size()) {
        if (const auto k = columns.meaning[cells]) row[*k] = text.finite(k_columns[*k], *cell);
      }
      ++cells;
    }
    if (cells != columns.meaning.size()) {
      text.fail("", counted(cells, "value") + " in this row, but the header names " +
                        counted(columns.meaning.size(), "column"));
    }
    require_room(text, body.positions.size() + 1, "points");
    body.positions.emplace_back(row[0], row[1], row[2]);
    if (columns.velocities) body.velocities.emplace_back(row[3], row[4], row[5]);
  }
  return body;
}

Body read_ply_points(const std::filesystem::path& file) {
  PlyReader ply(file);
  const PlyElement& vertex = ply.require("vertex");
  const auto position = ply.find_vector(vertex, {"x", "y", "z"}, true);
  const auto velocity = ply.find_vector(vertex, {"vx", "vy", "vz"}, false);
  Body body;
  while (const PlyElement* element = ply.next_element()) {
    if (element != &vertex) continue;
    body.positions.reserve(element->count);
    while (ply.next_row()) {
      body.positions.push_back(ply.finite_vector(*position));
      if (velocity) body.velocities.push_back(ply.finite_vector(*velocity));
    }
  }
  return body;
}

}  // namespace

Body read_points(const std::filesystem::path& file, float spacing) {
  const std::string ending = lower_case_ending(file);
  Body body;
  if (ending == ".ply") {
    body = read_ply_points(file);
  } else if (ending == ".csv") {
    body = read_csv_points(file);
  } else {
    fail_file(file, "ending " + in_quotes(ending) + " is not allowed for points: .ply or .csv");
  }
  if (body.positions.empty()) fail_file(file, "holds no points: at least one is needed");
  body.spacing = spacing;
  return body;
}

}  // namespace mallow
