// What is said of numbers of matter that nobody means, and of what is meant nothing.
#include <filesystem>

#include "mallow/materials.h"
#include "scene/scene_fixture.h"
#include "scene/warning_scenes.h"

namespace mallow {
namespace matter_warnings_test {

using matter_warnings = SceneFixture;

TEST_F(matter_warnings, name_a_yield_in_percent) {
  const auto of = [&](const std::string& material) {
    return warnings_of(read(jelly("alpha = 0.3\n" + material)));
  };
  const std::string strain = "it springs back from all that does not squash it to a quarter";
  EXPECT_TRUE(warns(of("plastic_yield = 8.0"), "plastic_yield 8 is a strain of 800%: " + strain));
  EXPECT_TRUE(warns(of("plastic_yield = 1.0"), strain));
  EXPECT_FALSE(warns(of("plastic_yield = 0.5"), strain));
  const std::string heat = "temperature = 300.0\nconductivity = 1.0\nplastic_yield_by_temperature = ";
  EXPECT_TRUE(warns(of(heat + "[[290.0, 5.0], [310.0, 2.0]]"), "plastic_yield_by_temperature of 2 and more"));
  EXPECT_FALSE(warns(of(heat + "[[290.0, 5.0], [310.0, 0.1]]"), strain)) << "what is cold springs";
  std::string filled = jelly("alpha = 0.3\nplastic_yield = 8.0");
  filled.replace(filled.find("[run]"), 0, "paint = [{ sphere = { radius = 0.2 }, plastic_yield = 0.1 }]\n");
  EXPECT_FALSE(warns(warnings_of(read(filled)), strain)) << "a shell that holds its filling";
}

TEST_F(matter_warnings, name_flow_that_nothing_has_and_merging_that_hardly_comes_about) {
  const auto of = [&](const std::string& material) {
    return warnings_of(read(jelly("alpha = 0.3\n" + material)));
  };
  EXPECT_TRUE(warns(of("merge_flow = 0.3"), "merge_flow 0.3 has no effect, as it does not flow"));
  EXPECT_TRUE(warns(of("tear_strain = 0.2"), "tear_strain 0.2 has no effect, as it does not flow"));
  EXPECT_FALSE(warns(of("merge_flow = 0.1\ntear_strain = 0.5"), "no effect")) << "as they are where left out";
  const std::string flows = "plastic_yield = 0.1\nmerge_flow = ";
  EXPECT_FALSE(warns(of(flows + "0.5"), "merge_flow"));
  EXPECT_TRUE(
      warns(of(flows + "0.9"), "merge_flow 0.9 is more than the 0.5 at which what flows takes a new"));
  EXPECT_FALSE(warns(of(flows + "1e6"), "merge_flow")) << "never, as is meant";
}

TEST_F(matter_warnings, name_viscosity_of_what_is_no_fluid_at_all) {
  const auto of = [&](const std::string& material) { return warnings_of(read(jelly(material))); };
  const std::string nothing = "viscosity 5 has no effect where alpha is 0";
  EXPECT_TRUE(warns(of("alpha = 0.0\nviscosity = 5.0"), nothing));
  EXPECT_FALSE(warns(of("alpha = 0.1\nviscosity = 5.0"), nothing));
  EXPECT_FALSE(warns(of("alpha = [[0.0, 0.0], [1.0, 0.5]]\nviscosity = 5.0"), nothing));
  EXPECT_FALSE(warns(of("alpha = 0.0\nviscosity = 5.0\npressure_coefficient = 40.0"), nothing))
      << "one of several scenes that differ in alpha";
}

TEST_F(matter_warnings, name_iterations_that_nothing_ends) {
  const auto with = [&](const std::string& solver) {
    std::string text = jelly("alpha = 0.3\nplastic_yield = 0.05");
    text.replace(0, 8, "[solver]\nvolume_iterations = " + solver);
    return warns(warnings_of(read(text)), "are all taken in every step");
  };
  EXPECT_TRUE(with("50"));
  EXPECT_FALSE(with("50\nvolume_tolerance = 0.001"));
  EXPECT_FALSE(with("10"));
}

TEST_F(matter_warnings, name_a_blade_that_is_too_thin_to_cut_and_nothing_that_is_no_blade) {
  // Regions of 0.21 m, tear_strain 0.5: a gap of 0.315 m, and a blade of 0.215.
  const auto of = [&](const std::string& collider, const std::string& material = "plastic_yield = 0.1") {
    return warnings_of(read(jelly("alpha = 0.3\n" + material, "[[collider]]\n" + collider)));
  };
  const std::string thin = "too thin to cut", down = "velocity = [0.0, 0.0, -1.0]\n";
  const std::string knife = "box = { min = [-0.05, -2, 1], max = [0.05, 2, 3] }\n";
  EXPECT_TRUE(
      warns(of(knife + down),
            "collider 0 is 0.1 m thick across its way, too thin to cut: with a spacing it opens a gap of "
            "0.2 m, and matter tears beyond 0.315 m"));
  EXPECT_TRUE(warns(of(knife + down), "make it thicker than 0.215 m"));
  EXPECT_TRUE(warns(of(knife + "keyframes = [{ time = 0 }, { time = 1, translate = [0, 0, -1] }]\n"), thin));
  EXPECT_TRUE(warns(of("capsule = { start = [0, -2, 1], end = [0, 2, 1], radius = 0.1 }\n" + down), thin))
      << "a wire";
  EXPECT_FALSE(warns(of("box = { min = [-0.11, -2, 1], max = [0.11, 2, 3] }\n" + down), thin)) << "0.22 m";
  EXPECT_FALSE(warns(of(knife + down, "plastic_yield = 0.1\ntear_strain = 0.0\nregion_radius = 0.19"), thin))
      << "shorter matter";
  EXPECT_FALSE(warns(of(knife + down, ""), thin)) << "what does not flow does not tear";
  EXPECT_FALSE(warns(of(knife), thin)) << "it stands still";
  EXPECT_FALSE(warns(of(knife + "velocity = [1.0, 0.0, 0.1]\n"), thin)) << "a plate that pushes";
  EXPECT_FALSE(warns(of("sphere = { center = [0, 0, 2], radius = 0.05 }\n" + down), thin)) << "a ball";
}

TEST_F(matter_warnings, name_a_blade_that_turns_and_is_too_thin_to_cut) {
  const auto is_thin = [&](const std::string& collider) {
    return warns(warnings_of(read(jelly("alpha = 0.3\nplastic_yield = 0.1", "[[collider]]\n" + collider))),
                 "collider 0 is 0.1 m thick across its way, too thin to cut");
  };
  const std::string knife = "box = { min = [-0.05, -2, 1], max = [0.05, 2, 3] }\n";
  EXPECT_TRUE(is_thin(knife + "angular_velocity = [2.0, 0.0, 0.0]\n")) << "about the axis across it: a saw";
  EXPECT_TRUE(is_thin(knife + "keyframes = [{ time = 0 }, { time = 1, rotate = [90, 0, 0] }]\n"));
  EXPECT_TRUE(is_thin(knife + "translate = [1.0, 0.0, 0.0]\nrotate = [0.0, 30.0, 70.0]\n"
                              "velocity = [0.0, 0.0, -0.01]\nangular_velocity = [0.64, 1.63, -0.97]\n"))
      << "the same axis, turned with it";
  EXPECT_FALSE(is_thin(knife + "angular_velocity = [0.0, 0.0, 2.0]\n")) << "a paddle pushes";
  EXPECT_FALSE(is_thin("box = { min = [-0.05, 0, 1], max = [0.05, 2, 3] }\nangular_velocity = [0, 0, 2.0]\n"))
      << "so does a door, though near its hinges it turns edgewise";
  EXPECT_FALSE(
      is_thin("box = { min = [-0.05, -0.05, 1], max = [0.05, 0.05, 3] }\n"
              "angular_velocity = [0.0, 0.0, 2.0]\n"))
      << "a rod about itself";
}

TEST_F(matter_warnings, have_no_metres_where_units_are_free) {
  const auto of = [&](const char* gravity) {
    return warnings_of(read(falling("1.0", "2.1", gravity, "frame_time = 0.2\n") +
                                "[[collider]]\nbox = { min = [-0.5, -20, 10], max = [0.5, 20, 30] }\n"
                                "velocity = [0.0, 0.0, -1.0]\n",
                            {"material[0].plastic_yield=0.1"}));
  };
  EXPECT_TRUE(warns(of("-0.3"),
                    "collider 0 is 1 thick across its way, too thin to cut: with a spacing it "
                    "opens a gap of 2, and matter tears beyond 3.15, (1"));
  EXPECT_TRUE(warns(of("-9.81"), "collider 0 is 1 m thick across"));
}

TEST_F(matter_warnings, name_splits_of_what_is_not_torn_or_does_not_stay_apart) {
  const auto of = [&](const std::string& material, const std::string& body, const std::string& more = "") {
    std::string text = jelly(material, more);
    return warnings_of(read(text.insert(text.find("box = "), body + "\n")));
  };
  const std::string blade =
      "[[collider]]\nbox = { min = [-0.2, -2, 1], max = [0.2, 2, 3] }\nvelocity = [0.0, 0.0, -1.0]\n";
  const std::string elastic = "what is elastic is not by what moves through it";
  EXPECT_TRUE(warns(of("alpha = 0.3", "splits = true", blade), elastic));
  EXPECT_FALSE(warns(of("alpha = 0.3", "splits = true"), elastic)) << "nothing moves through it";
  EXPECT_FALSE(warns(of("alpha = 0.3\nupdate_threshold = 50.0", "splits = true", blade), elastic))
      << "as asked";
  EXPECT_FALSE(warns(of("alpha = 0.3\nplastic_yield = 0.1", "splits = true", blade), "splits"));
  EXPECT_TRUE(warns(of("alpha = 1.0", "splits = true"), "splits has no effect where alpha is 1"));
  EXPECT_TRUE(warns(of("alpha = 0.3\nplastic_yield = 0.1", "splits = true\nmerges = true"),
                    "splits and merges undo each other"));
}

TEST_F(matter_warnings, name_lengths_in_centimetres_under_a_gravity_in_metres) {
  const auto of = [&](const std::string& material, const std::string& spacing,
                      const char* gravity = "-9.81") {
    return warns(
        warnings_of(read(std::string("[solver]\ngravity = [0, 0, ") + gravity + "]\n[[body]]\nmaterial = \"" +
                         material + "\"\nbox = { count = [10, 10, 10], spacing = " + spacing + " }\n")),
        "lengths are in metres; give a hundredth of them if these are centimetres");
  };
  for (const char* soft : {"dough", "jelly", "toothpaste", "clay", "mayonnaise"}) {
    EXPECT_TRUE(of(soft, "1.0")) << soft << ", 10 cm";
    EXPECT_FALSE(of(soft, "0.1")) << soft << ", a metre";
    EXPECT_FALSE(of(soft, "1.0", "-0.3")) << soft << ", free units";
  }
  EXPECT_FALSE(of("water", "1.0")) << "a lake";
}

TEST_F(matter_warnings, blame_viscosity_where_steps_are_many_times_more_and_never_the_radius_for_it) {
  const auto honey = [&](const std::string& spacing) {
    return warnings_of(
        read("[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = \"honey\"\nbox = { count = "
             "[4, 4, 4], spacing = " +
             spacing + " }\n[run]\nframe_time = 0.0333\n"));
  };
  EXPECT_TRUE(honey("0.005").empty()) << "honey is so thick";
  EXPECT_TRUE(honey("0.002").empty());
  EXPECT_TRUE(warns(honey("0.001"), "viscosity 10 shortens every step"));
  EXPECT_TRUE(warns(honey("0.001"), "lower it, or raise the spacing, 0.001 m, with whose square steps grow"));
  const auto thin = warnings_of(
      read(jelly("alpha = 1.0\ntemperature = 300.0\nconductivity = 1.0\nviscosity_by_temperature = [[290.0, "
                 "0.001], [310.0, 0.0001]]")));
  EXPECT_TRUE(
      warns(thin, "viscosity_by_temperature, 0.001 at its thickest, is too low to calm the pressure"));
  EXPECT_FALSE(warns(thin, "support_radius"));
}

TEST_F(matter_warnings, leave_materials_by_name_alone_at_any_spacing_that_is_run_with_them) {
  for (const MaterialPreset& material : material_presets())
    for (const std::string spacing : {"0.01", "0.005", "0.002"}) {
      const auto all = warnings_of(
          read("[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = \"" + std::string(material.name) +
               "\"\nbox = { count = [6, 6, 6], spacing = " + spacing +
               ", corner = [0, 0, 0] }\n[[collider]]\nplane = {}\n[run]\nframe_time = 0.0333\n"));
      EXPECT_TRUE(all.empty()) << material.name << ' ' << spacing << ": " << all.front();
    }
}

TEST_F(matter_warnings, leave_the_scenes_of_the_gallery_alone_but_for_thresholds_of_the_paper) {
  std::size_t looked_at = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MALLOW_DATA_DIR "/scenes")) {
    const std::string name = entry.path().stem().string();
    const bool is_of_paper = name.starts_with("bunny") || name.starts_with("armadillo") || name == "demo";
    if (entry.path().extension() != ".toml" || is_of_paper) continue;  // meshes take seconds to fill
    try {
      for (const std::string& warning : warnings_of(read_scene(entry.path())))
        EXPECT_NE(warning.find("at rest its own weight updates"), warning.npos) << name << ": " << warning;
      ++looked_at;
    } catch (const ConfigError&) {  // a mesh that a script fetches may not be there
    }
  }
  EXPECT_GE(looked_at, 20u);
}

}  // namespace matter_warnings_test
}  // namespace mallow
