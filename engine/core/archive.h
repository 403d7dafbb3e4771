#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/column.h"
#include "mallow/errors.h"
#include "mallow/vec3.h"

namespace mallow {

/// Writes values as they lie in memory. PackingArchive and UnpackingArchive are called alike, so that one
/// list of members does for both ways and cannot drift apart.
class PackingArchive {
 public:
  static constexpr bool k_packs = true;

  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T& value) { append(&value, sizeof(T)); }
  void operator()(const Vec3& value) { append(value.data(), 3 * sizeof(float)); }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint64_t>(text.size()));
    append(text.data(), text.size());
  }
  template <class T>
  void operator()(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value) (*this)(*value);
  }
  template <class T>
  void array(const T* values, std::size_t count) {
    if (count > 0) append(values, count * sizeof(T));
  }
  void columns(const VectorColumn& values) {
    for (std::size_t axis = 0; axis < 3; ++axis) array(values.axis(axis), values.size());
  }
  std::string take() { return std::move(bytes_); }

 private:
  void append(const void* from, std::size_t size) { bytes_.append(static_cast<const char*>(from), size); }

  std::string bytes_;
};

/// Reads the same values back. Trusts nothing: throws ConfigError that names the chunk where bytes are
/// missing or left over, before it allocates for them, and where they are no value of their type.
class UnpackingArchive {
 public:
  static constexpr bool k_packs = false;

  UnpackingArchive(std::string name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& value) { array(&value, 1); }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    if (byte > 1) fail(std::to_string(byte) + " must be 0 or 1");
    value = byte == 1;
  }
  void operator()(Vec3& value) { array(value.data(), 3); }
  void operator()(std::string& text) {
    text.resize(count(1));
    array(text.data(), text.size());
  }
  template <class T>
  void operator()(std::optional<T>& value) {
    bool given = false;
    (*this)(given);
    value.reset();
    if (given) (*this)(value.emplace());
  }
  template <class T>
  void array(T* values, std::size_t count) {
    if (count > bytes_.size() / sizeof(T)) fail("ends too early");
    if (count == 0) return;
    std::memcpy(static_cast<void*>(values), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
  }
  /// `count` points, which have to be finite.
  void columns(VectorColumn& values, std::size_t count) {
    if (count > bytes_.size() / (3 * sizeof(float))) fail("ends too early");
    values.resize(count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      array(values.axis(axis), count);
      for (std::size_t i = 0; i < count; ++i)
        if (!std::isfinite(values.axis(axis)[i])) fail("row " + std::to_string(i) + " is not finite");
    }
  }
  /// How many things of at least `bytes_each` follow.
  std::size_t count(std::size_t bytes_each) {
    std::uint64_t value = 0;
    (*this)(value);
    if (value > bytes_.size() / bytes_each) fail("ends too early");
    return static_cast<std::size_t>(value);
  }
  std::size_t remaining() const { return bytes_.size(); }
  void finish() const {
    if (!bytes_.empty()) fail(std::to_string(bytes_.size()) + " bytes are left over");
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigError("saved state, chunk '" + name_ + "'", message);
  }

 private:
  std::string name_;
  std::string_view bytes_;
};

}  // namespace mallow
