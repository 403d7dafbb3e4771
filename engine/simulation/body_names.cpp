#include "simulation/body_names.h"

#include <algorithm>

#include "simulation/state.h"

namespace mallow {

void BodyNames::add(const BodyState& body) {
  if (is_kept_) ids_[body.name].push_back(body.id);
}

void BodyNames::erase(const BodyState& body) {
  if (!is_kept_) return;
  const auto named = ids_.find(body.name);
  std::vector<BodyId>& ids = named->second;
  std::swap(*std::ranges::find(ids, body.id), ids.back());
  ids.pop_back();
  if (ids.empty()) ids_.erase(named);
}

const std::vector<BodyId>& BodyNames::of(std::string_view name) const {
  static const std::vector<BodyId> k_nobody;
  const auto named = ids_.find(name);
  return named == ids_.end() ? k_nobody : named->second;
}

}  // namespace mallow
