#include <array>
#include <string>

#include <imgui.h>
#include "view/panels.h"

namespace mallow::view {
namespace {

constexpr ImGuiWindowFlags k_quiet = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings |
                                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing;

/// Two keys a line, each with what it does.
constexpr std::array<std::array<const char*, 4>, 12> k_help = {{
    {"left button", "the tool at hand: 1 grab  2 throw  3 poke  4 cut  5 heat  6 pin  7 choose", "", ""},
    {"", "beside matter it turns the view", "", ""},
    {"right button", "turn the view; with shift, or the middle button: move it", "", ""},
    {"wheel", "nearer and farther", "Home", "the view as it was"},
    {"Space", "pause and play", ". (period)", "one step"},
    {"Backspace", "back, held: ever farther", "R", "to the start"},
    {"[  ]", "slower and faster", "=", "as fast as it goes"},
    {"P", "surface or particles", "K", "what particles are coloured by"},
    {"F", "record a film, and end it", "S", "save the scene as it stands"},
    {"C", "copy the command line that repeats it", "", ""},
    {"U", "let go of what is pinned", "Tab", "panels on and off"},
    {"Escape", "scenes", "H", "this"},
}};

}  // namespace

std::string message_shown(const Frame& frame, const ViewState& state, double wall) {
  const bool stays = frame.building || frame.failed;
  const bool has_notice = wall < state.notice_since + k_message_seconds;
  const bool has_message = stays || wall < state.message_since + k_message_seconds;
  const std::string said = frame.building ? "building the scene ..." : has_message ? frame.message : "";
  if (!has_notice || state.notice.empty()) return said;
  if (said.empty() || (!stays && state.notice_since > state.message_since)) return state.notice;
  return stays ? said + "\n\n" + state.notice : said;
}

void draw_message(const Frame& frame, const ViewState& state, double wall) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const std::string text = message_shown(frame, state, wall);
  if (text.empty()) return;
  ImGui::SetNextWindowPos(ImVec2(16, size.y - static_cast<float>(state.time_height) - 16), ImGuiCond_Always,
                          ImVec2(0, 1));
  if (frame.failed) ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.42f, 0.10f, 0.08f, 0.95f));
  ImGui::Begin("message", nullptr, k_quiet | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(std::min(640.0f, size.x - 360));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
  if (frame.failed) ImGui::PopStyleColor();
}

void draw_help(ViewState& state) {
  if (!state.help) return;
  ImGui::SetNextWindowPos(ImVec2(16, 64));
  ImGui::Begin("help", nullptr, k_quiet);
  for (const auto& [key, about, other_key, about_other] : k_help) {
    ImGui::TextUnformatted(key);
    ImGui::SameLine(110);
    ImGui::TextUnformatted(about);
    ImGui::SameLine(330);
    ImGui::TextUnformatted(other_key);
    ImGui::SameLine(420);
    ImGui::TextUnformatted(about_other);
  }
  if (ImGui::Button("Close")) state.help = false;
  ImGui::End();
}

void draw_legend(const Frame& frame, const ViewState& state) {
  if (state.drawn != Drawn::particles || state.shown == Shown::appearance) return;
  ImGui::SetNextWindowPos(ImVec2(16, 64));
  ImGui::Begin("legend", nullptr, k_quiet | ImGuiWindowFlags_NoInputs);
  const auto number = static_cast<std::size_t>(state.shown);
  if (frame.values.empty()) {
    ImGui::Text("no %s here", k_shown_names[number]);
  } else if (state.shown == Shown::body) {
    ImGui::Text("a colour for each body");
  } else if (state.shown == Shown::thread) {
    ImGui::Text("a colour for each thread: what it begins a step with, of %d threads", frame.stats.threads);
    ImGui::Text("grey: asleep");
  } else {
    ImGui::Text("%s %s", k_shown_names[number], k_shown_units[number]);
    const ImVec2 start = ImGui::GetCursorScreenPos();
    constexpr float k_part = 45, k_height = 10;
    // The stops of the shader, as the screen shows them in the open.
    constexpr ImU32 k_stops[] = {IM_COL32(48, 52, 122, 255), IM_COL32(38, 121, 173, 255),
                                 IM_COL32(89, 188, 153, 255), IM_COL32(228, 207, 75, 255),
                                 IM_COL32(218, 70, 39, 255)};
    for (int k = 0; k < 4; ++k) {
      const float x = start.x + k_part * static_cast<float>(k);
      ImGui::GetWindowDrawList()->AddRectFilledMultiColor(ImVec2(x, start.y),
                                                          ImVec2(x + k_part, start.y + k_height), k_stops[k],
                                                          k_stops[k + 1], k_stops[k + 1], k_stops[k]);
    }
    ImGui::Dummy(ImVec2(4 * k_part, k_height));
    ImGui::Text("%-12.4g", static_cast<double>(frame.value_range[0]));
    ImGui::SameLine(4 * k_part - 40);
    ImGui::Text("%.4g", static_cast<double>(frame.value_range[1]));
  }
  ImGui::End();
}

}  // namespace mallow::view
