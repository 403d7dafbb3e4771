#include "scene/document_scan.h"

#include <string>
#include <utility>

#include "files/text_reader.h"

namespace mallow::scene_file {
namespace {

/// Goes through a text once, and knows of TOML only where strings and comments begin and end.
class Scan {
 public:
  explicit Scan(std::string_view text) : text_(text) {
    constexpr std::string_view k_byte_order_mark = "\xEF\xBB\xBF";
    if (text_.starts_with(k_byte_order_mark)) text_.remove_prefix(k_byte_order_mark.size());
  }

  std::optional<DocumentFault> run() {
    for (; at_ < text_.size(); ++at_) {
      const auto byte = static_cast<unsigned char>(text_[at_]);
      const bool continues_character = (byte & 0xC0) == 0x80;
      if (!continues_character) ++place_.column;
      if (byte >= 0x80 && !(closing_.size() == 1 && letters_))
        return fault(
            "a character beyond ASCII is not allowed here, only in comments and in strings of one line that "
            "follow white space");
      if (at_ - line_begin_ > k_max_line_bytes)
        return fault("the line is too long: at most " + std::to_string(k_max_line_bytes) +
                     " bytes are allowed");
      if (closing_.empty()) {
        if (auto found = pass_outside()) return found;
      } else {
        pass_inside();
      }
      if (text_[at_] == '\n') end_line();
    }
    return std::nullopt;
  }

 private:
  DocumentFault fault(std::string message) const { return {place_, std::move(message)}; }

  void skip(std::size_t count) {
    at_ += count;
    place_.column += static_cast<int>(count);
  }

  /// A character outside of strings and comments.
  std::optional<DocumentFault> pass_outside() {
    const char c = text_[at_];
    if (c == '#') {
      closing_ = "\n";
      letters_ = true;
    } else if (c == '"' || c == '\'') {
      const std::string_view quotes = c == '"' ? "\"\"\"" : "'''";
      closing_ = text_.substr(at_, 3) == quotes ? quotes : quotes.substr(0, 1);
      // Behind anything else the parser may still be within a number, which it reads to the next white space.
      letters_ = at_ == 0 || std::string_view(" \t\n,").find(text_[at_ - 1]) != std::string_view::npos;
      skip(closing_.size() - 1);
    } else if (c == '.') {
      if (++key_points_ > k_max_key_points)
        return fault("keys are nested too deeply here: at most " + std::to_string(k_max_key_points + 1) +
                     " levels are allowed");
      return count_value();
    } else if (c == '[' || c == '{') {
      key_points_ = 0;
      if (++nesting_ > k_max_nesting)
        return fault("tables and lists are nested too deeply here: at most " + std::to_string(k_max_nesting) +
                     " levels are allowed");
      return count_value();
    } else if (c == ']' || c == '}') {
      key_points_ = 0;
      if (nesting_ > 0) --nesting_;
    } else if (c == ',' || c == '=') {
      key_points_ = 0;
      return count_value();
    }
    return std::nullopt;
  }

  /// A character of a string or comment.
  void pass_inside() {
    const bool escapes = closing_.starts_with('"');
    if (escapes && text_[at_] == '\\' && at_ + 1 < text_.size() &&
        (text_[at_ + 1] == '"' || text_[at_ + 1] == '\\')) {
      skip(1);
    } else if (text_.substr(at_, closing_.size()) == closing_) {
      const char last = closing_.back();
      skip(closing_.size() - 1);
      // A string of several lines may end with one or two quotes of its own before the three that close it.
      for (int more = 0; closing_.size() == 3 && more < 2 && text_.substr(at_ + 1).starts_with(last); ++more)
        skip(1);
      closing_ = {};
    }
  }

  void end_line() {
    if (closing_.size() == 1) closing_ = {};  // a string of one line that was never closed
    ++place_.line;
    place_.column = 0;
    line_begin_ = at_ + 1;
    key_points_ = 0;
  }

  std::optional<DocumentFault> count_value() {
    if (++values_ <= k_max_values) return std::nullopt;
    return fault("the file has too many values: at most " + std::to_string(k_max_values) + " are allowed");
  }

  std::string_view text_;
  std::size_t at_ = 0;
  Place place_{.line = 1, .column = 0};
  std::string_view closing_{};  ///< of the string or comment that is being read; empty outside of both
  bool letters_ = false;        ///< it may hold characters beyond ASCII
  std::size_t line_begin_ = 0;
  std::size_t nesting_ = 0;
  std::size_t key_points_ = 0;
  std::size_t values_ = 0;
};

}  // namespace

std::optional<DocumentFault> find_fault(std::string_view text) {
  return Scan(text).run();
}

}  // namespace mallow::scene_file
