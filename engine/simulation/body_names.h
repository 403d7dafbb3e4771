#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "mallow/ids.h"

namespace mallow {

struct BodyState;

/// Bodies by what they are called: kept from the first time that somebody looks for a name on.
class BodyNames {
 public:
  bool is_kept() const { return is_kept_; }
  /// They are kept from now on; whoever is there has to be added.
  void keep() { is_kept_ = true; }
  /// Somebody comes, or goes. Nothing where they are not kept.
  void add(const BodyState& body);
  void erase(const BodyState& body);
  /// All of this name, in no order.
  const std::vector<BodyId>& of(std::string_view name) const;

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::unordered_map<std::string, std::vector<BodyId>, Hash, std::equal_to<>> ids_;
  bool is_kept_ = false;
};

}  // namespace mallow
