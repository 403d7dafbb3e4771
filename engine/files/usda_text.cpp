#include "files/usda_text.h"

#include <cmath>

#include "mallow/errors.h"

namespace mallow {
namespace {

void require_positive(const char* field, double rate) {
  if (std::isfinite(rate) && rate > 0) return;
  throw ConfigError(field, std::to_string(rate) + " is not allowed: > 0");
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string in_usd_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    // A string in such quotes stays on one line.
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace

void require_valid(const UsdOptions& options) {
  require_positive("options.frames_per_second", options.frames_per_second);
  require_positive("options.speed", options.speed);
}

std::string usd_header(const UsdOptions& options, std::optional<int> first, std::optional<int> last) {
  std::string text = "#usda 1.0\n(\n    defaultPrim = \"surface\"\n";
  if (last) text += "    endTimeCode = " + std::to_string(*last) + '\n';
  append_shortest(text += "    framesPerSecond = ", options.frames_per_second);
  text += "\n    metersPerUnit = 1\n";
  if (first) text += "    startTimeCode = " + std::to_string(*first) + '\n';
  append_shortest(text += "    timeCodesPerSecond = ", options.frames_per_second);
  text += options.up == UpAxis::y ? "\n    upAxis = \"Y\"\n)\n\n" : "\n    upAxis = \"Z\"\n)\n\n";
  return text;
}

std::string usd_name(std::string name) {
  for (char& c : name)
    if (!is_name_character(c)) c = '_';
  return name[0] >= '0' && name[0] <= '9' ? '_' + name : name;
}

void append_interpolation(std::string& text, const UsdAttribute& attribute) {
  if (*attribute.interpolation == '\0') return;
  const std::string indent(attribute.depth * 4, ' ');
  text += " (\n" + indent + "    interpolation = \"" + attribute.interpolation + "\"\n" + indent + ')';
}

void append_display_name(std::string& text, std::size_t depth, const std::string& name,
                         const std::string& title) {
  if (name != title) text += std::string(depth * 4, ' ') + "displayName = " + in_usd_quotes(title) + '\n';
}

}  // namespace mallow
