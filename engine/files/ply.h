#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/byte_reader.h"
#include "files/text_reader.h"
#include "mallow/vec3.h"

/// PLY files as Greg Turk defined them (Stanford, 1994): ascii, binary_little_endian and
/// binary_big_endian 1.0.
namespace mallow {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bodies are numbered in 32 bits.
inline constexpr std::uint64_t k_most_bodies = std::uint64_t{1} << 32;
/// The type of bodies that take so many bytes each, of body_bytes().
constexpr const char* ply_body_type(std::size_t bytes) {
  return bytes == 1 ? "uchar" : "uint";
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> length_type;  ///< of a list: what its length is written as
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  int line = 0;  ///< where it is declared

  std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;

  const PlyElement* find(std::string_view element) const;
};

/// Reads a header up to and with end_header. Every word of it must be known, and `text.rest()` must be long
/// enough to hold the rows that it promises, so that a caller may reserve memory for them. Throws IoError.
PlyHeader read_ply_header(TextReader& text);

/// Goes through the rows of a PLY file in the order of the file. What is not asked for is passed over.
class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file);
  PlyReader(const PlyReader&) = delete;  // its members look into each other
  PlyReader& operator=(const PlyReader&) = delete;

  const PlyHeader& header() const { return header_; }
  /// The element of that name. Throws IoError that lists those there are.
  const PlyElement& require(std::string_view element) const;
  /// Indices of three properties, all scalars: all of them or, if none is there and `needed` is false,
  /// nothing.
  std::optional<std::array<std::size_t, 3>> find_vector(const PlyElement& element,
                                                        const std::array<const char*, 3>& names,
                                                        bool needed) const;
  /// Index of a scalar property, or nothing. Throws IoError if it is a list.
  std::optional<std::size_t> find_scalar(const PlyElement& element, std::string_view name) const;

  /// Goes to the next element, past all rows of the one before; null at the end.
  const PlyElement* next_element();
  /// Names the list property whose values next_row() keeps.
  void keep_list(std::size_t property) { kept_list_ = property; }
  /// Goes to the next row of the element; false at its end.
  bool next_row();

  double value(std::size_t property) const { return values_[property]; }
  /// Three numbers that single precision holds too.
  Eigen::Vector3d finite_point(const std::array<std::size_t, 3>& properties) const;
  Vec3 finite_vector(const std::array<std::size_t, 3>& properties) const {
    return finite_point(properties).cast<float>();
  }
  /// A whole number in [0, limit); `what` is said in the message.
  std::uint32_t index(double value, std::uint64_t limit, const char* what) const;
  std::span<const double> list() const { return list_; }

  /// Throws IoError about the file as a whole.
  [[noreturn]] void fail(const std::string& message) const;
  /// Throws IoError about the value of a property in the current row; allowed: "0 to 1".
  [[noreturn]] void fail_value(std::size_t property, const std::string& allowed) const;
  /// Throws IoError about a property of the current row.
  [[noreturn]] void fail_row(const std::string& property, const std::string& message) const;

 private:
  void read_list(std::size_t property);
  double read_scalar(PlyType type);
  double read_binary(PlyType type);
  double read_ascii(PlyType type);

  std::filesystem::path file_;
  std::string content_;
  TextReader text_;
  PlyHeader header_;
  ByteReader bytes_;  ///< the rows, unless the format is ascii

  std::size_t next_ = 0;  ///< index of the element after the current one
  const PlyElement* element_ = nullptr;
  std::uint64_t rows_read_ = 0;
  std::optional<std::size_t> kept_list_;
  std::vector<double> values_;  ///< of the row, by property; a list's is its length
  std::vector<double> list_;
};

}  // namespace mallow
