#include "sweep/sweep_table.h"

#include <sqlite3.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/csv.h"
#include "program/external_program.h"
#include "program/html.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

/// The cells of a point's row, as text; empty where there is nothing.
std::vector<std::string> row(const SweepFolder& sweep, std::size_t point, const Outcome& outcome) {
  std::vector<std::string> cells{std::to_string(point)};
  for (const std::string& value : sweep.points()[point]) cells.push_back(value);
  cells.emplace_back(name(outcome.status));
  for (const Measure& measure : sweep.spec().measures) {
    const auto found = outcome.measured.find(measure.name);
    cells.push_back(found == outcome.measured.end() ? "" : number_text(found->second));
  }
  cells.push_back(outcome.message);
  return cells;
}

bool is_number(const std::string& text) {
  return number_of(text).has_value();
}

std::optional<std::int64_t> whole_number_of(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Names of columns in SQL, which knows no difference between `a` and `A`: the second of them is A_2.
std::vector<std::string> sql_names(std::vector<std::string> columns) {
  const auto lower = [](std::string name) {
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return name;
  };
  std::set<std::string> taken;
  for (std::string& column : columns) {
    const std::string name = column;
    for (int number = 2; !taken.insert(lower(column)).second; ++number)
      column = name + '_' + std::to_string(number);
  }
  return columns;
}

/// A database that is written anew.
class Database {
 public:
  explicit Database(const fs::path& file) : file_(file) { check(sqlite3_open(file.c_str(), &database_)); }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql) { check(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr)); }

  void insert(std::size_t columns, const std::vector<std::vector<std::string>>& rows) {
    std::string marks;
    for (std::size_t c = 0; c < columns; ++c) marks += c == 0 ? "?" : ",?";
    sqlite3_stmt* statement = nullptr;
    check(sqlite3_prepare_v2(database_, ("INSERT INTO points VALUES (" + marks + ")").c_str(), -1, &statement,
                             nullptr));
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> owner(statement, sqlite3_finalize);
    for (const std::vector<std::string>& cells : rows) {
      for (std::size_t c = 0; c < columns; ++c) {
        const int at = static_cast<int>(c) + 1;
        if (cells[c].empty())
          check(sqlite3_bind_null(statement, at));
        else if (const auto whole = whole_number_of(cells[c]))
          check(sqlite3_bind_int64(statement, at, *whole));
        else if (is_number(cells[c]))
          check(sqlite3_bind_double(statement, at, std::stod(cells[c])));
        else
          check(sqlite3_bind_text(statement, at, cells[c].c_str(), -1, SQLITE_TRANSIENT));
      }
      const int code = sqlite3_step(statement);
      if (code != SQLITE_DONE) check(code);
      sqlite3_reset(statement);
    }
  }

 private:
  void check(int code) {
    if (code != SQLITE_OK)
      throw IoError(
          {file_.string(), 0, 0, "", std::string("cannot be written: ") + sqlite3_errmsg(database_)});
  }
  fs::path file_;
  sqlite3* database_ = nullptr;
};

std::vector<std::vector<std::string>> rows_of(const SweepFolder& sweep,
                                              const std::vector<Outcome>& outcomes) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t point = 0; point < outcomes.size(); ++point)
    rows.push_back(row(sweep, point, outcomes[point]));
  return rows;
}

/// Of a column that is known before anything is run.
bool has_only_texts(const SweepFolder& sweep, const std::string& column) {
  if (column == "status" || column == "message") return true;
  for (std::size_t k = 0; k < sweep.spec().vary.size(); ++k)
    if (sweep.spec().vary[k].key == column)
      return std::ranges::none_of(sweep.points(),
                                  [&](const std::vector<std::string>& point) { return is_number(point[k]); });
  return false;
}

}  // namespace

std::vector<std::string> table_columns(const SweepFolder& sweep) {
  std::vector<std::string> columns{"point"};
  for (const Vary& vary : sweep.spec().vary) columns.push_back(vary.key);
  columns.emplace_back("status");
  for (const Measure& measure : sweep.spec().measures) columns.push_back(measure.name);
  columns.emplace_back("message");
  return columns;
}

void write_table(const SweepFolder& sweep, const std::vector<Outcome>& outcomes) {
  const std::vector<std::string> columns = table_columns(sweep);
  const auto rows = rows_of(sweep, outcomes);
  std::string csv = program::csv_line(columns);
  for (const std::vector<std::string>& cells : rows) csv += program::csv_line(cells);
  write_whole(sweep.folder() / "table.csv", csv);
  write_whole(sweep.folder() / "table.sqlite", [&](const fs::path& beside) {
    fs::remove(beside);
    Database database(beside);
    std::string list;  // names are quoted in SQL as cells are in a CSV
    for (const std::string& column : sql_names(columns))
      list += (list.empty() ? "" : ", ") + program::csv_quoted(column);
    database.run("PRAGMA journal_mode = OFF; BEGIN; CREATE TABLE points (" + list + ")");
    database.insert(columns.size(), rows);
    database.run("COMMIT");
  });
}

void check_table(const SweepFolder& sweep) {
  const std::vector<std::string> columns = table_columns(sweep);
  std::string all;
  for (const std::string& known : columns) all += (all.empty() ? "" : ", ") + known;
  std::vector<Problem> problems;
  const auto problem = [&](const Place& place, const std::string& field, const std::string& message) {
    problems.push_back({sweep.spec().file.string(), place.line, place.column, field, message});
  };
  std::set<std::string> taken{"point", "status", "message"};
  for (const Vary& vary : sweep.spec().vary)
    if (!taken.insert(vary.key).second) problem({}, "vary", "'" + vary.key + "' is a column of its own");
  for (const Measure& measure : sweep.spec().measures)
    if (!taken.insert(measure.name).second)
      problem(measure.place, "measures", "'" + measure.name + "' is a column already");
  int number = 0;
  for (const Plot& plot : sweep.spec().plots) {
    for (const auto& [key, column] :
         {std::pair{".x", &plot.x}, std::pair{".y", &plot.y}, std::pair{".color", &plot.color}}) {
      const std::string field = "plot[" + std::to_string(number) + "]" + key;
      if (column->name.empty()) continue;
      if (!std::ranges::count(columns, column->name))
        problem(column->place, field, "'" + column->name + "' is no column of the table; there are " + all);
      else if (has_only_texts(sweep, column->name))
        problem(column->place, field, "'" + column->name + "' has texts, which no plot can show");
    }
    ++number;
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
}

int draw_plots(const SweepFolder& sweep, const std::vector<Outcome>& outcomes) {
  check_table(sweep);
  const std::vector<std::string> columns = table_columns(sweep);
  const auto place = [&](const Plot::Column& column) {
    return static_cast<std::size_t>(std::ranges::find(columns, column.name) - columns.begin());
  };
  const auto rows = rows_of(sweep, outcomes);
  int drawn = 0;
  for (const Plot& plot : sweep.spec().plots) {
    const std::size_t x = place(plot.x), y = place(plot.y);
    const bool has_color = !plot.color.name.empty();
    const std::size_t color = has_color ? place(plot.color) : y;
    if (!program::is_installed("gnuplot")) continue;
    std::string data;
    for (const std::vector<std::string>& cells : rows)
      if (is_number(cells[x]) && is_number(cells[y]) && is_number(cells[color]))
        data += cells[x] + ' ' + cells[y] + ' ' + cells[color] + '\n';
    if (data.empty()) continue;  // gnuplot would leave an empty picture
    const std::string stem = "plot_" + std::to_string(drawn++);
    write_whole(sweep.folder() / (stem + ".dat"), data);
    // noenhanced: brackets and underscores of keys are themselves.
    std::string script = "set terminal svg size 720,480 noenhanced\nset output '" + stem +
                         ".svg'\nset xlabel '" + plot.x.name + "'\nset ylabel '" + plot.y.name +
                         "'\nunset key\n";
    if (has_color) script += "set cblabel '" + plot.color.name + "'\n";
    script += "plot '" + stem + ".dat' using 1:2" +
              (has_color ? ":3 with points pt 7 ps 0.6 palette\n" : " with points pt 7 ps 0.6\n");
    write_whole(sweep.folder() / (stem + ".gp"), script);
    if (program::run_program({"gnuplot", stem + ".gp"}, sweep.folder()) != 0) --drawn;
  }
  return drawn;
}

bool make_sheet(const SweepFolder& sweep, const std::vector<Outcome>& outcomes) {
  if (!sweep.spec().images) return false;
  const auto text = [](const std::string& plain) { return program::html_text(plain); };
  std::string tiles;
  for (std::size_t point = 0; point < outcomes.size(); ++point) {
    const fs::path picture = sweep.picture(point);
    if (outcomes[point].status != Outcome::Status::done || picture.empty()) continue;
    tiles += "<figure><img loading=\"lazy\" src=\"" +
             text(picture.lexically_relative(sweep.folder()).string()) + "\" alt=\"\"><figcaption><b>" +
             std::to_string(point) + "</b>";
    for (std::size_t k = 0; k < sweep.points()[point].size(); ++k)
      tiles += "<br>" + text(sweep.spec().vary[k].key + " = " + sweep.points()[point][k]);
    tiles += "</figcaption></figure>\n";
  }
  if (tiles.empty()) return false;
  const std::string name = text(sweep.spec().file.filename().string());
  write_whole(
      sweep.folder() / "sheet.html",
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + name +
          ": last frames</title>\n<style>\nbody { font: 13px sans-serif; margin: 1em; display: grid; "
          "grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); gap: 8px; }\nfigure { margin: "
          "0; } img { width: 100%; display: block; }\n</style></head><body>\n" +
          tiles + "</body></html>\n");
  return true;
}

}  // namespace mallow::sweep
