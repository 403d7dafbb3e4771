#include <algorithm>
#include <cmath>
#include <limits>

#include <imgui.h>
#include "view/panels.h"

namespace mallow::view {
namespace {

/// A button that shows that it is on.
bool toggle(const char* label, bool is_on) {
  if (is_on) ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.75f, 0.42f, 0.10f, 1));
  const bool pressed = ImGui::Button(label);
  if (is_on) ImGui::PopStyleColor();
  return pressed;
}

float width_of(const char* label) {
  return ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x;
}

/// The next thing is on the line of the last one where so many pixels are left, else on the next line.
void beside(ViewState& state, float width, float gap = 4) {
  state.time_bar_end = std::max(state.time_bar_end, ImGui::GetItemRectMax().x);
  const float end = ImGui::GetItemRectMax().x + gap + width;
  if (end <= ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) ImGui::SameLine(0, gap);
}

void help_of(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

void draw_tools(ViewState& state) {
  for (std::size_t k = 0; k < k_tool_names.size(); ++k) {
    if (k > 0) beside(state, width_of(k_tool_names[k]));
    if (toggle(k_tool_names[k], state.tool == static_cast<Tool>(k))) state.tool = static_cast<Tool>(k);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%zu: %s", k + 1, k_tool_docs[k]);
  }
  beside(state, 90, 8);
  ImGui::SetNextItemWidth(90);
  ImGui::SliderFloat("##strength", &state.strength, 0.1f, 10, "x %.2g", ImGuiSliderFlags_Logarithmic);
  help_of("strength of what the mouse does");
}

void draw_shown(ViewState& state, const Send& send) {
  const Drawn drawn = state.drawn;
  const Shown shown = state.shown;
  if (toggle("surface", drawn == Drawn::surface)) state.drawn = Drawn::surface;
  beside(state, width_of("particles"));
  if (toggle("particles", drawn == Drawn::particles)) state.drawn = Drawn::particles;
  help_of("P: surface or particles");
  beside(state, 110);
  ImGui::SetNextItemWidth(110);
  int number = static_cast<int>(shown);
  if (ImGui::Combo("##shown", &number, k_shown_names.data(), static_cast<int>(k_shown_names.size()))) {
    state.shown = static_cast<Shown>(number);
    state.drawn = Drawn::particles;
  }
  help_of("what particles are coloured by");
  if (state.drawn != drawn || state.shown != shown)
    send([now = state.drawn, what = state.shown](Session& session) { session.show(now, what); });
}

void draw_rewind(const Frame& frame, ViewState& state, float width) {
  const FrameStats& stats = frame.stats;
  ImGui::SetNextItemWidth(width);
  double time = stats.time;
  const double low = stats.oldest, high = std::max(stats.newest, stats.time);
  if (ImGui::SliderScalar("##time", ImGuiDataType_Double, &time, &low, &high, "%.3f s")) state.go_to = time;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%zu saved states, %.0f MB: drag to go back; what follows is the same to the last bit",
                      stats.moments, static_cast<double>(stats.moment_bytes) / 1e6);
}

void draw_pace(ViewState& state, const Send& send) {
  beside(state, 110, 8);
  ImGui::SetNextItemWidth(110);
  float speed = static_cast<float>(state.speed);
  bool changed = ImGui::SliderFloat("##speed", &speed, 0.05f, 4, "speed %.2f", ImGuiSliderFlags_Logarithmic);
  help_of("[ and ]: slow motion; 1 is the pace of a film");
  state.speed = static_cast<double>(speed);
  const char* const fastest = "as fast as it goes";
  beside(state, width_of(fastest) + ImGui::GetFrameHeight(), 8);
  changed |= ImGui::Checkbox(fastest, &state.as_fast_as_possible);
  if (changed)
    send([now = state.as_fast_as_possible ? std::numeric_limits<double>::infinity()
                                          : state.speed](Session& session) { session.set_speed(now); });
}

}  // namespace

void draw_time_bar(const Frame& frame, ViewState& state, bool recording, const Send& send) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const auto height = static_cast<float>(state.time_height);
  ImGui::SetNextWindowPos(ImVec2(0, size.y - height));
  ImGui::SetNextWindowSize(ImVec2(size.x, height));
  ImGui::Begin(
      "time", nullptr,
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoSavedSettings);
  state.time_bar_end = 0;
  if (toggle(frame.paused ? "Play" : "Pause", !frame.paused)) state.pause = true;
  help_of("Space");
  beside(state, width_of("Step"));
  state.step |= ImGui::Button("Step");
  help_of(". (period): one step");
  beside(state, width_of("Back"));
  state.back |= ImGui::Button("Back");
  help_of("Backspace: to the saved state before this one");
  beside(state, width_of("Reset"));
  state.reset |= ImGui::Button("Reset");
  help_of("R: to the start, with the settings as they are now");
  const float rewind = std::max(120.0f, size.x - 620);
  beside(state, rewind, 8);
  draw_rewind(frame, state, rewind);
  draw_pace(state, send);
  draw_tools(state);
  beside(state, width_of("surface"), 24);
  draw_shown(state, send);
  const char* const film = recording ? "Stop film" : "Film";
  beside(state, width_of(film), 24);
  if (toggle(film, recording)) state.film = true;
  help_of("F: record a film, every frame of the scene once");
  beside(state, width_of("Save"));
  state.save |= ImGui::Button("Save");
  help_of("S: the scene as it stands, in a folder that mallow run --resume goes on from");
  beside(state, width_of("Copy command"));
  state.copy |= ImGui::Button("Copy command");
  help_of("C: the command line that repeats this scene with these settings");
  beside(state, width_of("?"));
  if (ImGui::Button("?")) state.help = !state.help;
  state.time_bar_end = std::max(state.time_bar_end, ImGui::GetItemRectMax().x);
  state.time_height = std::max(k_least_time_height, static_cast<int>(ImGui::GetCursorPosY()) + 6);
  ImGui::End();
}

}  // namespace mallow::view
