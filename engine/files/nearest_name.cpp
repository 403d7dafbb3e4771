#include "files/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace mallow {
namespace {

/// Levenshtein distance: inserted, removed and replaced characters each count one.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, diagonal + 1, replaced});
    }
  }
  return row.back();
}

/// "bodies" as "body", "keys" as "key"; empty where a name is no plural.
std::string singular(std::string_view name) {
  const auto without = [&](std::size_t letters) {
    return std::string(name.substr(0, name.size() - letters));
  };
  if (name.ends_with("ies")) return without(3) + 'y';
  return name.ends_with('s') ? without(1) : std::string();
}

/// How far a name is from one that is known; a plural counts one.
std::size_t distance_to(std::string_view name, const std::string& candidate) {
  const std::size_t distance = edit_distance(name, candidate);
  const std::string one = singular(name);
  return one.empty() ? distance : std::min(distance, 1 + edit_distance(one, candidate));
}

/// The only one of them that has the name as a part, as youngs_modulus has modulus; null where none has, or
/// several have.
const std::string* only_holder(std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t k_least_letters = 4;
  if (name.size() < k_least_letters) return nullptr;
  const std::string* holder = nullptr;
  for (const std::string& candidate : known) {
    if (candidate.find(name) == candidate.npos) continue;
    if (holder) return nullptr;
    holder = &candidate;
  }
  return holder;
}

}  // namespace

const std::string* nearest_name(std::string_view name, std::span<const std::string> known) {
  // Longer names are no names anyone mistyped. Both bounds keep hostile input cheap: a scene may have 10,000
  // names and as many that are not among them.
  constexpr std::size_t k_longest_name = 64, k_most_compared = 100;
  const auto compared = known.first(std::min(known.size(), k_most_compared));
  const std::string* nearest = nullptr;
  std::size_t least = 0;
  for (const std::string& candidate : compared) {
    if (std::max(name.size(), candidate.size()) > k_longest_name) continue;
    const std::size_t distance = distance_to(name, candidate);
    if (nearest && distance >= least) continue;
    nearest = &candidate;
    least = distance;
  }
  // A third of the letters may be wrong, but two in any case (two that changed places count two) unless that
  // is most of the name.
  if (nearest && least <= std::max(std::min<std::size_t>(2, nearest->size() / 2), nearest->size() / 3))
    return nearest;
  return only_holder(name, compared);
}

std::string suggestion(std::string_view name, std::span<const std::string> known) {
  if (known.empty()) return {};
  if (const std::string* meant = nearest_name(name, known)) return "; did you mean '" + *meant + "'?";
  constexpr std::size_t k_most_listed = 24;
  std::string text = known.size() == 1 ? "; the only one known is " : "; known are ";
  const std::size_t listed = std::min(known.size(), k_most_listed);
  for (std::size_t i = 0; i < listed; ++i) {
    if (i > 0) text += i + 1 == known.size() ? " and " : ", ";
    text += known[i];
  }
  return known.size() > listed ? text + ", ..." : text;
}

}  // namespace mallow
