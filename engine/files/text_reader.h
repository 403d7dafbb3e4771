#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "mallow/vec3.h"

namespace mallow {

/// The longest line of a text file [bytes].
inline constexpr std::size_t k_max_line_bytes = std::size_t{1} << 20;

/// A whole word as a number, whatever the locale; nan and inf are numbers here. Nothing if it is not one, or
/// beyond the range of double.
std::optional<double> parse_number(std::string_view word);

/// The text between quotes, cut short and with `?` for what cannot be printed: fit for a message.
std::string in_quotes(std::string_view text);

/// Takes words and numbers from a text line by line and knows where each stood, for messages. Lines end with
/// LF or CR LF; a byte order mark is passed over. Throws IoError that names file, line, column and field.
class TextReader {
 public:
  /// Both must outlive it and its copies.
  TextReader(const std::filesystem::path& file, std::string_view text);

  /// Goes on to the next line; false at the end of the text.
  bool next_line();
  /// Goes on to the next line that is not blank once a comment from `#` on is cut off.
  bool next_filled_line();

  std::string_view line() const { return line_; }
  int line_number() const { return line_number_; }
  /// Everything after the current line.
  std::string_view rest() const { return rest_; }

  /// The next word of the line; empty at its end.
  std::string_view word();
  /// All words of the line that are left, as one.
  std::string_view rest_of_line();
  /// What stands up to the next separator, without the spaces and the double quotes around it; nothing at the
  /// end of the line. A separator in quotes is text.
  std::optional<std::string_view> cell(char separator = ',');

  /// The next word as a number; nan and inf are left to the caller.
  double number(const char* field);
  /// The next word as a whole number in [low, high].
  std::int64_t integer(const char* field, std::int64_t low, std::int64_t high);
  /// A word as a number that single precision holds too.
  double finite(const char* field, std::string_view text) const;
  /// The next three words as a point.
  Eigen::Vector3d point();

  /// Throws IoError about the last word of this line.
  [[noreturn]] void fail(std::string field, std::string message) const;

 private:
  const std::filesystem::path* file_;
  std::string_view rest_;
  std::string_view line_;
  std::size_t at_ = 0;          ///< how much of line_ is taken
  std::size_t word_begin_ = 0;  ///< where the last word began
  bool cells_left_ = true;      ///< whether another cell() follows
  int line_number_ = 0;
};

/// Throws IoError at this place where there are more rows than a file may have.
void require_room(const TextReader& text, std::uint64_t count, const char* nouns);

}  // namespace mallow
