#include "scene/document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>

#include "scene/document_scan.h"

// Compiled into this file, so that programs that link mallow::scene need no toml++ of their own.
#undef TOML_HEADER_ONLY
#undef TOML_SHARED_LIB
#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
// toml++ 3.3 asserts (and with NDEBUG tells some compilers to assume) that a key starts with a key's
// character, which a file with "[=" in it breaks; without both, its next line reports that as the error it
// is.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace mallow::scene_file {
namespace {

Place place_of(const toml::source_region& region) {
  return {.line = static_cast<int>(region.begin.line), .column = static_cast<int>(region.begin.column)};
}

/// find_fault() limits the nesting of values and of keys, so this recursion is bounded.
Node convert(const toml::node& from) {
  Node to{.place = place_of(from.source()), .value = DateTime{}};
  if (const auto* flag = from.as_boolean()) {
    to.value = flag->get();
  } else if (const auto* integer = from.as_integer()) {
    to.value = integer->get();
  } else if (const auto* number = from.as_floating_point()) {
    to.value = number->get();
  } else if (const auto* text = from.as_string()) {
    to.value = text->get();
  } else if (const auto* array = from.as_array()) {
    Array nodes;
    for (const toml::node& element : *array) nodes.push_back(convert(element));
    to.value = std::move(nodes);
  } else if (const auto* table = from.as_table()) {
    Table entries;
    for (const auto& [key, value] : *table)
      entries.push_back({std::string(key.str()), place_of(key.source()), convert(value)});
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    });
    to.value = std::move(entries);
  }
  return to;
}

[[noreturn]] void throw_at(const Place& place, const std::string& file, std::string message) {
  throw ConfigError(std::vector<Problem>{{.file = file,
                                          .line = place.line,
                                          .column = place.column,
                                          .field = {},
                                          .message = std::move(message)}});
}

template <class Float>
std::string shortest(Float value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string text(buffer, end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace

const Node* find(const Node& node, std::string_view key) {
  const Table* table = node.get_if<Table>();
  if (!table) return nullptr;
  const auto entry = std::find_if(table->begin(), table->end(), [&](const Entry& e) { return e.key == key; });
  return entry == table->end() ? nullptr : &entry->node;
}

Node* find(Node& node, std::string_view key) {
  return const_cast<Node*>(find(static_cast<const Node&>(node), key));
}

const Place& place_of_clash(const Place& first, const Place& second) {
  return first.given_by.empty() && !second.given_by.empty() ? second : first;
}

Node parse_document(const std::string& text, const std::string& file) {
  if (auto fault = find_fault(text)) throw_at(fault->place, file, std::move(fault->message));
  try {
    return convert(toml::parse(text, file));
  } catch (const toml::parse_error& error) {
    throw_at(place_of(error.source()), file, std::string(error.description()));
  }
}

std::string describe(const Node& node) {
  struct Describe {
    std::string operator()(DateTime) const { return "a date or time"; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
    std::string operator()(double number) const { return number_text(number); }
    std::string operator()(const std::string& text) const {
      constexpr std::size_t k_longest = 80;
      const bool cut = text.size() > k_longest;
      return toml_string(cut ? text.substr(0, k_longest) + "..." : text) + " (a string)";
    }
    std::string operator()(const Array& array) const { return "an array of " + std::to_string(array.size()); }
    std::string operator()(const Table&) const { return "a table"; }
  };
  return std::visit(Describe{}, node.value);
}

std::string number_text(float value) {
  return shortest(value);
}
std::string number_text(double value) {
  return shortest(value);
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr char k_digits[] = "0123456789abcdef";
      const auto code = static_cast<unsigned char>(c);
      out += "\\u00";
      out += k_digits[code >> 4];
      out += k_digits[code & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

void Problems::add(const Place& place, std::string field, std::string message) {
  ++count_;
  if (full()) return;
  const bool in_file = place.given_by.empty();
  problems_.push_back({.file = in_file ? file_ : place.given_by,
                       .line = in_file ? place.line : 0,
                       .column = in_file ? place.column : 0,
                       .field = std::move(field),
                       .message = std::move(message)});
}

void Problems::finish() {
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [this](const Problem& a, const Problem& b) {
    return std::tuple(a.file != file_, a.line, a.column) < std::tuple(b.file != file_, b.line, b.column);
  });
  if (count_ > problems_.size())
    problems_.push_back({.file = file_,
                         .field = {},
                         .message = "and " + std::to_string(count_ - problems_.size()) + " more problems"});
  throw ConfigError(std::move(problems_));
}

}  // namespace mallow::scene_file
