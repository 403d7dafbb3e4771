#include "program/frame_range.h"

#include <array>
#include <charconv>
#include <optional>

#include "mallow/errors.h"

namespace mallow::program {
namespace {

[[noreturn]] void refuse(const std::string& text) {
  throw ConfigError("--frames", "'" + text +
                                    "' is not allowed: A:B or A:B:S as in Python, B not included, whole "
                                    "numbers, S >= 1; negative ones count from the end");
}

std::optional<long long> whole_number(const std::string& part, const std::string& text) {
  if (part.empty()) return std::nullopt;
  int value = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc() || end != part.data() + part.size()) refuse(text);
  return value;
}

}  // namespace

std::vector<int> choose_frames(const std::string& text, const std::vector<int>& frames) {
  if (text.empty() || frames.empty()) return frames;
  std::array<std::string, 3> parts;
  std::size_t part = 0;
  for (const char c : text)
    if (c != ':')
      parts[part] += c;
    else if (++part == parts.size())
      refuse(text);
  if (part == 0) refuse(text);  // one number alone is as likely meant as a count
  const long long behind = frames.back() + 1;
  const auto place = [&](const std::string& number, long long left_out) {
    const long long value = whole_number(number, text).value_or(left_out);
    return value < 0 ? value + behind : value;
  };
  const long long first = std::max(place(parts[0], 0), 0LL), end = place(parts[1], behind);
  const long long stride = whole_number(parts[2], text).value_or(1);
  if (stride < 1) refuse(text);
  std::vector<int> chosen;
  for (const int frame : frames)
    if (frame >= first && frame < end && (frame - first) % stride == 0) chosen.push_back(frame);
  if (chosen.empty())
    throw ConfigError("--frames", "'" + text + "' names none of the frames " +
                                      std::to_string(frames.front()) + " to " +
                                      std::to_string(frames.back()) + " that there are");
  return chosen;
}

std::string frames_text(std::span<const int> frames) {
  constexpr int k_most_ranges = 8;
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  int ranges = 0;
  for (std::size_t i = 0; i < frames.size(); ++i, ++ranges) {
    if (ranges == k_most_ranges) return text + " and " + std::to_string(frames.size() - i) + " more";
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    text += (i > 0 ? ", " : "") + std::to_string(frames[i]);
    if (last > i) text += (last > i + 1 ? " to " : ", ") + std::to_string(frames[last]);
    i = last;
  }
  return text;
}

}  // namespace mallow::program
