#include "files/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "files/byte_reader.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

constexpr std::string_view k_spaces = " \t\v\f\r";
constexpr std::size_t k_longest_quote = 40;

}  // namespace

std::optional<double> parse_number(std::string_view word) {
  // from_chars does not know the plus sign that exporters write.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view text) {
  std::string shown(text.substr(0, k_longest_quote));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return '\'' + shown + (text.size() > k_longest_quote ? "...'" : "'");
}

TextReader::TextReader(const std::filesystem::path& file, std::string_view text) : file_(&file), rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool TextReader::next_line() {
  if (rest_.empty()) return false;
  ++line_number_;
  at_ = word_begin_ = 0;
  cells_left_ = true;
  const std::size_t end = rest_.substr(0, k_max_line_bytes + 1).find('\n');
  if (end == std::string_view::npos && rest_.size() > k_max_line_bytes) {
    fail("", "the line is too long: at most " + std::to_string(k_max_line_bytes) + " bytes are allowed");
  }
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  return true;
}

bool TextReader::next_filled_line() {
  while (next_line()) {
    line_ = line_.substr(0, line_.find('#'));
    if (line_.find_first_not_of(k_spaces) != std::string_view::npos) return true;
  }
  return false;
}

std::string_view TextReader::word() {
  word_begin_ = std::min(line_.find_first_not_of(k_spaces, at_), line_.size());
  at_ = std::min(line_.find_first_of(k_spaces, word_begin_), line_.size());
  return line_.substr(word_begin_, at_ - word_begin_);
}

std::string_view TextReader::rest_of_line() {
  word_begin_ = std::min(line_.find_first_not_of(k_spaces, at_), line_.size());
  at_ = line_.size();
  return line_.substr(word_begin_);
}

std::optional<std::string_view> TextReader::cell(char separator) {
  if (!cells_left_) return std::nullopt;
  // A tab that separates cells is no space around them.
  const std::string_view spaces = separator == '\t' ? std::string_view(" \v\f\r") : k_spaces;
  word_begin_ = std::min(line_.find_first_not_of(spaces, at_), line_.size());
  std::size_t end = word_begin_;
  if (end < line_.size() && line_[end] == '"') {
    end = line_.find('"', end + 1);
    if (end == std::string_view::npos) fail("", "a quote is opened, but not closed");
  }
  end = std::min(line_.find(separator, end), line_.size());
  word_begin_ = std::min(word_begin_, end);
  cells_left_ = end < line_.size();
  std::string_view text = line_.substr(word_begin_, end - word_begin_);
  at_ = std::min(end + 1, line_.size());
  text = text.substr(0, text.find_last_not_of(spaces) + 1);
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  if (!quoted) return text;
  text = text.substr(1, text.size() - 2);
  text.remove_prefix(std::min(text.find_first_not_of(spaces), text.size()));
  return text.substr(0, text.find_last_not_of(spaces) + 1);
}

double TextReader::number(const char* field) {
  const std::string_view text = word();
  if (text.empty()) fail(field, "is missing; a number is needed");
  const std::optional<double> value = parse_number(text);
  if (!value) fail(field, in_quotes(text) + " is not allowed: a number");
  return *value;
}

std::int64_t TextReader::integer(const char* field, std::int64_t low, std::int64_t high) {
  const std::string_view text = word();
  const auto allowed = [&] {
    return "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  };
  if (text.empty()) fail(field, "is missing; " + allowed() + " is needed");
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || value < low || value > high) {
    fail(field, in_quotes(text) + " is not allowed: " + allowed());
  }
  return value;
}

double TextReader::finite(const char* field, std::string_view text) const {
  if (text.empty()) fail(field, "is missing; a finite number is needed");
  const std::optional<double> value = parse_number(text);
  if (!std::isfinite(static_cast<float>(value.value_or(NAN))))
    fail(field, in_quotes(text) + " is not allowed: a finite number");
  return *value;
}

Eigen::Vector3d TextReader::point() {
  const double x = finite("x", word());
  const double y = finite("y", word());
  const double z = finite("z", word());
  return {x, y, z};
}

void TextReader::fail(std::string field, std::string message) const {
  const int column = line_number_ > 0 ? static_cast<int>(word_begin_) + 1 : 0;
  throw IoError(Problem{.file = file_->string(),
                        .line = line_number_,
                        .column = column,
                        .field = std::move(field),
                        .message = std::move(message)});
}

void require_room(const TextReader& text, std::uint64_t count, const char* nouns) {
  if (count > k_max_rows) text.fail("", why_too_many(count, nouns));
}

}  // namespace mallow
