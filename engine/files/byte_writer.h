#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <span>
#include <string>

#include "mallow/vec3.h"

namespace mallow {

template <class T>
void append_little_endian(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

inline void append_little_endian(std::string& bytes, const Vec3& vector) {
  for (const float value : vector) append_little_endian(bytes, value);
}

/// Bytes that a file takes for each body of a column: 1 where all are below 256, which more programs read, 4
/// where not.
inline std::size_t body_bytes(std::span<const std::uint32_t> bodies) {
  return std::all_of(bodies.begin(), bodies.end(), [](std::uint32_t body) { return body < 256; }) ? 1 : 4;
}

/// bytes: of body_bytes()
inline void append_body(std::string& text, std::uint32_t body, std::size_t bytes) {
  if (bytes == 1)
    append_little_endian(text, static_cast<std::uint8_t>(body));
  else
    append_little_endian(text, body);
}

/// printf's %.<digits>g, whatever the locale.
template <class T>
void append_number(std::string& text, T value, int digits) {
  std::array<char, 64> raw;
  const auto result =
      std::to_chars(raw.data(), raw.data() + raw.size(), value, std::chars_format::general, digits);
  text.append(raw.data(), result.ptr);
}

/// The shortest text that gives back the same number, whatever the locale.
template <class T>
void append_shortest(std::string& text, T value) {
  std::array<char, 64> raw;
  const auto result = std::to_chars(raw.data(), raw.data() + raw.size(), value);
  text.append(raw.data(), result.ptr);
}

/// Significant digits that give back the same number.
inline constexpr int k_float_digits = 9;
inline constexpr int k_double_digits = 17;

}  // namespace mallow
