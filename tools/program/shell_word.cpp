#include "program/shell_word.h"

#include <string_view>

namespace mallow::program {

std::string shell_word(const std::string& text) {
  constexpr std::string_view k_plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!text.empty() && text.find_first_not_of(k_plain) == text.npos && text.front() != '-') return text;
  // A name that starts with '-' would be an option.
  std::string word = text.starts_with('-') ? "'./" : "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + '\'';
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : " ") + (word.starts_with("--") ? word : shell_word(word));
  return line;
}

}  // namespace mallow::program
