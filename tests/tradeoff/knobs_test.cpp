#include "tradeoff/knobs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mallow/errors.h"

namespace mallow::knobs_test {

Scene scene() {
  return read_scene(MALLOW_DATA_DIR "/scenes/cube.toml");
}

TEST(tradeoff_knobs, lists_and_words_are_values_of_their_own) {
  const tradeoff::Knob knob = tradeoff::parse_knob("solver.gravity=[0, 0, -1],[0, 0, -2]");
  EXPECT_EQ(knob.key, "solver.gravity");
  EXPECT_EQ(knob.values, (std::vector<std::string>{"[0, 0, -1]", "[0, 0, -2]"}));
}

TEST(tradeoff_knobs, what_is_none_is_refused_by_name) {
  for (const char* text : {"solver", "=1", "solver.time_step=", "solver.time_step=1,,2"}) {
    try {
      tradeoff::parse_knob(text);
      ADD_FAILURE() << text;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.problems().front().field, "--knob");
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos);
    }
  }
  EXPECT_THROW(tradeoff::turned(scene(), {.key = "solver.nonsense", .values = {"1"}}, {}, false),
               ConfigError);
}

TEST(tradeoff_knobs, lines_to_paste_lead_to_the_setting) {
  const Scene before = scene();
  for (const tradeoff::Setting& setting :
       tradeoff::settings_around(before, {.regions = true, .sums = true})) {
    if (setting.name == "time_step_factor x 2") {
      EXPECT_EQ(tradeoff::lines_to_paste(before, setting.scene), "[solver]\ntime_step_factor = 2.0\n");
    }
    if (setting.name == "region_stride x 2") {
      EXPECT_EQ(tradeoff::lines_to_paste(before, setting.scene), "# below the [[material]] that is named \"" +
                                                                     before.materials.front().name +
                                                                     "\":\nregion_stride = 2\n");
    }
    EXPECT_NE(tradeoff::lines_to_paste(before, setting.scene), "") << setting.name;
  }
}

TEST(tradeoff_knobs, what_a_scene_has_not_is_not_turned) {
  for (const tradeoff::Setting& setting : tradeoff::settings_around(scene(), {})) {
    EXPECT_EQ(setting.name.find("stride"), std::string::npos) << setting.name;
    EXPECT_EQ(setting.name.find("native"), std::string::npos) << setting.name;
  }
}

TEST(tradeoff_knobs, a_coarser_body_fills_the_same_box) {
  const std::vector<tradeoff::Setting> settings = tradeoff::settings_around(scene(), {});
  const auto coarse = std::ranges::find(settings, "spacing x 1.25", &tradeoff::Setting::name);
  ASSERT_NE(coarse, settings.end());
  const auto& box = std::get<Lattice>(coarse->scene.bodies.front().source);
  EXPECT_EQ(box.spacing, 1.25f);
  EXPECT_NEAR(static_cast<double>(box.corner.x()) + 0.5 * box.count[0] * 1.25, 0, 1e-6);
  EXPECT_EQ(box.corner.z(), std::get<Lattice>(scene().bodies.front().source).corner.z()) << "on its floor";
}

TEST(tradeoff_knobs, a_mesh_is_filled_with_coarser_cells_too) {
  Scene mesh = scene();
  mesh.bodies.front().source =
      MeshSource{.file = "bunny.obj", .sampling = {.spacing = 0.5f}, .placement = {}};
  const std::vector<tradeoff::Setting> settings = tradeoff::settings_around(mesh, {});
  const auto coarse = std::ranges::find(settings, "spacing x 1.25", &tradeoff::Setting::name);
  ASSERT_NE(coarse, settings.end());
  EXPECT_EQ(std::get<MeshSource>(coarse->scene.bodies.front().source).sampling.spacing, 0.625f);
}

}  // namespace mallow::knobs_test
