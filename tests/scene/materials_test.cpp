// Materials by name: what their files say, in scenes and in the library.
#include "mallow/materials.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "config/field_archive.h"
#include "config/field_tables.h"
#include "mallow/quality.h"
#include "mallow/simulation.h"
#include "scene/scene_fixture.h"

namespace mallow {
namespace materials_test {

class materials_by_name : public SceneFixture {};

template <class Config>
std::string packed(const Config& config) {
  PackingArchive archive;
  pass_fields(archive, config);
  return archive.take();
}

/// A scene whose only material is that of a file, as a reader of TOML sees it.
std::string scene_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text;
  for (std::string line; std::getline(stream, line);)
    if (!line.starts_with("about"))
      text += (line == "[material]" ? "[[material]]\nname = \"it\"" : line) + '\n';
  return text + "[[body]]\nmaterial = \"it\"\nbox = { count = [2, 2, 2], spacing = 0.005 }\n";
}

std::string by_name(const std::string& name, const std::string& more = "") {
  return "[[body]]\nmaterial = \"" + name + "\"\nbox = { count = [3, 3, 3], spacing = 0.005 }\n" + more;
}

TEST_F(materials_by_name, are_what_their_files_say) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(MALLOW_DATA_DIR "/materials")) {
    const std::string name = entry.path().stem();
    files.insert(name);
    const MaterialPreset* preset = find_preset(name);
    ASSERT_NE(preset, nullptr) << name << " is not in the list of engine/config/materials.cmake";
    const Scene scene = read(scene_of(entry.path()));
    EXPECT_EQ(packed(preset->material), packed(scene.materials[0].material)) << name;
    EXPECT_EQ(preset->appearance.color, scene.materials[0].color) << name;
    EXPECT_EQ(preset->appearance.finish, scene.materials[0].finish) << name;
    EXPECT_GT(std::string(preset->about).size(), 10u) << name;
  }
  EXPECT_EQ(files.size(), material_presets().size());
  EXPECT_EQ(packed(materials::honey()), packed(find_preset("honey")->material));
  EXPECT_EQ(find_preset("glass"), nullptr);
}

TEST_F(materials_by_name, need_nothing_else_in_a_scene) {
  for (const MaterialPreset& preset : material_presets()) {
    const Scene scene = read(by_name(preset.name, "[solver]\ngravity = [0, 0, -9.81]\n"));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].name, preset.name);
    EXPECT_EQ(packed(scene.materials[0].material), packed(preset.material));
    EXPECT_EQ(print_scene(read(print_scene(scene))), print_scene(scene));
    Simulation simulation = build(scene);
    for (int k = 0; k < 3; ++k) simulation.step();
    for (const std::string& warning : warnings(scene, simulation.info()))
      EXPECT_EQ(warning.find("density"), std::string::npos) << warning;
  }
}

// Five of them were refused at realtime, whose steps are longer than those that moduli ask for.
TEST_F(materials_by_name, stand_every_quality_and_any_factor_of_steps_that_are_left_out) {
  for (const MaterialPreset& preset : material_presets()) {
    const Scene scene = read(by_name(preset.name, "[solver]\ngravity = [0, 0, -9.81]\n"));
    for (const Quality quality : qualities())
      EXPECT_NO_THROW(build(with_quality(scene, quality)).step()) << preset.name << ' ' << name(quality);
    Scene longer = scene;
    longer.solver.time_step_factor = 4;
    EXPECT_NO_THROW(build(longer).step()) << preset.name;
  }
}

TEST_F(materials_by_name, give_way_to_those_of_the_scene) {
  const Scene scene = read(by_name("honey", "[[material]]\nname = \"honey\"\nalpha = 0.25\n"));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].material.alpha.at(0), 0.25f);
}

TEST_F(materials_by_name, are_suggested_where_a_name_is_nearly_theirs) {
  const auto found = problems(by_name("hony"));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("unknown material 'hony'; did you mean 'honey'?"), std::string::npos) << found[0];
  const Scene changed = read(by_name("jelly"), {"body[0].material=water"});
  EXPECT_EQ(changed.materials[0].name, "water");
}

// "a table is not allowed: a list of tables", as if the scene had said so.
TEST_F(materials_by_name, have_one_number_turned_by_an_override) {
  for (const MaterialPreset& preset : material_presets()) {
    const Scene same =
        read(by_name(preset.name), {std::string("material.") + preset.name + ".merge_flow=0.25"});
    ASSERT_EQ(same.materials.size(), 1u);
    Material turned = preset.material;
    turned.merge_flow = 0.25f;
    EXPECT_EQ(packed(same.materials[0].material), packed(turned)) << preset.name;
    EXPECT_EQ(same.materials[0].color, preset.appearance.color);
    EXPECT_EQ(same.materials[0].finish, preset.appearance.finish);
  }
  const Scene twice = read(by_name("water"), {"body[0].material=dough", "material.dough.plastic_yield=0.2",
                                              "material.dough.friction=0.5"});
  EXPECT_EQ(twice.materials[0].material.plastic_yield, 0.2f);
  EXPECT_EQ(twice.materials[0].material.friction, 0.5f);
  const Scene own = read(by_name("honey", "[[material]]\nname = \"honey\"\nalpha = 0.25\n"),
                         {"material.honey.viscosity=3"});
  EXPECT_EQ(own.materials[0].material.alpha.at(0), 0.25f);
  EXPECT_EQ(own.materials[0].material.viscosity, 3.0f);
}

TEST_F(materials_by_name, take_the_place_of_a_scenes_own_by_an_override_which_leaves_that_out) {
  const std::string own = "[[material]]\nname = \"mine\"\nalpha = 0.25\n";
  const Scene changed = read(by_name("mine", own), {"body[0].material=dough", "material.dough.friction=0.5"});
  ASSERT_EQ(changed.materials.size(), 1u);
  EXPECT_EQ(changed.materials[0].name, "dough");
  EXPECT_EQ(changed.materials[0].material.friction, 0.5f);
  EXPECT_EQ(changed.bodies[0].material, "dough");
  // What nobody has is told of still, where --set turns it or took nothing from anybody.
  EXPECT_EQ(
      problems(by_name("mine", own), {"body[0].material=dough", "material.mine.alpha=0.5"}),
      (std::vector<std::string>{"scene.toml:5:8: material[0]: material 'mine' is not used by any body"}));
  EXPECT_EQ(problems(by_name("dough", own), {"body[0].velocity=[0, 0, 1]"}).size(), 1u);
}

TEST_F(materials_by_name, name_the_override_that_is_wrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"material.dough.plastic_yeild=0.2",
       "material[0]: unknown key 'plastic_yeild'; did you mean 'plastic_yield'?"},
      {"material.dough.alpha=2", "material[0].alpha: 2 is not allowed: "},
      {"material.honey.alpha=1", "material[0]: material 'honey' is not used by any body"},
      {"material.duogh.alpha=1",
       "material.duogh.alpha: does not exist: no material has the name 'duogh'; did you "
       "mean 'dough'?"},
      {"material[0].alpha=1", "material[0].alpha: does not exist: there is none"},
  };
  for (const auto& [given, problem] : cases) {
    const auto found = problems(by_name("dough"), {given});
    ASSERT_EQ(found.size(), 1u) << found[0] << '\n' << found[1];
    EXPECT_TRUE(found[0].starts_with(std::string("--set ") + given + ": " + problem)) << found[0];
  }
}

}  // namespace materials_test
}  // namespace mallow
