#include "sweep/sweep_spec.h"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

#include "mallow/errors.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace {

/// More would be a slip: their folders alone fill a disk.
constexpr std::int64_t k_most_points = 1'000'000;

Place place_of(const toml::node& node) {
  return {static_cast<int>(node.source().begin.line), static_cast<int>(node.source().begin.column)};
}

/// A value as TOML writes it; numbers as short as they come, also inside of lists.
std::string text_of(const toml::node& node) {
  const auto joined = [](const auto& all, const auto& text_of_one) {
    std::string text;
    for (const auto& one : all) text += (text.empty() ? "" : ", ") + text_of_one(one);
    return text;
  };
  if (const toml::array* list = node.as_array())
    return "[" + joined(*list, [](const toml::node& one) { return text_of(one); }) + "]";
  if (const toml::table* table = node.as_table())
    return "{" +
           joined(
               *table,
               [](const auto& one) { return std::string(one.first.str()) + " = " + text_of(one.second); }) +
           "}";
  if (const auto number = node.value_exact<double>(); number && std::isfinite(*number)) {
    const std::string text = number_text(*number);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  }
  std::ostringstream text;
  text << toml::node_view<const toml::node>(node);
  return text.str();
}

/// Reads a table and keeps what is wrong with it.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  void problem(const toml::node& at, const std::string& field, const std::string& message) {
    const Place place = place_of(at);
    problems_.push_back({file_, place.line, place.column, field, message});
  }

  /// All keys that a table may have; others are told.
  void allow(const toml::table& table, const std::string& path, const std::set<std::string_view>& keys) {
    for (const auto& [key, node] : table) {
      if (keys.contains(key.str())) continue;
      std::string all;
      for (const std::string_view known : keys) all += (all.empty() ? "" : ", ") + std::string(known);
      problem(node, path + std::string(key.str()), "unknown key; there are " + all);
    }
  }

  std::string text(const toml::table& table, const std::string& path, std::string_view key) {
    const toml::node* node = table.get(key);
    if (!node) return "";
    if (const auto value = node->value_exact<std::string>()) return *value;
    problem(*node, path + std::string(key), "a string is needed");
    return "";
  }

  std::optional<std::int64_t> whole(const toml::table& table, const std::string& path, std::string_view key,
                                    std::int64_t least, std::int64_t most) {
    const toml::node* node = table.get(key);
    if (!node) return std::nullopt;
    const auto value = node->value_exact<std::int64_t>();
    if (value && *value >= least && *value <= most) return value;
    problem(*node, path + std::string(key),
            text_of(*node) + " is not allowed: a whole number in [" + std::to_string(least) + ", " +
                std::to_string(most) + "]");
    return std::nullopt;
  }

  bool flag(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    if (!node) return false;
    if (const auto value = node->value_exact<bool>()) return *value;
    problem(*node, std::string(key), "true or false is needed");
    return false;
  }

  /// The tables of [[key]].
  std::vector<const toml::table*> tables(const toml::table& table, std::string_view key) {
    std::vector<const toml::table*> all;
    const toml::node* node = table.get(key);
    if (!node) return all;
    const toml::array* list = node->as_array();
    if (!list || !list->is_array_of_tables()) {
      problem(*node, std::string(key), "tables are needed, each under [[" + std::string(key) + "]]");
      return all;
    }
    for (const toml::node& one : *list) all.push_back(one.as_table());
    return all;
  }

  void finish() {
    if (!problems_.empty()) throw ConfigError(std::move(problems_));
  }

 private:
  std::string file_;
  std::vector<Problem> problems_;
};

void read_range(Reader& reader, const toml::table& table, const std::string& path, Vary& vary) {
  const toml::node *from = table.get("from"), *to = table.get("to");
  if (!from || !to)
    return reader.problem(table, path + (from ? "to" : "from"), "is missing: give values, or from and to");
  const auto low = from->value<double>(), high = to->value<double>();
  if (!low || !high || !std::isfinite(*low) || !std::isfinite(*high))
    return reader.problem(*from, path + "from", "from and to are two finite numbers");
  vary.from = *low, vary.to = *high;
  if (!(vary.from < vary.to))
    reader.problem(*to, path + "to",
                   text_of(*to) + " is not allowed: above from, which is " + text_of(*from) +
                       "; one value alone, or an order of your own, is given by values = [...]");
  vary.whole = from->is_integer() && to->is_integer();
  if (const auto count = reader.whole(table, path, "count", 1, k_most_points)) vary.count = int(*count);
  const std::string scale = reader.text(table, path, "scale");
  if (!scale.empty() && scale != "linear" && scale != "log")
    reader.problem(*table.get("scale"), path + "scale",
                   "\"" + scale + "\" is not allowed: \"linear\" or \"log\"");
  vary.logarithmic = scale == "log";
  if (vary.logarithmic && !(vary.from > 0 && vary.to > 0))
    reader.problem(*from, path + "from", "from and to must be above 0 where scale is \"log\"");
}

Vary read_vary(Reader& reader, const toml::table& table, const std::string& path) {
  reader.allow(table, path, {"key", "values", "from", "to", "count", "scale"});
  Vary vary;
  if (const toml::array* keys = table.get("key") ? table.get("key")->as_array() : nullptr) {
    for (const toml::node& key : *keys) vary.also.push_back(key.value_or<std::string>(""));
    if (vary.also.empty() || std::ranges::count(vary.also, ""))
      reader.problem(*keys, path + "key", "a key of the scene is needed, or a list of them");
    else
      vary.key = vary.also.front();
    if (!vary.also.empty()) vary.also.erase(vary.also.begin());
  } else {
    vary.key = reader.text(table, path, "key");
  }
  if (vary.key.empty() && !table.contains("key"))
    reader.problem(table, path + "key", "is missing: a key of the scene");
  const toml::node* values = table.get("values");
  if (!values) {
    read_range(reader, table, path, vary);
    return vary;
  }
  const toml::array* list = values->as_array();
  if (!list || list->empty()) {
    reader.problem(*values, path + "values", "a list of values is needed");
    return vary;
  }
  for (const toml::node& value : *list) {
    vary.values.push_back(text_of(value));
  }
  for (const char* other : {"from", "to", "count", "scale"})
    if (table.contains(other))
      reader.problem(*table.get(other), path + other, "is not allowed beside values");
  return vary;
}

void read_measures(Reader& reader, const toml::table& table, SweepSpec& spec) {
  static constexpr std::array<std::pair<const char*, Measure::Of>, 4> k_kinds{{{".last", Measure::Of::last},
                                                                               {".min", Measure::Of::least},
                                                                               {".max", Measure::Of::most},
                                                                               {".mean", Measure::Of::mean}}};
  const auto add = [&](std::string text, Place place) {
    Measure measure{.column = text, .of = Measure::Of::last, .name = text, .place = place};
    for (const auto& [ending, of] : k_kinds)
      if (text.ends_with(ending)) {
        measure.column = text.substr(0, text.size() - std::string_view(ending).size());
        measure.of = of;
      }
    spec.measures.push_back(std::move(measure));
  };
  const toml::node* node = table.get("measures");
  if (!node) {
    for (const char* name : {"height", "volume", "kinetic_energy", "parts", "largest_compression.max"})
      add(name, {});
    return;
  }
  const toml::array* list = node->as_array();
  if (!list) return reader.problem(*node, "measures", "a list of columns of the series is needed");
  for (const toml::node& name : *list) {
    if (const auto text = name.value_exact<std::string>())
      add(*text, place_of(name));
    else
      reader.problem(name, "measures", "names of columns are strings: \"height\", \"energy.max\"");
  }
}

void read_method(Reader& reader, const toml::table& table, SweepSpec& spec) {
  static constexpr std::array<std::pair<const char*, Method>, 4> k_methods{
      {{"grid", Method::grid},
       {"random", Method::random},
       {"latin_hypercube", Method::latin_hypercube},
       {"sobol", Method::sobol}}};
  const std::string name = reader.text(table, "", "method");
  const auto found =
      std::ranges::find_if(k_methods, [&](const auto& method) { return name == method.first; });
  if (found != k_methods.end())
    spec.method = found->second;
  else if (!name.empty())
    reader.problem(*table.get("method"), "method",
                   "\"" + name + "\" is not allowed: \"grid\", \"random\", \"latin_hypercube\" or \"sobol\"");
  if (const auto points = reader.whole(table, "", "points", 1, k_most_points)) spec.points = int(*points);
  const bool counts = spec.method == Method::grid || !spec.points_file.empty();
  if (counts && table.contains("points"))
    reader.problem(*table.get("points"), "points", "is not allowed with a grid, or points of a file");
  if (!counts && spec.points == 0 && !table.contains("points"))
    reader.problem(table, "points", "is missing: how many points there are");
}

/// What a grid or random points can make nothing of.
void check_vary(Reader& reader, const toml::table& table, const SweepSpec& spec) {
  if (spec.vary.empty() == spec.points_file.empty())
    reader.problem(table, "vary", "give either [[vary]] tables or a points_file");
  std::set<std::string> keys;
  double count = 1;
  for (const Vary& vary : spec.vary) {
    std::vector<std::string> all = vary.also;
    all.push_back(vary.key);
    for (const std::string& key : all)
      if (!keys.insert(key).second) reader.problem(table, "vary", "has '" + key + "' twice");
    if (spec.method != Method::grid && vary.count)
      reader.problem(table, "vary", "'" + vary.key + "' has a count, which only a grid takes");
    if (spec.method == Method::grid && vary.values.empty() && !vary.count)
      reader.problem(table, "vary", "'" + vary.key + "' needs a count in a grid");
    count *= static_cast<double>(vary.values.empty() ? vary.count.value_or(1) : int(vary.values.size()));
  }
  if (spec.method == Method::grid && count > static_cast<double>(k_most_points))
    reader.problem(table, "vary", "makes more than a million points");
}

}  // namespace

SweepSpec read_spec(const std::filesystem::path& file) {
  toml::table table;
  try {
    table = toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    const Problem problem{file.string(), static_cast<int>(error.source().begin.line),
                          static_cast<int>(error.source().begin.column), "",
                          std::string(error.description())};
    if (problem.line == 0) throw IoError(problem);
    throw ConfigError({problem});
  }
  Reader reader(file.string());
  reader.allow(
      table, "",
      {"scene", "method", "points", "points_file", "seed", "frames", "images", "measures", "vary", "plot"});
  SweepSpec spec;
  spec.file = file;
  const std::string scene = reader.text(table, "", "scene");
  if (scene.empty()) reader.problem(table, "scene", "is missing: the scene file that is swept");
  spec.scene = file.parent_path() / scene;
  if (const std::string name = reader.text(table, "", "points_file"); !name.empty())
    spec.points_file = file.parent_path() / name;
  read_method(reader, table, spec);
  if (const auto seed = reader.whole(table, "", "seed", 0, INT64_MAX)) spec.seed = std::uint64_t(*seed);
  if (const auto frames = reader.whole(table, "", "frames", 1, 100'000'000)) spec.frames = int(*frames);
  spec.images = reader.flag(table, "images");
  read_measures(reader, table, spec);
  int number = 0;
  for (const toml::table* one : reader.tables(table, "vary"))
    spec.vary.push_back(read_vary(reader, *one, "vary[" + std::to_string(number++) + "]."));
  number = 0;
  for (const toml::table* one : reader.tables(table, "plot")) {
    const std::string path = "plot[" + std::to_string(number++) + "].";
    reader.allow(*one, path, {"x", "y", "color"});
    const auto column = [&](const char* key) {
      const toml::node* node = one->get(key);
      return Plot::Column{reader.text(*one, path, key), node ? place_of(*node) : Place{}};
    };
    spec.plots.push_back({.x = column("x"), .y = column("y"), .color = column("color")});
    if (spec.plots.back().x.name.empty() || spec.plots.back().y.name.empty())
      reader.problem(*one, path + "x", "x and y are columns of the table");
  }
  check_vary(reader, table, spec);
  reader.finish();
  return spec;
}

}  // namespace mallow::sweep
