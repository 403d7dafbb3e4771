#include "program/scene_changes.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

namespace mallow::program {
namespace {

using Values = std::vector<std::pair<std::string, std::string>>;

/// Every key that is given, with its value, from the lines that print_scene() makes of them.
Values values_of(const Scene& scene) {
  Values values;
  std::map<std::string, int> elements;
  std::string section;
  std::istringstream lines(print_scene(scene));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[[")) {
      const std::string list = line.substr(2, line.find(']') - 2);
      section = list + '[' + std::to_string(elements[list]++) + ']';
    } else if (line.starts_with('[')) {
      section = line.substr(1, line.find(']') - 1);
    } else if (const std::size_t equals = line.find(" = "); equals != line.npos && !line.starts_with('#')) {
      values.emplace_back(section + '.' + line.substr(0, equals), line.substr(equals + 3));
    }
  }
  return values;
}

std::string value_of(const Values& values, const std::string& key) {
  const auto found = std::ranges::find(values, key, &Values::value_type::first);
  return found == values.end() ? "" : found->second;
}

}  // namespace

std::vector<SceneChange> scene_changes(const Scene& before, const Scene& now) {
  const Values old_values = values_of(before), new_values = values_of(now);
  std::vector<SceneChange> changes;
  for (const auto& [key, value] : new_values)
    if (const std::string old = value_of(old_values, key); old != value) changes.push_back({key, old, value});
  for (const auto& [key, value] : old_values)
    if (value_of(new_values, key).empty()) changes.push_back({key, value, ""});
  return changes;
}

}  // namespace mallow::program
