#include "scene/field_table.h"

#include <cmath>
#include <cstdint>

#include "scene/document.h"

namespace mallow::scene_file {
namespace {

/// 0.5 as "0.5" and 3 as "3", for messages.
std::string bound_text(double bound) {
  if (bound == std::round(bound) && std::abs(bound) < 1e15)
    return std::to_string(static_cast<std::int64_t>(bound));
  return number_text(bound);
}

/// " > 0", " in [0, 1]", or nothing where every finite number is allowed.
std::string range_text(const Range& range) {
  const bool from_below = std::isfinite(range.lowest);
  const bool from_above = std::isfinite(range.highest);
  if (from_below && from_above)
    return std::string(" in ") + (range.above_lowest ? "(" : "[") + bound_text(range.lowest) + ", " +
           bound_text(range.highest) + "]";
  if (from_below) return (range.above_lowest ? " > " : " >= ") + bound_text(range.lowest);
  if (from_above) return " <= " + bound_text(range.highest);
  return {};
}

template <class Values>
std::string list_text(const Values& values) {
  std::string text = "[";
  for (const auto value : values) {
    if (text.size() > 1) text += ", ";
    if constexpr (std::is_integral_v<std::remove_const_t<decltype(value)>>)
      text += std::to_string(value);
    else
      text += number_text(value);
  }
  return text + ']';
}

struct ValueText {
  std::string operator()(const bool* flag) const { return *flag ? "true" : "false"; }
  std::string operator()(const int* number) const { return std::to_string(*number); }
  std::string operator()(const float* number) const { return number_text(*number); }
  std::string operator()(const double* number) const { return number_text(*number); }
  std::string operator()(const Vec3* v) const { return list_text(std::array{v->x(), v->y(), v->z()}); }
  std::string operator()(const Count3* count) const { return list_text(*count); }
  std::string operator()(const std::string* text) const { return text->empty() ? "" : toml_string(*text); }
  std::string operator()(const std::filesystem::path* path) const { return (*this)(&path->native()); }
  template <Choice T>
  std::string operator()(const T* choice) const {
    return toml_string(choices(T{})[static_cast<std::size_t>(*choice)]);
  }
  std::string operator()(const InstructionLevel* level) const { return toml_string(name(*level)); }
  std::string operator()(const AlphaSchedule* alpha) const {
    const std::vector<AlphaKey>& keys = alpha->keys();
    if (keys.size() == 1 && keys[0].time == 0) return number_text(keys[0].alpha);
    std::string text = "[";
    for (const AlphaKey& key : keys)
      text += (text.size() > 1 ? ", " : "") + list_text(std::array{key.time, key.alpha});
    return text + ']';
  }
  template <class T>
  std::string operator()(const std::optional<T>* value) const {
    return *value ? (*this)(&**value) : "";
  }
};

struct Allowed {
  std::string range;
  std::string operator()(const bool*) const { return "true or false"; }
  std::string operator()(const int*) const { return "a whole number" + range; }
  std::string operator()(const double*) const {
    return (range.empty() ? "a finite number" : "a number") + range;
  }
  std::string operator()(const float*) const { return (*this)(static_cast<const double*>(nullptr)); }
  std::string operator()(const Vec3*) const {
    return (range.empty() ? "3 finite numbers [x, y, z]" : "3 numbers") + range;
  }
  std::string operator()(const Count3*) const { return "3 whole numbers" + range; }
  std::string operator()(const std::string*) const { return "a string"; }
  std::string operator()(const std::filesystem::path*) const { return "the name of a file, a string"; }
  std::string operator()(const AlphaSchedule*) const {
    return "a number" + range + ", or [[time, alpha], ...] with times that increase and alphas" + range;
  }
  template <Choice T>
  std::string operator()(const T*) const {
    constexpr auto k_names = choices(T{});
    std::string text = toml_string(k_names[0]);
    for (std::size_t i = 1; i < k_names.size(); ++i)
      text += (i + 1 < k_names.size() ? ", " : " or ") + toml_string(k_names[i]);
    return text;
  }
  std::string operator()(const InstructionLevel*) const {
    std::string text;
    for (const InstructionLevel level : k_instruction_levels)
      text += (text.empty() ? "one of " : ", ") + toml_string(name(level));
    return text;
  }
  template <class T>
  std::string operator()(const std::optional<T>*) const {
    return (*this)(static_cast<const T*>(nullptr));
  }
};

}  // namespace

std::string allowed(const Field& field) {
  return std::visit(Allowed{range_text(field.range)}, field.target);
}

std::string value_text(const Field& field) {
  return std::visit(ValueText{}, field.target);
}

}  // namespace mallow::scene_file
