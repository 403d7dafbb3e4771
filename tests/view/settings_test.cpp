#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "view/settings_model.h"

namespace mallow {
namespace view_settings_test {

using namespace view;

Scene cube() {
  return read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/cube.toml");
}

TEST(view_settings, hold_every_key_of_the_solver_materials_surfaces_and_runs) {
  const SettingsModel settings(cube());
  std::set<std::string> shown;
  for (const SettingsSection& section : settings.sections())
    for (const scene_file::BoundField& field : section.fields)
      shown.insert(section.path.substr(0, section.path.find('[')) + "." + field.name);
  for (const char* key :
       {"solver.time_step_factor", "material.alpha", "material.plastic_yield", "surface.voxels",
        "run.frame_time", "render.field_of_view", "body.material", "collider.friction"})
    EXPECT_TRUE(shown.contains(key)) << key;
}

const scene_file::BoundField& field_of(const SettingsModel& settings, const std::string& key,
                                       const SettingsSection*& in) {
  for (const SettingsSection& section : settings.sections())
    for (const scene_file::BoundField& field : section.fields)
      if (section.path + "." + field.name == key) {
        in = &section;
        return field;
      }
  throw std::runtime_error(key);
}

TEST(view_settings, a_change_acts_at_once_or_waits_for_a_new_scene) {
  SettingsModel settings(cube());
  const SettingsSection* section = nullptr;
  const auto& alpha = field_of(settings, "material[0].alpha", section);
  EXPECT_TRUE(SettingsModel::set_share(alpha, 0.5));
  EXPECT_TRUE(static_cast<bool>(settings.command(*section, alpha)));
  EXPECT_FALSE(settings.waits_for_rebuild());
  const auto& radius = field_of(settings, "solver.support_radius", section);
  EXPECT_FALSE(static_cast<bool>(settings.command(*section, radius)));
  EXPECT_TRUE(settings.waits_for_rebuild());
}

TEST(view_settings, the_command_line_has_what_was_changed_and_gives_the_same_scene) {
  SettingsModel settings(cube());
  EXPECT_EQ(settings.command_line().find("--set"), std::string::npos);
  const SettingsSection* section = nullptr;
  SettingsModel::set_share(field_of(settings, "material[0].alpha", section), 0.25);
  EXPECT_NE(settings.command_line().find("--set 'material[0].alpha=0.25'"), std::string::npos)
      << settings.command_line();
  const std::string changes[] = {"material[0].alpha=0.25"};
  EXPECT_EQ(print_scene(read_scene(cube().file, changes)), print_scene(settings.scene()));
}

TEST(view_settings, every_slider_goes_once_through_its_range_and_the_session_stands) {
  SettingsModel settings(cube());
  Session session({.threads = 1});
  session.open(settings.scene());
  int moved = 0;
  for (const SettingsSection& section : settings.sections())
    for (const scene_file::BoundField& field : section.fields) {
      const auto put_back = std::visit(
          [](auto* target) -> std::function<void()> {
            return [target, value = *target] { *target = value; };
          },
          field.target);
      for (const double share : {0.0, 0.5, 1.0}) {
        // The finest voxels take their time; the window's test has them.
        if (section.kind == SettingsSection::Kind::surface) break;
        if (!SettingsModel::set_share(field, share)) break;
        ++moved;
        if (auto command = settings.command(section, field)) session.run(command);
        session.step_once();
        session.advance(0);
      }
      put_back();
      if (auto command = settings.command(section, field)) session.run(command);
    }
  EXPECT_GT(moved, 150);
  session.reset();
  session.step_once();
  EXPECT_TRUE(session.advance(0));
  EXPECT_EQ(session.simulation().step_count(), 1);
}

}  // namespace view_settings_test
}  // namespace mallow
