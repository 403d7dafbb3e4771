#include "scene/bound_field.h"

#include <array>
#include <type_traits>

#include "scene/document.h"

namespace mallow::scene_file {
namespace {

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
  std::string operator()(const std::vector<Vec3>* points) const {
    std::string text;
    for (const Vec3& point : *points) text += (text.empty() ? "[" : ", ") + (*this)(&point);
    return text.empty() ? text : text + ']';
  }
  std::string operator()(const Schedule* schedule) const {
    const std::vector<ScheduleKey>& keys = schedule->keys();
    if (keys.size() == 1 && keys[0].time == 0) return number_text(keys[0].value);
    std::string text = "[";
    for (const ScheduleKey& key : keys)
      text += (text.size() > 1 ? ", " : "") + list_text(std::array{key.time, key.value});
    return text + ']';
  }
  template <class T>
  std::string operator()(const std::optional<T>* value) const {
    return *value ? (*this)(&**value) : "";
  }
};

struct Allowed {
  Range range;
  std::string operator()(const std::string*) const { return "a string"; }
  std::string operator()(const std::filesystem::path*) const { return "the name of a file, a string"; }
  std::string operator()(const std::vector<Vec3>*) const { return "a list of points, each of 3 numbers"; }
  template <class T>
  std::string operator()(const T*) const {
    return mallow::allowed<T>(range);
  }
};

}  // namespace

std::string key_of_schedule(const BoundField& field) {
  return std::string_view(field.name).ends_with("_by_temperature") ? "temperature" : "time";
}

std::string allowed(const BoundField& field) {
  std::string text = std::visit(Allowed{field.range}, field.target);
  const std::string time = "time", key = key_of_schedule(field);
  if (key == time) return text;
  for (std::size_t at = text.find(time); at != text.npos; at = text.find(time, at + key.size()))
    text.replace(at, time.size(), key);
  return text;
}

std::string value_text(const BoundField& field) {
  return std::visit(ValueText{}, field.target);
}

}  // namespace mallow::scene_file
