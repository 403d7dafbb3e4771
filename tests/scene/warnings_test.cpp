#include <optional>

#include "scene/scene_fixture.h"
#include "scene/warning_scenes.h"

namespace mallow {
namespace warnings_test {

using scene_warnings = SceneFixture;

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

TEST_F(scene_warnings, name_a_frame_time_in_milliseconds) {
  EXPECT_TRUE(warns(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 33\n"))),
                    "frame_time is in seconds, and 0.0333333 shows real time"));
  EXPECT_FALSE(
      warns(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 0.5\n"))), "frame_time"));
}

TEST_F(scene_warnings, name_no_units_of_si_where_a_scene_has_its_own) {
  const auto with = [&](const std::string& gravity) {
    std::string text = falling("1.0", "2.1", gravity, "");
    return warnings_of(read(text.insert(text.find("alpha"), "update_threshold = 0.1\n")));
  };
  EXPECT_TRUE(warns(with("-0.3"), "(0.3) is 0.07, below twice gravity (0.6): at rest"));
  EXPECT_TRUE(warns(with("-9.81"), "(0.3) is 0.07 m/s2, below twice gravity (19.62 m/s2): at rest"));
}

TEST_F(scene_warnings, name_keyframes_that_are_half_a_turn_or_more_apart) {
  const auto turned_by = [&](const std::string& degrees) {
    return warnings_of(read(
        falling("0.1", "0.21", "-9.81", "") +
        "[[collider]]\nbox = { min = [-1, -1, -3], max = [1, 1, -2] }\nkeyframes = [{ time = 0 }, { time = "
        "1, rotate = [0, 0, " +
        degrees + "] }]\n"));
  };
  EXPECT_TRUE(warns(turned_by("360"), "collider[0]: keyframes[1].rotate is 360 degrees from the one before"));
  EXPECT_TRUE(warns(turned_by("-180"), "shorter way round"));
  EXPECT_FALSE(warns(turned_by("179"), "shorter way round"));
}

TEST_F(scene_warnings, name_turns_that_frames_do_not_show_and_colliders_that_fling_what_they_meet) {
  const std::string paddle = "[[collider]]\nbox = { min = [-0.1, -1, -3], max = [0.1, 1, -2] }\n";
  const auto of = [&](const std::string& collider) {
    return warnings_of(read(jelly("alpha = 0.3", collider)));
  };
  const std::string frames = "frames show no more than half a turn", flung = "what it meets is flung away";
  EXPECT_TRUE(warns(of(paddle + "angular_velocity = [0.0, 0.0, 200.0]\n"),
                    "collider[0]: turns by 382 degrees from one frame to the next, and frames show no more "
                    "than half a turn, nor which way; angular_velocity is in rad/s, and 200 degrees a second "
                    "are 3.49066; let it"));
  EXPECT_TRUE(warns(of(paddle + "angular_velocity = [0.0, 0.0, 200.0]\n"),
                    "collider 0: a part of it moves at 200.998 m/s, 17 spacings in a step of"));
  EXPECT_FALSE(warns(of(paddle + "angular_velocity = [0.0, 0.0, 90.0]\n"), frames)) << "172 degrees";
  EXPECT_FALSE(warns(of(paddle + "angular_velocity = [0.0, 0.0, 90.0]\n"), flung)) << "7 spacings";
  EXPECT_TRUE(
      warns(of(paddle + "keyframes = [{ time = 0 }, { time = 0.03, rotate = [0, 0, 170] }]\n"), frames));
  EXPECT_FALSE(warns(of("[[collider]]\ncylinder = { start = [0, 0, -3], end = [0, 0, -2], radius = 0.1 }\n"
                        "angular_velocity = [0.0, 0.0, 200.0]\n"),
                     frames))
      << "nobody sees a roller turn";
  EXPECT_TRUE(warns(of(paddle + "velocity = [0.0, 0.0, -2000.0]\n"), "moves at 2000 m/s, "));
  EXPECT_FALSE(warns(of(paddle + "velocity = [0.0, 0.0, -20.0]\n"), flung));
}

TEST_F(scene_warnings, name_a_collider_that_comes_into_the_mouth_of_a_nozzle) {
  const auto of = [&](const std::string& emitter, const std::string& collider) {
    return warns(warnings_of(read(
                     jelly("alpha = 0.3", "[[emitter]]\nmaterial = \"blob\"\nradius = 0.3\nspacing = 0.1\n" +
                                              emitter + "[[collider]]\n" + collider))),
                 " s collider[0] stands in its mouth");
  };
  const std::string still = "translate = [5.0, 0.0, 5.0]\n";
  const std::string wall = "box = { min = [7, -1, 4], max = [8, 1, 6] }\n",
                    comes = "velocity = [-4.0, 0.0, 0.0]\n";
  EXPECT_TRUE(of(still, wall + comes));
  EXPECT_TRUE(of(still, wall + "keyframes = [{ time = 0 }, { time = 1, translate = [-2, 0, 0] }]\n"));
  EXPECT_TRUE(of(still + "velocity = [2.0, 0.0, 0.0]\n", wall)) << "or the nozzle to it";
  EXPECT_TRUE(
      of("keyframes = [{ time = 0, translate = [5, 0, 5] }, { time = 0.5, translate = [7, 0, 5] }]\n", wall));
  EXPECT_FALSE(of(still, wall));
  EXPECT_FALSE(of(still, wall + "velocity = [-1.0, 0.0, 0.0]\n")) << "not within the run of a second";
  EXPECT_FALSE(of(still + "stop = 0.3\n", wall + comes)) << "it has stopped by then";
  EXPECT_FALSE(of(still + "speed = [[0.0, 1.0], [0.3, 0.0]]\n", wall + comes));
  EXPECT_FALSE(of(still,
                  "box = { min = [-9, -9, 4], max = [9, 9, 6], inside = true }\n"
                  "velocity = [-1.0, 0.0, 0.0]\n"))
      << "it is in the box";
}

TEST_F(scene_warnings, name_bodies_that_merge_with_nobody) {
  const std::string other =
      "[[material]]\nname = \"other\"\nalpha = 1.0\nrest_density = 1000.0\n[[body]]\n"
      "material = \"other\"\nmerges = true\nbox = { count = [4, 4, 4], spacing = 0.1, "
      "corner = [1, 0, 0] }\n";
  const auto all = warnings_of(read(jelly("alpha = 0.3", other)));
  EXPECT_TRUE(warns(all, "body 'body[1]': merges with nobody: no other body of its material 'other' merges"));
  EXPECT_FALSE(warns(warnings_of(read(jelly("alpha = 0.3"))), "merges with nobody"));
}

TEST_F(scene_warnings, name_what_bodies_rub_and_stick_by_where_pressure_keeps_them_apart) {
  const std::string beside =
      "[[body]]\nmaterial = \"blob\"\nbox = { count = [4, 4, 4], spacing = 0.1, "
      "corner = [1, 0, 0] }\n";
  const auto of = [&](const std::string& contact) {
    return warnings_of(read(jelly("alpha = 0.3\nfriction = 2.0\nadhesion = 100.0", beside),
                            {"solver.contact=\"" + contact + '"'}));
  };
  EXPECT_TRUE(warns(of("pressure"), "friction 2 has no effect where solver.contact is \"pressure\""));
  EXPECT_TRUE(warns(of("pressure"), "adhesion 100 has no effect"));
  EXPECT_FALSE(warns(of("constraint"), "has no effect"));
}

TEST_F(scene_warnings, name_when_bodies_sleep_where_none_ever_does) {
  const auto of = [&](std::vector<std::string> settings) {
    return warnings_of(read(jelly("alpha = 0.3"), settings));
  };
  EXPECT_TRUE(warns(of({"solver.contact=\"pressure\"", "solver.sleep_speed=0.1"}),
                    "solver.sleep_speed has no effect where solver.contact is \"pressure\""));
  EXPECT_TRUE(warns(of({"solver.sleep_speed=0", "solver.sleep_time=2"}),
                    "solver.sleep_time has no effect where solver.sleep_speed is 0"));
  EXPECT_FALSE(warns(of({"solver.contact=\"pressure\"", "solver.sleep_speed=0"}), "has no effect"));
  EXPECT_FALSE(warns(of({"solver.sleep_speed=0.1", "solver.sleep_time=2"}), "has no effect"));
}

TEST_F(scene_warnings, name_a_nozzle_whose_layers_are_not_as_wide_as_its_mouth) {
  const auto of = [&](const std::string& radius, const std::string& spacing) {
    return warnings_of(read(jelly("alpha = 0.3", "[[emitter]]\nmaterial = \"blob\"\nradius = " + radius +
                                                     "\nspacing = " + spacing +
                                                     "\ntranslate = [3.0, 0.0, 3.0]\nspeed = 0.5\n")));
  };
  EXPECT_TRUE(
      warns(of("0.15", "0.1"), "layers of its emitter have 9 particles, 27% more than fit its mouth"));
  EXPECT_FALSE(warns(of("0.4", "0.1"), "than fit its mouth"));
}

TEST_F(scene_warnings, name_turns_that_are_in_radians) {
  const auto of = [&](const std::string& rotate) {
    return warnings_of(read(jelly("alpha = 0.3",
                                  "[[collider]]\nbox = { min = [-9, -9, -3], max = [9, 9, -2] }\n"
                                  "rotate = " +
                                      rotate + "\n")));
  };
  for (const char* const turn : {"[0.0, 0.0, 1.5708]", "[3.14159, 0.0, 0.0]", "[0.7854, 0.0, -1.0472]"})
    EXPECT_TRUE(warns(of(turn), "collider[0].rotate: ")) << turn;
  EXPECT_TRUE(warns(of("[0.0, 0.0, 1.5708]"), "90 degrees are 1.5708 radians"));
  for (const char* const turn :
       {"[0.0, 0.0, 0.0]", "[0.0, 0.0, 90.0]", "[1.0, 2.0, 3.0]", "[0.5, 1.5708, 0.0]"})
    EXPECT_FALSE(warns(of(turn), "radians")) << turn;
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

TEST_F(scene_warnings, name_an_emitter_whose_mouth_is_inside_a_collider) {
  const auto above = [&](const std::string& height) {
    return warnings_of(
        read(jelly("alpha = 0.3",
                   "[[collider]]\nplane = { normal = [0, 0, 1], offset = 0.0 }\n[[emitter]]\nmaterial = "
                   "\"blob\"\nradius = 0.3\nspacing = 0.1\ntranslate = [5, 0, " +
                       height + "]\nspeed = 1.0\n")));
  };
  EXPECT_TRUE(warns(above("-0.2"), "leave its emitter inside collider 0"));
  EXPECT_FALSE(warns(above("0.1"), "emitter")) << "the layers that it holds may be";
}

TEST_F(scene_warnings, name_an_emitter_of_one_particle_a_layer) {
  const auto wide = [&](const std::string& radius) {
    return warnings_of(read(jelly("alpha = 0.3", "[[emitter]]\nmaterial = \"blob\"\nradius = " + radius +
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

TEST_F(scene_warnings, name_what_acts_on_nothing) {
  EXPECT_TRUE(warns(warnings_of(read(jelly("alpha = 1.0\nyoungs_modulus = 1000.0"))), "youngs_modulus"));
  EXPECT_FALSE(warns(warnings_of(read(jelly("alpha = 0.9\nyoungs_modulus = 1000.0"))), "youngs_modulus"));
  std::string printed = jelly("alpha = 0.0");
  printed.replace(0, 8, "[solver]\nformulation = \"printed\"");
  EXPECT_TRUE(warns(warnings_of(read(printed)), "has no effect where alpha is 0"));
}

TEST_F(scene_warnings, name_native_arithmetic_that_nothing_has) {
  const auto native = [](std::string scene, const std::string& more = "") {
    return scene.replace(0, 8, "[solver]\narithmetic = \"native\"\n" + more);
  };
  EXPECT_TRUE(warns(warnings_of(read(native(jelly("alpha = 0.0")))), "there are none where alpha is 0"));
  const std::string lowest = std::string("instruction_level = \"") + name(InstructionLevel::baseline) + '"';
  EXPECT_TRUE(warns(warnings_of(read(native(jelly("alpha = 0.5"), lowest))), "no fused multiply-adds"));
  if (best_instruction_level() > InstructionLevel::baseline) {
    EXPECT_FALSE(warns(warnings_of(read(native(jelly("alpha = 0.5")))), "arithmetic"));
  }
}

TEST_F(scene_warnings, name_creep_that_takes_longer_than_the_run) {
  const std::string flows = "alpha = 0.3\nplastic_yield = 0.05\nplastic_creep = ";
  EXPECT_TRUE(warns(warnings_of(read(jelly(flows + "0.001"))), "plastic_creep"));
  EXPECT_FALSE(warns(warnings_of(read(jelly(flows + "1.0"))), "plastic_creep"));
}

TEST_F(scene_warnings, name_what_begins_when_the_run_is_over) {
  const auto emits = [&](const std::string& start) {
    return warns(warnings_of(read(jelly("alpha = 0.3",
                                        "[[emitter]]\nmaterial = \"blob\"\nradius = 0.3\n"
                                        "spacing = 0.1\ntranslate = [5, 0, 5]\nstart = " +
                                            start))),
                 "emitter[0]: start 5 s is not reached, as the run covers 0.999999 s");
  };
  EXPECT_TRUE(emits("5.0"));
  EXPECT_FALSE(emits("0.5"));
  const auto moves = [&](const std::string& first) {
    return warns(warnings_of(read(jelly("alpha = 0.3",
                                        "[[collider]]\nplane = { offset = -1.0 }\nkeyframes = "
                                        "[{ time = " +
                                            first + " }, { time = 9.0, translate = [0, 0, 1] }]\n"))),
                 "collider[0]: keyframes[0].time 5 s is not reached");
  };
  EXPECT_TRUE(moves("5.0"));
  EXPECT_FALSE(moves("0.0"));
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

TEST_F(scene_warnings, name_particles_that_nothing_keeps_apart) {
  const auto of = [&](float alpha, float stiffness, std::optional<int> iterations) {
    Simulation s({.volume_iterations = iterations});
    Body body = sample(Lattice{.count = {4, 4, 4}});
    body.stiffness.assign(body.positions.size(), 1.0f);
    body.stiffness.front() = stiffness;
    s.add_body(body, {.alpha = alpha});
    s.prepare();
    return s.info().warnings;
  };
  EXPECT_TRUE(warns(of(0, 0, {}), "1 of its particles have a stiffness of 0"));
  EXPECT_FALSE(warns(of(0, 0, 2), "a stiffness of 0"));
  EXPECT_FALSE(warns(of(0.5f, 0, {}), "a stiffness of 0"));
  EXPECT_FALSE(warns(of(0, 0.5f, {}), "a stiffness of 0"));
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

TEST_F(scene_warnings, name_voxels_that_particles_fall_between_and_smoothing_that_takes_drops_away) {
  const auto with = [&](const std::string& settings) {
    return warnings_of(read(falling("0.1", "0.21", "-9.81", "frame_time = 0.03\n[surface]\n" + settings)));
  };
  EXPECT_TRUE(with("").empty());
  EXPECT_TRUE(with("voxels_per_spacing = 1.6\n").empty());
  const std::string lost = "a particle by itself may lie between voxels";
  EXPECT_TRUE(warns(with("voxels_per_spacing = 1.5\n"), lost));
  EXPECT_TRUE(warns(with("voxels_per_spacing = 1.5\n"), "gives 1.5 voxels a spacing, and below 1.57459"));
  EXPECT_TRUE(with("voxels_per_spacing = 1.5\nparticle_radius = 0.6\n").empty());
  EXPECT_TRUE(warns(with("voxel_size = 0.07\n"), "voxel_size gives 1.42857"));
  EXPECT_TRUE(with("voxel_size = 0.06\n").empty());
  // Four particles an axis, whose box is at least four spacings long.
  EXPECT_TRUE(with("voxels = 8\n").size() == 0u);
  const std::string many = falling("0.1", "0.21", "-9.81", "frame_time = 0.03\n[surface]\nvoxels = 8\n");
  std::string wide = many;
  wide.replace(wide.find("[4, 4, 4]"), 9, "[9, 9, 9]");
  EXPECT_TRUE(warns(warnings_of(read(wide)), "voxels gives at most 0.888889 voxels a spacing"));
  EXPECT_TRUE(with("smoothing = 30\n").empty());
  EXPECT_TRUE(warns(with("smoothing = 60\n"), "takes half or more of what is a particle wide"));
  EXPECT_TRUE(warns(with("voxels_per_spacing = 2\nsmoothing = 12\n"), "smoothing 12"));
  EXPECT_TRUE(with("voxels_per_spacing = 4\nsmoothing = 100\n").empty());
}

/// Every line that `mallow info` shows: of the scene, and of what was done to its bodies.
std::vector<std::string> told(const Scene& scene) {
  std::vector<std::string> all;
  const SimulationInfo info = build(scene, 1, &all).info();
  for (const std::string& text : warnings(scene, info)) all.push_back(text);
  return all;
}

TEST_F(scene_warnings, name_paint_that_does_nothing) {
  const auto painted = [&](const std::string& material, const std::string& paint) {
    std::string text = jelly(material);
    text.replace(text.find("[run]"), 0, "paint = [" + paint + "]\n");
    return told(read(text));
  };
  const std::string ball = "{ sphere = { radius = 0.2 }, alpha = 0.5 }";
  EXPECT_TRUE(painted("alpha = 0.3", ball).empty());
  EXPECT_TRUE(warns(painted("alpha = 0.3", ball + ", { sphere = { radius = 0.2 }, translate = [5, 5, 5], "
                                                  "alpha = 0.5 }"),
                    "paint[1] holds none of the body's 64 particles"));
  const std::string melts =
      "temperature = 290.0\nconductivity = 1.0\nalpha_by_temperature = [[280.0, 0.1], [310.0, 1.0]]\n";
  EXPECT_TRUE(warns(painted(melts, ball), "paint[0].alpha has no effect"));
  EXPECT_FALSE(warns(painted(melts, "{ sphere = { radius = 0.2 }, temperature = 300 }"), "no effect"));
  EXPECT_TRUE(warns(painted(melts + "plastic_yield_by_temperature = [[280.0, 0.1], [310.0, 0.0]]",
                            "{ sphere = { radius = 0.2 }, plastic_yield = 0.2 }"),
                    "paint[0].plastic_yield has no effect"));
}

TEST_F(scene_warnings, name_a_volume_tolerance_that_is_always_met) {
  const auto with = [&](const std::string& tolerance) {
    std::string text = jelly("alpha = 0.3\nplastic_yield = 0.05");
    text.replace(0, 8, "[solver]\nvolume_tolerance = " + tolerance);
    return warnings_of(read(text));
  };
  EXPECT_TRUE(warns(with("1"),
                    "solver.volume_tolerance 1 ends volume iterations where matter is compressed "
                    "by 100% in the mean"));
  for (const char* usual : {"0.0", "0.001", "0.05"}) EXPECT_FALSE(warns(with(usual), "volume_tolerance"));
}

TEST_F(scene_warnings, name_a_stride_that_leaves_more_regions_not_fewer) {
  const auto regions = [&](const std::string& stride) {
    return build(read(jelly("alpha = 0.3\nregion_stride = " + stride)), 1).info().bodies[0].regions;
  };
  const auto with = [&](const std::string& stride) {
    return warnings_of(read(jelly("alpha = 0.3\nregion_stride = " + stride)));
  };
  EXPECT_TRUE(warns(with("100000"), "region_stride 100000 is more than the 39 particles of a region"));
  EXPECT_TRUE(warns(with("100000"), "about 8 leaves fewest"));
  EXPECT_GT(regions("100000"), regions("8"));
  EXPECT_FALSE(warns(with("8"), "region_stride"));
}

TEST_F(scene_warnings, blame_short_steps_on_what_shortens_them) {
  const auto with = [&](const std::string& material, const std::string& solver) {
    std::string text = jelly(material);
    text.replace(0, 8, "[solver]\n" + solver);
    return warnings_of(read(text));
  };
  const auto of_step = with("alpha = 0.3", "time_step = 1e-4");
  EXPECT_TRUE(warns(of_step, "solver.time_step 0.0001 s is shorter than the 0.00829502 s"));
  const auto of_damping = with("alpha = 0.3\nyoungs_modulus = 2e4\ndamping_time = 1", "");
  EXPECT_TRUE(warns(of_damping, "damping_time 1 s asks for steps so short that pressure"));
  const auto of_modulus = with("alpha = 0.3\nyoungs_modulus = 1e10", "");
  EXPECT_TRUE(warns(of_modulus, "youngs_modulus asks for steps so short that pressure"));
  for (const auto& all : {of_step, of_damping, of_modulus})
    EXPECT_FALSE(warns(all, "2 to 3 spacings are usual"));
  std::string wide = jelly("alpha = 0.9");
  wide.replace(wide.find("0.21"), 4, "0.45");
  EXPECT_FALSE(warns(warnings_of(read(wide)), "solver.time_step 0"));
}

TEST_F(scene_warnings, say_how_many_steps_a_frame_takes_where_nobody_waits_for_them) {
  const std::string stiff = "alpha = 0.3\nyoungs_modulus = 2000\ndamping_time = ";
  EXPECT_TRUE(warns(warnings_of(read(jelly(stiff + "100"))), "run: a frame of 0.0333333 s takes "));
  EXPECT_FALSE(warns(warnings_of(read(jelly(stiff + "0.01"))), "run: a frame of"));
  EXPECT_FALSE(
      warns(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 33\n"))), "run: a frame of"))
      << "it is in milliseconds";
}

TEST_F(scene_warnings, name_a_material_that_hides_the_one_that_is_known_by_its_name) {
  const auto own = [&](const std::string& material, const std::string& gravity) {
    return warnings_of(read("[solver]\ngravity = [0, 0, " + gravity + "]\n" + material +
                            "[[body]]\nmaterial = \"toothpaste\"\nbox = { count = [4, 4, 4], spacing = "
                            "0.01 }\n[run]\nframe_time = 0.033\n"));
  };
  const std::string named = "[[material]]\nname = \"toothpaste\"\n";
  const std::string hides = "material 'toothpaste': the scene's own [[material]] is taken";
  EXPECT_TRUE(warns(own(named + "alpha = 0.5\n", "-9.81"), hides));
  EXPECT_FALSE(warns(own(named + "alpha = 0.5\n", "-0.3"), hides)) << "no metres";
  EXPECT_FALSE(
      warns(own(named + "alpha = 0.2\nyoungs_modulus = 8000\nrest_density = 1300\n", "-9.81"), hides))
      << "says all that it needs";
  EXPECT_TRUE(own("", "-9.81").empty());
  const Scene known = read(
      "[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = \"toothpaste\"\nbox = { "
      "count = [4, 4, 4], spacing = 0.01 }\n");
  EXPECT_FALSE(warns(warnings_of(read(print_scene(known))), hides)) << "it is that one";
}

TEST_F(scene_warnings, name_a_material_in_metres_where_gravity_is_not) {
  const auto under = [&](const std::string& gravity) {
    return warnings_of(read("[solver]\ntime_step = 1e-3\ngravity = [0, 0, " + gravity +
                            "]\n[[body]]\nmaterial = \"honey\"\nbox = { count = [4, 4, 4], spacing = 0.01 "
                            "}\n"));
  };
  const std::string metres = "its numbers are in metres, kilograms and seconds, and a gravity of ";
  EXPECT_TRUE(warns(under("-981"), metres));
  EXPECT_TRUE(warns(under("-1"), metres));
  for (const char* meant : {"-9.81", "-3.7", "-25", "0"}) EXPECT_FALSE(warns(under(meant), metres)) << meant;
}

}  // namespace warnings_test
}  // namespace mallow
