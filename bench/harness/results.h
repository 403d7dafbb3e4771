#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace mallow::bench {

using Json = nlohmann::ordered_json;

/// Where a command puts what it measured.
struct Output {
  std::filesystem::path folder = "out/bench";  ///< <command>.json, <command>.csv and pictures
  std::filesystem::path json = {};             ///< the JSON file, where it is to have another name
};

/// The rows of one command. Files are written anew, whole, with every row, so that an interrupted run keeps
/// what it finished.
class Results {
 public:
  /// settings: what the user chose. Throws IoError where the output cannot be written.
  Results(std::string command, const Output& output, int threads, Json settings);

  /// A row of scalars, and of objects and arrays of them; the CSV names nested ones "a.b".
  void add(Json row);
  /// Beside the rows: what is said once of all of them.
  void set(const std::string& key, Json value);
  /// All rows are in.
  void close();

  const Json& rows() const { return document_["rows"]; }
  /// A file of this command: "table1.svg" for ".svg".
  std::filesystem::path file(const std::string& ending) const;

 private:
  void write() const;

  std::string command_;
  std::filesystem::path folder_, json_;
  Json document_;
};

/// Rows as a table that reads well as text and as Markdown. columns: keys of the rows, and headings.
struct TableColumn {
  std::string key;  ///< "phases.goals" for a nested value
  std::string heading;
  int decimals = 2;  ///< of numbers that are not whole
};
std::string markdown_table(const Json& rows, const std::vector<TableColumn>& columns);

}  // namespace mallow::bench
