#include <algorithm>
#include <optional>

#include "scene/scene_fixture.h"

namespace mallow {
namespace warnings_test {

using scene_warnings = SceneFixture;

/// A body of a spacing under a gravity, in a film of 30 frames; `run`: lines of that section.
std::string falling(const std::string& spacing, const std::string& radius, const std::string& gravity,
                    const std::string& run) {
  return "[solver]\nsupport_radius = " + radius + "\ngravity = [0, 0, " + gravity +
         "]\n[[material]]\nname = \"jelly\"\nalpha = 0.3\nrest_density = 1000.0\n[[body]]\nmaterial = "
         "\"jelly\"\nbox = { count = [4, 4, 4], spacing = " +
         spacing + ", corner = [0, 0, 0] }\n[run]\nframes = 30\n" + run;
}

std::vector<std::string> warnings_of(const Scene& scene) {
  return warnings(scene, build(scene, 1).info());
}

TEST_F(scene_warnings, name_a_film_that_is_many_times_slower_than_real_time_and_the_frame_time_that_is_not) {
  const auto slow = warnings_of(read(falling("0.003", "0.0063", "-9.81", "")));
  ASSERT_EQ(slow.size(), 1u);
  EXPECT_EQ(
      slow[0],
      "run: 30 frames of 0.00143674 s cover 0.0431022 s, and the film of them takes 1 s, 23 times slower; "
      "frame_time = 0.0333333 shows real time");
  EXPECT_TRUE(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 0.0333333\n"))).empty());
  EXPECT_EQ(warnings_of(read(falling("0.1", "0.21", "-9.81", ""))).size(), 1u)
      << "four times, without a word";
  EXPECT_TRUE(warnings_of(read(falling("0.1", "0.21", "-9.81", "frame_time = 0.008\n"))).empty())
      << "as asked";
  EXPECT_TRUE(warnings_of(read(falling("1.0", "2.1", "-0.3", ""))).empty()) << "free units";
}

TEST_F(scene_warnings, name_frames_in_which_nothing_moves_a_spacing_far) {
  const auto still = warnings_of(read(falling("1.0", "2.1", "-0.3", "frame_time = 0.01\n")));
  ASSERT_EQ(still.size(), 1u);
  EXPECT_EQ(
      still[0],
      "run: 30 frames of 0.01 s cover 0.3 s, in which nothing falls or flies farther than 0.0135 m, less "
      "than the spacing of 1 m; give more frames, or a longer frame_time");
}

bool warns(const std::vector<std::string>& all, const std::string& of) {
  return std::ranges::any_of(all, [&](const std::string& text) { return text.find(of) != text.npos; });
}

TEST_F(scene_warnings, name_a_frame_time_in_milliseconds) {
  EXPECT_TRUE(warns(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 33\n"))),
                    "frame_time is in seconds, and 0.0333333 shows real time"));
  EXPECT_FALSE(
      warns(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 0.5\n"))), "frame_time"));
}

TEST_F(scene_warnings, name_gravity_that_is_left_out_beside_pascals) {
  const std::string body = "[[body]]\nmaterial = \"honey\"\nbox = { count = [4, 4, 4], spacing = 0.01 }\n";
  const auto has = [&](const std::string& text) {
    return warns(warnings_of(read(text)), "gravity is left out");
  };
  EXPECT_TRUE(has(body));
  EXPECT_FALSE(has("[solver]\ngravity = [0, 0, -9.81]\n" + body));
  EXPECT_TRUE(has("[[material]]\nname = \"honey\"\nyoungs_modulus = 5e3\n" + body));
  EXPECT_FALSE(has("[[material]]\nname = \"honey\"\nalpha = 0.5\n" + body));
}

TEST_F(scene_warnings, name_a_body_that_starts_within_a_collider) {
  const auto with_floor = [&](const std::string& offset) {
    return warnings_of(read(falling("0.1", "0.21", "-9.81", "frame_time = 0.0333333\n") +
                            "[[collider]]\nplane = { normal = [0, 0, 1], offset = " + offset + " }\n"));
  };
  EXPECT_TRUE(with_floor("0.0").empty());
  EXPECT_TRUE(warns(with_floor("0.15"), "particles start inside collider 0, up to "));
}

TEST_F(scene_warnings, name_a_density_that_is_in_grams_by_cubic_centimetre) {
  std::string text = falling("0.1", "0.21", "-9.81", "frame_time = 0.0333333\n");
  text.replace(text.find("1000.0"), 6, "1.0");
  EXPECT_TRUE(warns(warnings_of(read(text)), "a rest density of 1 kg/m3 is given"));
}

/// The same with other lines of the material, and more sections.
std::string jelly(const std::string& material, const std::string& more = "") {
  std::string text = falling("0.1", "0.21", "-9.81", "frame_time = 0.0333333\n");
  const std::string alpha = "alpha = 0.3";
  text.replace(text.find(alpha), alpha.size(), material);
  return text + more;
}

TEST_F(scene_warnings, name_an_emitter_whose_mouth_is_inside_a_collider) {
  const auto above = [&](const std::string& height) {
    return warnings_of(
        read(jelly("alpha = 0.3",
                   "[[collider]]\nplane = { normal = [0, 0, 1], offset = 0.0 }\n[[emitter]]\nmaterial = "
                   "\"jelly\"\nradius = 0.3\nspacing = 0.1\ntranslate = [5, 0, " +
                       height + "]\nspeed = 1.0\n")));
  };
  EXPECT_TRUE(warns(above("-0.2"), "leave its emitter inside collider 0"));
  EXPECT_FALSE(warns(above("0.1"), "emitter")) << "the layers that it holds may be";
}

TEST_F(scene_warnings, name_an_emitter_of_one_particle_a_layer) {
  const auto wide = [&](const std::string& radius) {
    return warnings_of(read(jelly("alpha = 0.3", "[[emitter]]\nmaterial = \"jelly\"\nradius = " + radius +
                                                     "\nspacing = 0.1\ntranslate = [5, 0, 5]\n")));
  };
  EXPECT_TRUE(warns(wide("0.03"), "one particle each"));
  EXPECT_FALSE(warns(wide("0.2"), "one particle each"));
}

TEST_F(scene_warnings, name_a_sink_that_takes_all_at_once) {
  const auto sink = [&](const std::string& min, const std::string& outside) {
    return warnings_of(read(jelly("alpha = 0.3", "[[sink]]\nbox = { min = " + min +
                                                     ", max = [9, 9, 9] }\noutside = " + outside + "\n")));
  };
  EXPECT_TRUE(warns(sink("[-9, -9, -9]", "false"), "removed at once"));
  EXPECT_FALSE(warns(sink("[-9, -9, -9]", "true"), "removed at once"));
  EXPECT_TRUE(warns(sink("[8, 8, 8]", "true"), "removed at once"));
  EXPECT_FALSE(warns(sink("[8, 8, 8]", "false"), "removed at once"));
}

TEST_F(scene_warnings, name_heat_that_does_nothing) {
  EXPECT_TRUE(warns(warnings_of(read(jelly("conductivity = 1.0"))), "conductivity 1 has no effect"));
  const std::string melts =
      "temperature = 290.0\nconductivity = 1.0\nalpha_by_temperature = [[300.0, 0.1], [310.0, 1.0]]";
  EXPECT_TRUE(warns(warnings_of(read(jelly(melts))), "alpha stays 0.1"));
  EXPECT_FALSE(
      warns(warnings_of(read(jelly(melts, "[[collider]]\nplane = { offset = -1.0 }\ntemperature = 350.0\n"))),
            "alpha stays"));
}

TEST_F(scene_warnings, name_what_acts_on_nothing) {
  EXPECT_TRUE(warns(warnings_of(read(jelly("alpha = 1.0\nyoungs_modulus = 1000.0"))), "youngs_modulus"));
  EXPECT_FALSE(warns(warnings_of(read(jelly("alpha = 0.9\nyoungs_modulus = 1000.0"))), "youngs_modulus"));
  std::string printed = jelly("alpha = 0.0");
  printed.replace(0, 8, "[solver]\nformulation = \"printed\"");
  EXPECT_TRUE(warns(warnings_of(read(printed)), "has no effect where alpha is 0"));
}

TEST_F(scene_warnings, name_creep_that_takes_longer_than_the_run) {
  const std::string flows = "alpha = 0.3\nplastic_yield = 0.05\nplastic_creep = ";
  EXPECT_TRUE(warns(warnings_of(read(jelly(flows + "0.001"))), "plastic_creep"));
  EXPECT_FALSE(warns(warnings_of(read(jelly(flows + "1.0"))), "plastic_creep"));
}

TEST_F(scene_warnings, name_parts_that_pass_through_each_other) {
  const auto of = [&](float alpha, float gap, std::optional<int> iterations = 0) {
    SolverConfig solver{.support_radius = 0.21f, .gravity = {0, 0, -9.81f}};
    solver.volume_iterations = iterations;
    Simulation s(solver);
    Body body = sample(Lattice{.count = {4, 4, 4}, .spacing = 0.1f});
    const Body other = sample(Lattice{.count = {4, 4, 4}, .spacing = 0.1f, .corner = {0, 0, 0.3f + gap}});
    body.positions.insert(body.positions.end(), other.positions.begin(), other.positions.end());
    s.add_body(body, {.alpha = alpha, .plastic_yield = 0.05f});
    s.prepare();
    return s.info().warnings;
  };
  EXPECT_TRUE(warns(of(0, 1), "its 2 parts pass through each other"));
  EXPECT_FALSE(warns(of(0.3f, 1), "parts pass"));
  EXPECT_FALSE(warns(of(0, 1, {}), "parts pass")) << "their volume keeps them apart";
  EXPECT_FALSE(warns(of(0, 0.1f), "parts pass"));
}

TEST_F(scene_warnings, name_bodies_that_their_own_weight_flattens_and_spacings_that_differ_too_much) {
  const auto of = [&](const Material& material, float coarse) {
    Simulation s({.gravity = {0, 0, -9.81f}});
    s.add_body(sample(Lattice{.count = {6, 6, 6}, .spacing = 0.005f}), material);
    s.add_body(sample(Lattice{.count = {4, 4, 4}, .spacing = coarse, .corner = {0.2f, 0, 0}}),
               {.alpha = 1.0f, .rest_density = 1000});
    s.prepare();
    return s.info().warnings;
  };
  const Material soft{.youngs_modulus = 100, .rest_density = 1000},
      firm{.youngs_modulus = 5000, .rest_density = 1000};
  EXPECT_TRUE(warns(of(soft, 0.005f), "its own weight presses with"));
  EXPECT_FALSE(warns(of(firm, 0.005f), "its own weight presses with"));
  Material damped = firm;
  damped.damping_time = 0.05f;
  EXPECT_TRUE(warns(of(damped, 0.005f), "damping_time 0.05 s shortens every step"));
  EXPECT_FALSE(warns(of(firm, 0.005f), "damping_time"));
  Material flowing = firm;
  flowing.plastic_yield = 0.05f;
  EXPECT_TRUE(warns(of(flowing, 0.012f), "of its spacings: it loses volume"));
  EXPECT_FALSE(warns(of(flowing, 0.006f), "of its spacings: it loses volume"));
  Material melting = firm;
  melting.temperature = 300.0f;
  melting.alpha_by_temperature = Schedule{{300, 0}, {310, 1}};
  EXPECT_TRUE(warns(of(melting, 0.005f), "no heat passes through it"));
}

}  // namespace warnings_test
}  // namespace mallow
