#include <algorithm>
#include <string>

#include <imgui.h>
#include "mallow/materials.h"
#include "view/field_widget.h"
#include "view/panels.h"

namespace mallow::view {
namespace {

using Kind = SettingsSection::Kind;

void draw_preset(SettingsModel& settings, std::size_t material, const Send& send) {
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##preset", "material by name")) return;
  for (const MaterialPreset& preset : material_presets()) {
    if (ImGui::Selectable(preset.name))
      if (auto command = settings.take_preset(material, preset.name)) send(std::move(command));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", preset.about);
  }
  ImGui::EndCombo();
}

/// Alpha of every material, large.
void draw_alphas(SettingsModel& settings, const Send& send) {
  for (const SettingsSection& section : settings.sections()) {
    if (section.kind != Kind::material) continue;
    ImGui::PushID(section.path.c_str());
    ImGui::TextUnformatted(section.title.c_str());
    const auto alpha = std::ranges::find(section.fields, std::string_view("alpha"),
                                         [](const auto& field) { return std::string_view(field.name); });
    if (alpha != section.fields.end())
      if (alpha_widget(*std::get<Schedule*>(alpha->target)))
        if (auto command = settings.command(section, *alpha)) send(std::move(command));
    draw_preset(settings, section.index, send);
    ImGui::PopID();
    ImGui::Spacing();
  }
}

void draw_speed(const Frame& frame, ViewState& state, const Send& send) {
  if (!ImGui::CollapsingHeader("Speed and accuracy", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const int last = static_cast<int>(rungs().size()) - 1;
  // As it is: it changes by itself, too. While it is dragged, where the hand has it.
  int share = last - (state.drags_rung ? state.rung : frame.stats.rung);
  ImGui::TextDisabled("realtime");
  ImGui::SameLine(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize("accurate").x);
  ImGui::TextDisabled("accurate");
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##rung", &share, 0, last, share == last - k_as_written ? "as the scene says" : "")) {
    state.rung = last - share;
    send([rung = state.rung](Session& session) { session.set_rung(rung); });
  }
  if (ImGui::IsItemActivated()) state.rung = frame.stats.rung;
  state.drags_rung = ImGui::IsItemActive();
  bool changed = ImGui::Checkbox("keep", &state.keeps_rate);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  changed |= ImGui::SliderFloat("##target", &state.target, 5, 120, "%.0f frames a second");
  if (changed)
    send([target = state.keeps_rate ? std::optional(static_cast<double>(state.target))
                                    : std::nullopt](Session& session) { session.set_target(target); });
  if (!frame.stats.given_up.empty()) ImGui::TextWrapped("Now: %s", frame.stats.given_up.c_str());
}

/// On a setting that does not act at once.
const char* remark_on(SettingsModel::Acts acts) {
  switch (acts) {
    case SettingsModel::Acts::when_built_anew:
      return "a change waits until the scene is built anew";
    case SettingsModel::Acts::in_pictures_of_runs:
      return "of the pictures that mallow run makes: this window does not show it";
    default:
      return nullptr;
  }
}

void draw_section(SettingsModel& settings, const SettingsSection& section, const Send& send) {
  if (!ImGui::CollapsingHeader((section.title + "##" + section.path).c_str())) return;
  ImGui::PushID(section.path.c_str());
  for (const scene_file::BoundField& field : section.fields)
    if (field_widget(field, remark_on(SettingsModel::acts(section, field))))
      if (auto command = settings.command(section, field)) send(std::move(command));
  ImGui::PopID();
}

}  // namespace

void draw_settings(const Frame& frame, SettingsModel& settings, ViewState& state, const Send& send) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(size.x - k_settings_width, k_top_height));
  ImGui::SetNextWindowSize(
      ImVec2(k_settings_width, size.y - static_cast<float>(k_top_height + state.time_height)));
  ImGui::Begin("settings", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  draw_alphas(settings, send);
  draw_speed(frame, state, send);
  draw_marks_panel(state, send);
  if (settings.waits_for_rebuild() || (!frame.has_scene && !frame.building)) {
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.75f, 0.42f, 0.10f, 1));
    state.rebuild |= ImGui::Button("Build the scene anew", ImVec2(-1, 0));
    ImGui::PopStyleColor();
    ImGui::TextWrapped(frame.has_scene ? "Some of what you changed cannot change while a scene runs."
                                       : "The scene cannot be built as it is set.");
  }
  for (const SettingsSection& section : settings.sections()) draw_section(settings, section, send);
  ImGui::End();
}

}  // namespace mallow::view
