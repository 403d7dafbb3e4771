#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mallow/errors.h"

/// What a TOML document says, in plain types: the only room that knows of toml++ is document.cpp, because
/// that header alone takes seconds to compile.
namespace mallow::scene_file {

/// Where a value was given: in the scene file, or as an override on the command line.
struct Place {
  int line = 0;  ///< from 1; 0 where the whole file is meant
  int column = 0;
  std::string given_by{};  ///< "--set solver.time_step=0.1"; empty for what stands in the file
};

struct Entry;
struct Node;
using Array = std::vector<Node>;
/// In the order in which the keys stand in the file.
using Table = std::vector<Entry>;
/// A date or a time: no scene key takes one.
struct DateTime {};

struct Node {
  Place place;
  std::variant<DateTime, bool, std::int64_t, double, std::string, Array, Table> value;

  template <class T>
  const T* get_if() const {
    return std::get_if<T>(&value);
  }
  template <class T>
  T* get_if() {
    return std::get_if<T>(&value);
  }
};

struct Entry {
  std::string key;
  Place place;  ///< of the key
  Node node;
};

/// The value of a key in a table, or nullptr: also where `node` is no table.
const Node* find(const Node& node, std::string_view key);
Node* find(Node& node, std::string_view key);

/// Where two values clash: at `first`, unless `second` alone was given on the command line, by who sees it
/// now.
const Place& place_of_clash(const Place& first, const Place& second);

/// The table at the root of a document. Throws ConfigError with line and column of what is no TOML.
Node parse_document(const std::string& text, const std::string& file);

/// What was given, for messages: "-1.5", "\"abc\" (a string)", "an array of 2".
std::string describe(const Node& node);

/// Shortest text that reads back as the same number, as TOML writes it: always with a point or an exponent.
std::string number_text(float value);
std::string number_text(double value);
/// A TOML basic string, quoted.
std::string toml_string(std::string_view text);

/// Problems of one scene in the order in which they should be read: by line, those of overrides last.
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}
  void add(const Place& place, std::string field, std::string message);
  std::size_t count() const { return count_; }
  /// Whether what is added from now on is only counted: then nobody needs to know what was meant.
  bool full() const { return problems_.size() == k_most_reported; }
  /// Throws ConfigError with all of them, if there are any.
  void finish();

 private:
  /// More than anyone reads; keeps the memory that a hostile file can ask for small.
  static constexpr std::size_t k_most_reported = 1000;

  std::string file_;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
};

}  // namespace mallow::scene_file
