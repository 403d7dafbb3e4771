#include "program/shell_word.h"

#include <string_view>

namespace mallow::program {
namespace {

/// As it is where a shell takes it so, else in quotes.
std::string quoted(const std::string& text) {
  constexpr std::string_view k_plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!text.empty() && text.find_first_not_of(k_plain) == text.npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + '\'';
}

}  // namespace

std::string shell_word(const std::string& text) {
  // A name that starts with '-' would be an option.
  return text.starts_with('-') ? quoted("./" + text) : quoted(text);
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : " ") + (word.starts_with("--") ? quoted(word) : shell_word(word));
  return line;
}

}  // namespace mallow::program
