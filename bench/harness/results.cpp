#include "harness/results.h"

#include <chrono>
#include <ctime>
#include <fstream>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/instruction_level.h"
#include "mallow/version.h"
#include "program/machine.h"
#include "program/output_files.h"

namespace mallow::bench {
namespace {

std::string now() {
  const std::time_t time = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
  return text;
}

Json machine() {
  Json machine = program::machine_json();
  machine["instruction_level"] = name(best_instruction_level());
  machine["compiler"] = MALLOW_COMPILER;
  return machine;
}

/// Rows with objects and arrays opened: {"a": {"b": 1}} becomes {"a.b": 1}.
Json flattened(const Json& row) {
  Json flat = Json::object();
  const auto open = [&](const auto& self, const std::string& prefix, const Json& value) -> void {
    if (!value.is_structured()) {
      flat[prefix] = value;
      return;
    }
    std::size_t index = 0;
    for (const auto& [key, item] : value.items())
      self(self, (prefix.empty() ? "" : prefix + '.') + (value.is_array() ? std::to_string(index++) : key),
           item);
  };
  open(open, "", row);
  return flat;
}

std::string csv_cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv(const Json& rows) {
  std::vector<std::string> columns;
  std::vector<Json> flat;
  for (const Json& row : rows) {
    flat.push_back(flattened(row));
    for (const auto& [key, value] : flat.back().items())
      if (std::find(columns.begin(), columns.end(), key) == columns.end()) columns.push_back(key);
  }
  std::string text;
  for (std::size_t c = 0; c < columns.size(); ++c) text += (c > 0 ? "," : "") + columns[c];
  for (const Json& row : flat) {
    text += '\n';
    for (std::size_t c = 0; c < columns.size(); ++c)
      text += (c > 0 ? "," : "") + (row.contains(columns[c]) ? csv_cell(row[columns[c]]) : "");
  }
  return text + '\n';
}

std::string table_cell(const Json& value, int decimals) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_integer()) return value.dump();
  if (!value.is_number()) return "";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value.get<double>());
  return text;
}

/// Throws ConfigError where a file is there that is none of these results: somebody's data is not
/// overwritten.
void check_own(const std::filesystem::path& json) {
  if (!std::filesystem::is_regular_file(json)) return;
  const Json there = Json::parse(std::ifstream(json), nullptr, false);
  if (there.is_object() && there.contains("command") && there.contains("rows")) return;
  throw ConfigError("--json",
                    json.string() + " is not allowed: it is there and holds no results of mallow-bench");
}

}  // namespace

Results::Results(std::string command, const Output& output, int threads, Json settings)
    : command_(std::move(command)), folder_(output.folder), json_(output.json) {
  if (json_.empty()) json_ = file(".json");
  check_own(json_);
  std::filesystem::create_directories(folder_);
  program::check_writable(json_);
  program::check_writable(file(".csv"));
  document_ = {{"command", command_},  {"version", version()}, {"date", now()},
               {"machine", machine()}, {"threads", threads},   {"settings", std::move(settings)},
               {"complete", false},    {"rows", Json::array()}};
}

std::filesystem::path Results::file(const std::string& ending) const {
  return folder_ / (command_ + ending);
}

void Results::add(Json row) {
  document_["rows"].push_back(std::move(row));
  write();
}

void Results::set(const std::string& key, Json value) {
  document_[key] = std::move(value);
}

void Results::close() {
  document_["complete"] = true;
  write();
}

void Results::write() const {
  write_whole(json_, document_.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  write_whole(file(".csv"), csv(document_["rows"]));
}

std::string markdown_table(const Json& rows, const std::vector<TableColumn>& columns) {
  std::vector<std::vector<std::string>> cells;
  std::vector<std::size_t> widths;
  for (const TableColumn& column : columns) widths.push_back(column.heading.size());
  for (const Json& row : rows) {
    const Json flat = flattened(row);
    auto& line = cells.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      line.push_back(flat.contains(columns[c].key) ? table_cell(flat[columns[c].key], columns[c].decimals)
                                                   : "");
      widths[c] = std::max(widths[c], line.back().size());
    }
  }
  const auto padded = [](const std::string& text, std::size_t width, bool right) {
    const std::string space(width - text.size(), ' ');
    return right ? space + text : text + space;
  };
  std::string text = "|";
  for (std::size_t c = 0; c < columns.size(); ++c)
    text += ' ' + padded(columns[c].heading, widths[c], c > 0) + " |";
  text += "\n|";
  for (std::size_t c = 0; c < columns.size(); ++c)
    text += std::string(widths[c] + 1, '-') + (c > 0 ? ":|" : "-|");
  for (const auto& line : cells) {
    text += "\n|";
    for (std::size_t c = 0; c < columns.size(); ++c) text += ' ' + padded(line[c], widths[c], c > 0) + " |";
  }
  return text + '\n';
}

}  // namespace mallow::bench
