#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "files/byte_reader.h"
#include "files/ply.h"
#include "files/point_columns.h"
#include "files/text_reader.h"
#include "mallow/files.h"

namespace mallow {
namespace {

/// What the columns become that particles have of their own.
constexpr std::array<std::vector<float> Body::*, 4> k_own_members = {
    &Body::alpha, &Body::stiffness, &Body::plastic_yield, &Body::temperature};

/// What the columns that hold vectors are called by other programs: ParaView writes Points:0, Points_0 in
/// newer versions, Velocity:0.
constexpr std::array<std::array<std::string_view, 4>, 2> k_vector_names = {
    {{"points", "point", "position", "positions"}, {"velocity", "velocities", "vel", "v"}}};

struct CsvColumns {
  char separator = ',';
  std::vector<std::optional<std::size_t>> meaning;  ///< by column of the file: index into k_point_columns
  bool velocities = false;
  std::array<bool, k_own_members.size()> own{};
  std::string note;  ///< of those that nothing reads
};

/// "x" of "X [m]".
std::string plain_name(std::string_view name) {
  name = name.substr(0, name.find_first_of("[("));
  name = name.substr(0, name.find_last_not_of(" \t") + 1);
  std::string plain(name);
  for (char& c : plain)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return plain;
}

/// Index into k_point_columns of a column called as other programs do: "points:0", "velocity_x".
std::optional<std::size_t> other_name(std::string_view name) {
  if (name.size() < 3 || (name[name.size() - 2] != ':' && name[name.size() - 2] != '_')) return std::nullopt;
  const std::size_t axis = std::string_view("0x1y2z").find(name.back());
  if (axis == std::string_view::npos) return std::nullopt;
  name.remove_suffix(2);
  for (std::size_t v = 0; v < k_vector_names.size(); ++v)
    if (std::find(k_vector_names[v].begin(), k_vector_names[v].end(), name) != k_vector_names[v].end())
      return 3 * v + axis / 2;
  return std::nullopt;
}

/// What stands between the columns of a header: a comma if there is one outside of quotes, or a semicolon, or
/// a tab.
char find_separator(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    bool quoted = false;
    for (const char c : header) {
      if (c == '"') quoted = !quoted;
      if (c == separator && !quoted) return separator;
    }
  }
  return ',';
}

CsvColumns read_csv_header(TextReader& text) {
  if (!text.next_filled_line())
    text.fail("header", "is missing: a line that names the columns, such as x,y,z");
  CsvColumns columns;
  columns.separator = find_separator(text.line());
  std::vector<std::string> names;
  while (const auto name = text.cell(columns.separator)) names.emplace_back(*name);
  columns.meaning.resize(names.size());
  FoundColumns found{};
  const auto take = [&](std::size_t column, std::size_t k) {
    if (found[k]) text.fail("header", "column " + in_quotes(names[column]) + " is given twice");
    found[k] = true;
    columns.meaning[column] = k;
  };
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto known = std::find(k_point_columns.begin(), k_point_columns.end(), plain_name(names[c]));
    if (known != k_point_columns.end()) take(c, static_cast<std::size_t>(known - k_point_columns.begin()));
  }
  // Other programs' names count where none of a vector's own is there.
  const std::array<bool, 2> own = {found[0] || found[1] || found[2], found[3] || found[4] || found[5]};
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto k = other_name(plain_name(names[c]));
    if (k && !own[*k / 3]) take(c, *k);
  }
  for (std::size_t k = 0; k < columns.own.size(); ++k) columns.own[k] = found[k_first_own_column + k];
  columns.velocities = found[3] || found[4] || found[5];
  for (std::size_t k = 0; k < (columns.velocities ? 6u : 3u); ++k) {
    if (found[k]) continue;
    text.fail("header", "lacks column " + in_quotes(k_point_columns[k]) +
                            "; x, y, z are needed, and vx, vy, vz all or none; there are " +
                            listed_columns(names));
  }
  std::vector<std::string> others;
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (columns.meaning[c]) continue;
    if (std::string why = misnamed_column(plain_name(names[c]), found); !why.empty())
      text.fail("header", why);
    others.push_back(names[c]);
  }
  columns.note = note_of_columns(others);
  return columns;
}

float read_number(const TextReader& text, std::size_t column, std::string_view cell) {
  const double value = text.finite(k_point_columns[column], cell);
  if (const char* allowed = why_not_in_column(column, value))
    text.fail(k_point_columns[column], in_quotes(cell) + " is not allowed: " + allowed);
  return static_cast<float>(value);
}

Body read_csv_points(const std::filesystem::path& file) {
  const std::string content = read_whole_file(file);
  TextReader text(file, content);
  const CsvColumns columns = read_csv_header(text);
  Body body;
  if (!columns.note.empty()) body.notes.push_back(columns.note);
  while (text.next_filled_line()) {
    std::array<float, k_point_columns.size()> row{};
    std::size_t cells = 0;
    while (const auto cell = text.cell(columns.separator)) {
      if (cells < columns.meaning.size()) {
        if (const auto k = columns.meaning[cells]) row[*k] = read_number(text, *k, *cell);
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
    for (std::size_t k = 0; k < columns.own.size(); ++k)
      if (columns.own[k]) (body.*k_own_members[k]).push_back(row[k_first_own_column + k]);
  }
  return body;
}

/// Whether what PLY calls alpha is how opaque a colour is: a byte beside red, green and blue.
bool is_of_color(const PlyElement& vertex, std::size_t alpha) {
  return vertex.properties[alpha].type == PlyType::uint8 && vertex.find("red") && vertex.find("green") &&
         vertex.find("blue");
}

/// Which properties of a vertex are read: places among its properties.
struct PlyColumns {
  std::array<std::size_t, 3> position{};
  std::optional<std::array<std::size_t, 3>> velocity;
  std::array<std::optional<std::size_t>, k_own_members.size()> own;
  std::string note;  ///< of those that are not
};

PlyColumns find_columns(const PlyReader& ply, const PlyElement& vertex) {
  PlyColumns columns;
  columns.position = *ply.find_vector(vertex, {"x", "y", "z"}, true);
  columns.velocity = ply.find_vector(vertex, {"vx", "vy", "vz"}, false);
  FoundColumns found{};
  for (std::size_t k = 0; k < columns.own.size(); ++k) {
    columns.own[k] = ply.find_scalar(vertex, k_point_columns[k_first_own_column + k]);
    if (k == 0 && columns.own[k] && is_of_color(vertex, *columns.own[k])) columns.own[k].reset();
    found[k_first_own_column + k] = columns.own[k].has_value();
  }
  const auto is_read = [&](std::size_t property) {
    return std::ranges::find(columns.position, property) != columns.position.end() ||
           (columns.velocity && std::ranges::find(*columns.velocity, property) != columns.velocity->end()) ||
           std::ranges::find(columns.own, std::optional(property)) != columns.own.end();
  };
  std::vector<std::string> others;
  for (std::size_t k = 0; k < vertex.properties.size(); ++k) {
    const std::string& name = vertex.properties[k].name;
    if (is_read(k)) continue;
    others.push_back(name);
    const bool color = name == "alpha";  // any other alpha is read
    if (const std::string why = color ? "" : misnamed_column(plain_name(name), found); !why.empty())
      ply.fail(why);
  }
  columns.note = note_of_columns(others);
  return columns;
}

float read_number(const PlyReader& ply, std::size_t column, std::size_t property) {
  const double value = ply.value(property);
  if (const char* allowed = why_not_in_column(column, value)) ply.fail_value(property, allowed);
  return static_cast<float>(value);
}

Body read_ply_points(const std::filesystem::path& file) {
  PlyReader ply(file);
  const PlyElement& vertex = ply.require("vertex");
  const PlyColumns columns = find_columns(ply, vertex);
  Body body;
  if (!columns.note.empty()) body.notes.push_back(columns.note);
  while (const PlyElement* element = ply.next_element()) {
    if (element != &vertex) continue;
    body.positions.reserve(element->count);
    while (ply.next_row()) {
      body.positions.push_back(ply.finite_vector(columns.position));
      if (columns.velocity) body.velocities.push_back(ply.finite_vector(*columns.velocity));
      for (std::size_t k = 0; k < columns.own.size(); ++k)
        if (columns.own[k])
          (body.*k_own_members[k]).push_back(read_number(ply, k_first_own_column + k, *columns.own[k]));
    }
  }
  return body;
}

}  // namespace

namespace {

/// So many points tell how far all are apart: their nearest are looked for among all.
constexpr std::size_t k_looked_at = 101;
/// Fewer are no lattice.
constexpr std::size_t k_fewest = 8;
/// Shares of the spacing between which the nearest of most points are: 1 on a cubic lattice, 1.12 where they
/// are packed as closely as they can be.
constexpr float k_nearest = 0.7f, k_farthest = 1.4f;

/// The median distance of points to the nearest other one; at least 2 points.
float median_nearest(const std::vector<Vec3>& points) {
  const std::size_t count = std::min(points.size(), k_looked_at);
  std::vector<float> nearest(count, std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * points.size() / count;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) nearest[k] = std::min(nearest[k], (points[j] - points[i]).squaredNorm());
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::ranges::nth_element(nearest, middle);
  return std::sqrt(*middle);
}

/// A spacing that is not that of the points: each stands for a cube as wide as that.
void look_at_spacing(Body& body) {
  if (body.positions.size() < k_fewest || !(body.spacing > 0)) return;
  const float apart = median_nearest(body.positions), share = apart / body.spacing;
  if (!std::isfinite(share) || (share >= k_nearest && share <= k_farthest)) return;
  std::ostringstream text;
  text << "spacing " << body.spacing << " m is not that of its points, whose nearest are " << apart
       << " m apart in the median: " << std::pow(share, -3.0f)
       << " times the mass, as each stands for a cube as wide as the spacing; give spacing = " << apart;
  body.notes.push_back(text.str());
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
  look_at_spacing(body);
  return body;
}

}  // namespace mallow
