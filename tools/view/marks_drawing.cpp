// Marks over the picture, and the boxes that ask for them.
#include <algorithm>

#include <imgui.h>
#include "view/viewer.h"

namespace mallow::view {
namespace {

constexpr ImU32 k_pinned = IM_COL32(60, 120, 255, 220), k_chosen = IM_COL32(255, 160, 50, 255),
                k_region = IM_COL32(70, 210, 110, 200), k_force = IM_COL32(230, 40, 60, 255);
/// Of what is seen; the longest line of a force.
constexpr float k_longest = 0.25f;

}  // namespace

void Viewer::draw_placed_marks() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const PlacedMarks& marks = frame().marks;
  const auto dot = [&](const Vec3& x, float size, ImU32 color) {
    const Vec3 at = on_screen(x);
    if (at.z() > 0) list.AddCircleFilled(ImVec2(at.x(), at.y()), size, color, 8);
  };
  for (const Vec3& x : marks.pins) dot(x, 3, k_pinned);
  for (const Vec3& x : marks.region) dot(x, 3, k_region);
  if (marks.chosen) dot(*marks.chosen, 5, k_chosen);
  float largest = 0;
  for (const ContactMark& contact : marks.contacts) largest = std::max(largest, contact.force.norm());
  if (largest <= 0) return;
  const float scale = k_longest * (frame().bounds.max - frame().bounds.min).norm() / largest;
  for (const ContactMark& contact : marks.contacts) {
    const Vec3 from = on_screen(contact.position), to = on_screen(contact.position + scale * contact.force);
    if (from.z() <= 0 || to.z() <= 0) continue;
    list.AddLine(ImVec2(from.x(), from.y()), ImVec2(to.x(), to.y()), k_force, 2);
    list.AddCircleFilled(ImVec2(from.x(), from.y()), 3, k_force, 8);
  }
}

void draw_marks_panel(ViewState& state, const Send& send) {
  if (!ImGui::CollapsingHeader("Shown over the picture", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const auto box = [](const char* name, bool* value, const char* about) {
    const bool changed = ImGui::Checkbox(name, value);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", about);
    return changed;
  };
  bool changed = box("pins", &state.marks.pins, "particles that are pinned: by the scene, and by the mouse");
  ImGui::SameLine();
  changed |= box("region", &state.marks.region,
                 "the region of a particle, which is matched to its shape at rest; choose it by the mouse");
  ImGui::SameLine();
  changed |=
      box("contacts", &state.marks.contacts,
          "forces on bodies from colliders and from each other, the largest as long as a quarter of what "
          "is seen");
  ImGui::SameLine();
  if (ImGui::SmallButton("let go of pins")) state.release_pins = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("U: what the mouse has pinned moves again");
  if (changed) send([marks = state.marks](Session& session) { session.show_marks(marks); });
}

}  // namespace mallow::view
