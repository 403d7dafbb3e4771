#pragma once

#include <array>
#include <charconv>
#include <optional>
#include <string>

namespace mallow::sweep {

/// The shortest text that reads back as the same number.
inline std::string number_text(double value) {
  std::array<char, 40> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Nothing where the whole text is no number.
inline std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace mallow::sweep
