#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

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

TEST(view_settings, hold_the_shapes_of_colliders_and_the_command_line_says_what_became_of_them) {
  SettingsModel settings(read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/spoon.toml"));
  const SettingsSection* section = nullptr;
  const auto set = [&](const std::string& key, double share) {
    const auto& field = field_of(settings, key, section);
    EXPECT_TRUE(SettingsModel::set_share(field, share));
    EXPECT_FALSE(static_cast<bool>(settings.command(*section, field))) << "it waits for a new scene";
  };
  set("collider[0].union[4].capsule.radius", 0.75);
  EXPECT_TRUE(settings.waits_for_rebuild());
  const float radius =
      std::get<Capsule>(std::get<Union>(settings.scene().colliders[0].shape).parts[4]).radius;
  EXPECT_NE(radius, 0.005f);
  EXPECT_NE(settings.command_line().find("collider[0].union"), std::string::npos) << settings.command_line();
  set("collider[1].box.max", 0.9);
  EXPECT_NO_THROW(build(settings.scene(), 1));
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
  EXPECT_NE(settings.command_line().find("--set material.jelly.alpha=0.25"), std::string::npos)
      << settings.command_line();
  const std::string changes[] = {"material.jelly.alpha=0.25"};
  EXPECT_EQ(print_scene(read_scene(cube().file, changes)), print_scene(settings.scene()));
}

/// What the command's --set say.
std::vector<std::string> changes_in(const std::string& command) {
  std::vector<std::string> changes;
  const std::string line = command.substr(0, command.find("  #"));
  const std::string option = " --set ";
  for (std::size_t at = line.find(option); at != line.npos; at = line.find(option, at + 1)) {
    std::string word = line.substr(at + option.size());
    word = word.front() == '\'' ? word.substr(1, word.find('\'', 1) - 1) : word.substr(0, word.find(' '));
    changes.push_back(word);
  }
  return changes;
}

TEST(view_settings, the_command_line_keeps_what_the_viewer_itself_was_told_and_materials_by_name) {
  const std::string text =
      "[[body]]\nmaterial = 'jelly'\nbox = { count = [4, 4, 4], spacing = 0.01 }\n[[body]]\n"
      "material = 'rubber'\nbox = { count = [4, 4, 4], spacing = 0.01, corner = [0.1, 0, 0] }\n";
  const std::vector<std::string> own = {"solver.time_step_factor=0.9", "material.rubber.alpha=0.3"};
  SettingsModel settings(parse_scene(text, "two.toml", own), own);
  const SettingsSection* section = nullptr;
  for (const char* const key : {"material[0].alpha", "material[1].viscosity"})
    SettingsModel::set_share(field_of(settings, key, section), 0.75);
  const std::vector<std::string> changes = changes_in(settings.command_line());
  EXPECT_EQ(print_scene(parse_scene(text, "two.toml", changes)), print_scene(settings.scene()))
      << settings.command_line();
}

TEST(view_settings, the_command_line_says_what_it_lacks) {
  SettingsModel settings(cube());
  EXPECT_EQ(settings.command_line().find('#'), std::string::npos);
  EXPECT_NE(settings.command_line("", {"what the mouse did"}).find("  # without what the mouse did: S saves"),
            std::string::npos);
  const SettingsSection* section = nullptr;
  SettingsModel::set_share(field_of(settings, "material[0].alpha", section), 0.25);
  SettingsModel::set_share(field_of(settings, "render.field_of_view", section), 0.5);
  const std::string run = settings.command_line("my run");
  EXPECT_TRUE(run.starts_with("mallow run --resume 'my run' --set render.field_of_view=")) << run;
  EXPECT_NE(run.find("  # without settings of the motion"), std::string::npos) << run;
  EXPECT_EQ(run.find("alpha"), std::string::npos) << "what does not act when it goes on";
}

TEST(view_settings, pictures_of_runs_are_told_from_what_this_window_shows) {
  SettingsModel settings(cube());
  const SettingsSection* section = nullptr;
  const auto acts = [&](const char* key) {
    const auto& field = field_of(settings, key, section);
    return SettingsModel::acts(*section, field);
  };
  EXPECT_EQ(acts("render.field_of_view"), SettingsModel::Acts::at_once);
  EXPECT_EQ(acts("render.eye"), SettingsModel::Acts::at_once);
  EXPECT_EQ(acts("render.shutter"), SettingsModel::Acts::in_pictures_of_runs);
  EXPECT_EQ(acts("body[0].velocity"), SettingsModel::Acts::when_built_anew);
  const auto& shutter = field_of(settings, "render.shutter", section);
  settings.command(*section, shutter);
  EXPECT_FALSE(settings.waits_for_rebuild()) << "no rebuild would show it";
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
        ASSERT_FALSE(session.has_failed()) << section.path << "." << field.name << " at " << share;
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
