#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <imgui.h>
#include "view/panels.h"

namespace mallow::view {
namespace {

/// Of phases in their order, and of the surface last.
constexpr std::array<ImU32, k_phase_count + 1> k_colors = {
    IM_COL32(140, 140, 150, 255), IM_COL32(70, 130, 220, 255),  IM_COL32(60, 180, 200, 255),
    IM_COL32(80, 200, 140, 255),  IM_COL32(150, 150, 90, 255),  IM_COL32(240, 190, 60, 255),
    IM_COL32(240, 150, 50, 255),  IM_COL32(230, 110, 60, 255),  IM_COL32(200, 80, 120, 255),
    IM_COL32(170, 90, 190, 255),  IM_COL32(120, 100, 220, 255), IM_COL32(230, 230, 235, 255)};

/// A strip as wide as the time of each phase.
void phase_strip(const FrameStats& stats, float width) {
  std::array<double, k_phase_count + 1> seconds{};
  double sum = 0;
  for (std::size_t k = 0; k <= k_phase_count; ++k) {
    seconds[k] = k < k_phase_count ? stats.phases[k] : stats.surface_seconds;
    sum += seconds[k];
  }
  const ImVec2 start = ImGui::GetCursorScreenPos();
  constexpr float k_height = 12;
  ImGui::InvisibleButton("phases", ImVec2(width, k_height));
  if (sum <= 0) return;
  float x = start.x;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (std::size_t k = 0; k <= k_phase_count; ++k) {
    const float end = x + width * static_cast<float>(seconds[k] / sum);
    list.AddRectFilled(ImVec2(x, start.y), ImVec2(end, start.y + k_height), k_colors[k]);
    x = end;
  }
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  for (std::size_t k = 0; k <= k_phase_count; ++k) {
    if (seconds[k] <= 0) continue;
    ImGui::PushStyleColor(ImGuiCol_Text, k_colors[k]);
    ImGui::TextUnformatted(k < k_phase_count ? name(static_cast<Phase>(k)) : "surface, a picture");
    ImGui::PopStyleColor();
    ImGui::SameLine(150);
    ImGui::Text("%.2f ms", 1e3 * seconds[k]);
  }
  ImGui::EndTooltip();
}

/// One quantity over the last ten seconds, with its last value.
template <class Value>
void plot(const char* label, const char* unit, const std::vector<Sample>& samples, float width,
          const Value& value) {
  std::vector<float> values;
  for (const Sample& sample : samples) values.push_back(value(sample));
  char text[64];
  std::snprintf(text, sizeof text, "%s %.3g %s", label,
                values.empty() ? 0.0 : static_cast<double>(values.back()), unit);
  ImGui::PlotLines((std::string("##") + label).c_str(), values.data(), static_cast<int>(values.size()), 0,
                   text, FLT_MAX, FLT_MAX, ImVec2(width, 34));
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s [%s], the last ten seconds", label, unit);
}

/// As many as there is room for; returns how many.
int draw_plots(const Frame& frame, float room) {
  constexpr float k_least = 124, k_most = 168, k_gap = 8;
  const int count = std::min(3, static_cast<int>(room / (k_least + k_gap)));
  if (count <= 0) return 0;
  const float width = std::min(k_most, room / static_cast<float>(count) - k_gap - 4);
  const std::vector<Sample>& samples = frame.samples;
  const float lowest = samples.empty() ? 0 : std::ranges::min(samples, {}, &Sample::potential).potential;
  ImGui::SameLine();
  plot("moving", "J", samples, width, [](const Sample& sample) { return sample.kinetic; });
  if (count == 1) return 1;
  ImGui::SameLine();
  plot("gravity", "J", samples, width, [&](const Sample& sample) { return sample.potential - lowest; });
  if (count == 2) return 2;
  ImGui::SameLine();
  plot("momentum", "N s", samples, width, [](const Sample& sample) { return sample.momentum; });
  return 3;
}

}  // namespace

void draw_top_bar(const Frame& frame, ViewState& state, double drawn_per_second) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0, 0));
  ImGui::SetNextWindowSize(ImVec2(size.x, k_top_height));
  ImGui::Begin(
      "top", nullptr,
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoSavedSettings);
  const FrameStats& stats = frame.stats;
  if (ImGui::Button("Scenes")) state.gallery = true;
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("%5.0f steps/s  %4.1f frames/s  %3.0f pictures/s   %.2f of film pace", stats.steps_per_second,
              stats.frames_per_second, drawn_per_second, stats.pace);
  phase_strip(stats, 430);
  ImGui::EndGroup();
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("%zu particles", stats.particles);
  ImGui::Text("%zu of %zu bodies awake", stats.awake, stats.bodies);
  ImGui::EndGroup();
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("%.3f s, frame %d", stats.time, stats.frame);
  if (stats.threads < stats.most_threads)
    ImGui::Text("%d of %d threads", stats.threads, stats.most_threads);
  else
    ImGui::Text("%d thread%s", stats.threads, stats.threads == 1 ? "" : "s");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "of the simulation; where other programs are at work and --threads is not given, no more "
        "than the processors that they leave");
  ImGui::EndGroup();
  state.plots = draw_plots(frame, size.x - ImGui::GetItemRectMax().x);
  ImGui::End();
}

}  // namespace mallow::view
