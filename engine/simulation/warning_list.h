#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "simulation/state.h"

namespace mallow {

/// Warnings in the order in which they are found.
class WarningList {
 public:
  template <class... Words>
  void add(const Words&... words) {
    std::ostringstream text;
    (text << ... << words);
    list_.push_back(text.str());
  }
  /// Of a body, by its name.
  template <class... Words>
  void add(const BodyState& body, const Words&... words) {
    add("body '", body.name, "': ", words...);
  }
  std::vector<std::string> take() { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

}  // namespace mallow
