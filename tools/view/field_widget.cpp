#include "view/field_widget.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include <imgui.h>
#include "config/choices.h"
#include "view/slider_span.h"

namespace mallow::view {
namespace {

using scene_file::BoundField;

template <class T>
constexpr ImGuiDataType k_data_type = std::is_same_v<T, int>     ? ImGuiDataType_S32
                                      : std::is_same_v<T, float> ? ImGuiDataType_Float
                                                                 : ImGuiDataType_Double;

template <class T>
bool slider(const BoundField& field, T& value) {
  // While it is dragged its ends stay where they were.
  static ImGuiID dragged = 0;
  static SliderSpan held;
  const ImGuiID id = ImGui::GetID("##value");
  const SliderSpan span = dragged == id ? held : slider_span(field.range, static_cast<double>(value));
  const T low = static_cast<T>(span.low), high = static_cast<T>(span.high);
  const ImGuiSliderFlags flags =
      (span.by_factors ? ImGuiSliderFlags_Logarithmic : 0) | ImGuiSliderFlags_NoRoundToFormat;
  const bool changed = ImGui::SliderScalar("##value", k_data_type<T>, &value, &low, &high,
                                           std::is_same_v<T, int> ? "%d" : "%.4g", flags);
  if (ImGui::IsItemActivated()) {
    dragged = id;
    held = span;
  }
  if (ImGui::IsItemDeactivated()) dragged = 0;
  return changed;
}

/// What is changed of a value of each type that a field may have.
struct Widget {
  const BoundField& field;

  bool operator()(bool* value) const { return ImGui::Checkbox("##value", value); }
  bool operator()(int* value) const { return slider(field, *value); }
  bool operator()(float* value) const { return slider(field, *value); }
  bool operator()(Vec3* value) const {
    return ImGui::DragScalarN("##value", ImGuiDataType_Float, value->data(), 3,
                              0.01f * std::max(0.1f, value->norm()), nullptr, nullptr, "%.3g");
  }
  bool operator()(Count3* value) const {
    return ImGui::DragScalarN("##value", ImGuiDataType_S32, value->data(), 3, 0.2f, nullptr, nullptr, "%d");
  }
  bool operator()(Schedule* value) const {
    if (value->keys().size() > 1) {
      const bool one = ImGui::SmallButton("one value");
      ImGui::SameLine();
      ImGui::TextDisabled("%zu keyframes, %.3g to %.3g", value->keys().size(),
                          static_cast<double>(value->lowest()), static_cast<double>(value->highest()));
      if (one) *value = value->at(0);
      return one;
    }
    float number = value->at(0);
    if (!slider(field, number)) return false;
    *value = number;
    return true;
  }
  bool operator()(std::string* value) const {
    ImGui::TextDisabled("%s", value->c_str());
    return false;
  }
  bool operator()(std::filesystem::path* value) const {
    ImGui::TextDisabled("%s", value->empty() ? "none" : value->string().c_str());
    return false;
  }
  bool operator()(std::vector<Vec3>* value) const {
    ImGui::TextDisabled("%zu points", value->size());
    return false;
  }
  template <class T>
  requires Choice<T>
  bool operator()(T* value) const {
    const auto names = choices(T{});
    int number = static_cast<int>(*value);
    if (!ImGui::Combo("##value", &number, names.data(), static_cast<int>(names.size()))) return false;
    *value = static_cast<T>(number);
    return true;
  }
  /// Left out, or given.
  template <class T>
  bool operator()(std::optional<T>* value) const {
    bool given = value->has_value();
    bool changed = ImGui::Checkbox("##given", &given);
    ImGui::SameLine();
    if (changed) {
      if (given)
        *value = first<T>();
      else
        value->reset();
    }
    if (!given) {
      ImGui::TextDisabled("%s", *field.left_out ? field.left_out : "left out");
      return changed;
    }
    ImGui::SetNextItemWidth(-1);
    if constexpr (std::is_same_v<T, double>)
      return slider(field, **value) || changed;
    else
      return (*this)(&**value) || changed;
  }

 private:
  /// What a setting begins with that was left out.
  template <class T>
  T first() const {
    if constexpr (std::is_arithmetic_v<T>)
      return static_cast<T>(
          std::clamp(1.0, std::max(field.range.lowest, -1e9), std::min(field.range.highest, 1e9)));
    else if constexpr (std::is_same_v<T, Vec3>)
      return Vec3(0.5f, 0.5f, 0.5f);
    else
      return T{};
  }
};

void tooltip(const BoundField& field, const char* remark) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(360);
  ImGui::Text("%s%s%s%s", field.name, *field.unit ? " [" : "", field.unit, *field.unit ? "]" : "");
  ImGui::TextWrapped("%s", field.doc);
  ImGui::TextDisabled("%s", scene_file::allowed(field).c_str());
  if (*field.left_out && !field.required()) ImGui::TextDisabled("left out: %s", field.left_out);
  if (remark) ImGui::TextColored(ImVec4(1, 0.75f, 0.35f, 1), "%s", remark);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace

bool field_widget(const BoundField& field, const char* remark) {
  ImGui::PushID(field.name);
  ImGui::AlignTextToFramePadding();
  if (remark)
    ImGui::TextDisabled("%s", field.name);
  else
    ImGui::TextUnformatted(field.name);
  tooltip(field, remark);
  if (*field.unit) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s", field.unit);
    tooltip(field, remark);
  }
  ImGui::SameLine(0.52f * ImGui::GetWindowContentRegionMax().x);
  ImGui::SetNextItemWidth(-1);
  ImGui::BeginGroup();
  ImGui::SetNextItemWidth(-1);
  const bool changed = std::visit(Widget{field}, field.target);
  ImGui::EndGroup();
  tooltip(field, remark);
  ImGui::PopID();
  return changed;
}

bool alpha_widget(Schedule& alpha) {
  float value = alpha.at(0);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(8, 10));
  ImGui::PushStyleVar(ImGuiStyleVar_GrabMinSize, 22);
  ImGui::SetNextItemWidth(-1);
  const bool changed = ImGui::SliderFloat("##alpha", &value, 0, 1, "alpha %.3f");
  ImGui::PopStyleVar(2);
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::TextDisabled("elastic solid");
  ImGui::SameLine(width - ImGui::CalcTextSize("fluid").x);
  ImGui::TextDisabled("fluid");
  if (changed) alpha = value;
  return changed;
}

}  // namespace mallow::view
