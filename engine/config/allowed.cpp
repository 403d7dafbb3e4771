#include "config/allowed.h"

#include <cmath>
#include <cstdint>
#include <sstream>

namespace mallow {
namespace {

/// 0.5 as "0.5" and 100000000 as "100000000".
std::string bound_text(double bound) {
  if (bound == std::round(bound) && std::abs(bound) < 1e15)
    return std::to_string(static_cast<std::int64_t>(bound));
  std::ostringstream text;
  text << bound;
  return text.str();
}

std::string quoted(const char* name) {
  return '"' + std::string(name) + '"';
}

}  // namespace

std::string range_text(const Range& range) {
  const bool from_below = std::isfinite(range.lowest);
  const bool from_above = std::isfinite(range.highest);
  if (from_below && from_above)
    return std::string(" in ") + (range.above_lowest ? "(" : "[") + bound_text(range.lowest) + ", " +
           bound_text(range.highest) + "]";
  if (from_below) return (range.above_lowest ? " > " : " >= ") + bound_text(range.lowest);
  if (from_above) return " <= " + bound_text(range.highest);
  return {};
}

std::string choice_text(std::span<const char* const> names) {
  std::string text = quoted(names[0]);
  for (std::size_t i = 1; i < names.size(); ++i)
    text += (i + 1 < names.size() ? ", " : " or ") + quoted(names[i]);
  return text;
}

}  // namespace mallow
