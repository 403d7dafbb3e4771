#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mallow {

/// The largest file that is read or written: just under 2 GiB. A file is held in memory as a whole, and with
/// this many bytes every line number fits an int and every vertex index 32 bits.
inline constexpr std::uint64_t k_max_file_bytes = 0x7fffffff;
/// Corners of one polygon.
inline constexpr std::uint64_t k_max_polygon_corners = 1u << 20;

/// Vertices, triangles or points of one file: more than anything here simulates, and not more than 1.2 GB a
/// column.
inline constexpr std::uint64_t k_max_rows = 100'000'000;

/// Throws IoError about a file as a whole.
[[noreturn]] void fail_file(const std::filesystem::path& file, std::string message);

/// "3 triangles", "1 triangle": for messages.
std::string counted(std::uint64_t count, const std::string& noun);

/// ".ply" of "Bunny.PLY".
std::string lower_case_ending(const std::filesystem::path& file);

/// What a file holds. Throws IoError for one that is missing, unreadable, empty, larger than
/// k_max_file_bytes, or not a regular file.
std::string read_whole_file(const std::filesystem::path& file);

/// Throws IoError if a file of this size could not be read again.
void require_readable_size(const std::filesystem::path& file, std::uint64_t bytes);

/// "at most 100000000 triangles are allowed" where there are more, else empty: readers ask before they take
/// memory.
std::string why_too_many(std::uint64_t count, const char* nouns);

/// Takes numbers of a known byte order from a span of bytes and never leaves it.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::endian order) : bytes_(bytes), order_(order) {}

  std::size_t remaining() const { return bytes_.size(); }

  /// The next number, or nothing where too few bytes are left.
  template <class T>
  std::optional<T> read() {
    if (bytes_.size() < sizeof(T)) return std::nullopt;
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data(), sizeof(T));
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    bytes_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(raw);
  }

  /// Passes over `count` bytes; false, and nothing passed over, where fewer are left.
  bool skip(std::uint64_t count) {
    if (count > bytes_.size()) return false;
    bytes_.remove_prefix(static_cast<std::size_t>(count));
    return true;
  }

 private:
  std::string_view bytes_;
  std::endian order_;
};

}  // namespace mallow
