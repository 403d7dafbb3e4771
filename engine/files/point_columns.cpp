#include "files/point_columns.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "files/nearest_name.h"
#include "files/text_reader.h"

namespace mallow {
namespace {

constexpr std::size_t k_alpha = 6, k_stiffness = 7, k_temperature = 9;

/// What the files of runs hold beside the columns that are read.
constexpr std::array<std::string_view, 4> k_of_runs = {"id", "generation", "body", "group"};

/// What a material calls its stiffness; particles have a factor on it.
constexpr const char* k_modulus = "youngs_modulus";

}  // namespace

const char* why_not_in_column(std::size_t column, double value) {
  if (!std::isfinite(static_cast<float>(value))) return "a finite number";
  if (column == k_alpha && !(value >= 0 && value <= 1)) return "0 to 1";
  if (column >= k_first_own_column && column != k_temperature && value < 0) return "0 or more";
  return nullptr;
}

std::string misnamed_column(std::string_view name, const FoundColumns& found) {
  std::vector<std::string> known;
  for (std::size_t k = k_first_own_column; k < k_point_columns.size(); ++k)
    if (!found[k]) known.emplace_back(k_point_columns[k]);
  if (!found[k_stiffness]) known.emplace_back(k_modulus);
  const std::string* meant = nearest_name(name, known);
  if (!meant) return {};
  const std::string given = "column " + in_quotes(name);
  if (*meant == k_modulus)
    return given + " is not read: give 'stiffness', a factor on the youngs_modulus of the material";
  return given + " is not read; did you mean " + in_quotes(*meant) + "?";
}

std::string listed_columns(std::span<const std::string> names) {
  constexpr std::size_t k_most = 12;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), k_most); ++k)
    text += (k ? ", " : "") + in_quotes(names[k]);
  return text + (names.size() > k_most ? ", ..." : "");
}

std::string note_of_columns(std::span<const std::string> names) {
  std::vector<std::string> others;
  for (const std::string& name : names)
    if (!name.empty() && std::ranges::find(k_of_runs, name) == k_of_runs.end()) others.push_back(name);
  if (others.empty()) return {};
  std::string text = std::string(others.size() == 1 ? "column " : "columns ") + listed_columns(others) +
                     (others.size() == 1 ? " is" : " are") + " not read; those that are:";
  for (std::size_t k = 0; k < k_point_columns.size(); ++k)
    text += std::string(k == 0 ? " " : ", ") + k_point_columns[k];
  return text;
}

}  // namespace mallow
