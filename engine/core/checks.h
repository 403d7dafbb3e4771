#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/errors.h"
#include "mallow/vec3.h"

namespace mallow {

/// Collects what is wrong with a config, so that all of it is said at once.
class Checks {
 public:
  /// `value` must be finite and `ok`; `allowed` says what is.
  template <class T>
  void number(const std::string& field, T value, bool ok, std::string_view allowed) {
    if (ok && std::isfinite(static_cast<double>(value))) return;
    std::ostringstream text;
    text << value << " is not allowed: " << allowed;
    problem(field, text.str());
  }
  void vector(const std::string& field, const Vec3& value) {
    if (value.allFinite()) return;
    std::ostringstream text;
    text << '(' << value.transpose() << ") is not allowed: finite numbers";
    problem(field, text.str());
  }
  void problem(std::string field, std::string message) {
    problems_.push_back({.field = std::move(field), .message = std::move(message)});
  }
  /// Throws ConfigError if anything was wrong.
  void finish() {
    if (!problems_.empty()) throw ConfigError(std::move(problems_));
  }

 private:
  std::vector<Problem> problems_;
};

}  // namespace mallow
