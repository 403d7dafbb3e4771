#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.h"
#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::test {
namespace run_test {

using cli_run = CliTest;

/// Takes the steps that a run takes: towards the times of its frames.
void run_steps(std::int64_t steps, double frame_time, Simulation& simulation) {
  for (int frame = 1; simulation.step_count() < steps; ++frame)
    while (simulation.time() < frame * frame_time && simulation.step_count() < steps)
      simulation.step_towards(frame * frame_time);
}

TEST_F(cli_run, state_is_what_the_library_computes_to_the_last_bit) {
  const Outcome outcome = run({"--steps", "7", "--state-out", at("state.csv")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  Simulation simulation = build(read_scene(scene_), 1);
  run_steps(7, 0.45, simulation);
  std::istringstream lines(read_text(at("state.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "id,x,y,z,vx,vy,vz,body");
  for (std::size_t id = 0; id < 125; ++id) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    EXPECT_EQ(cell, std::to_string(id));
    for (const Vec3& vector : {simulation.positions_by_id()[id], simulation.velocities_by_id()[id]}) {
      for (const float value : vector) {
        std::getline(cells, cell, ',');
        EXPECT_EQ(std::strtof(cell.c_str(), nullptr), value);
      }
    }
    std::getline(cells, cell, ',');
    EXPECT_EQ(cell, "0") << "its body";
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(cli_run, one_and_two_threads_give_the_same_bytes) {
  ASSERT_EQ(
      run_mallow({"run", scene_, "--steps", "12", "--threads", "1", "--state-out", at("one.csv")}).exit_code,
      0);
  ASSERT_EQ(
      run_mallow({"run", scene_, "--steps", "12", "--threads", "2", "--state-out", at("two.csv")}).exit_code,
      0);
  EXPECT_EQ(read_text(at("one.csv")), read_text(at("two.csv")));
}

TEST_F(cli_run, without_out_no_frame_is_written) {
  ASSERT_EQ(run({"--report", at("report.json")}).exit_code, 0);
  EXPECT_EQ(names_in(folder_), (std::vector<std::string>{"cube.toml", "report.json"}));
}

TEST_F(cli_run, report_says_what_ran) {
  ASSERT_EQ(run({"--report", at("report.json"), "--set", "material[0].alpha=0.5"}).exit_code, 0);
  const nlohmann::json report = read_json(at("report.json"));
  EXPECT_EQ(report.at("complete"), true);
  EXPECT_EQ(report.at("error"), "");
  EXPECT_EQ(report.at("scene"), scene_);
  EXPECT_EQ(report.at("overrides"), nlohmann::json::array({"material[0].alpha=0.5"}));
  EXPECT_EQ(report.at("particles"), 125);
  EXPECT_EQ(report.at("frames"), 2);
  EXPECT_EQ(report.at("threads"), 1);
  EXPECT_EQ(report.at("groups").at(0).at("name"), "cube");
  EXPECT_EQ(report.at("groups").at(0).at("material"), "paste");
  EXPECT_EQ(report.at("phases").size(), k_phase_count);
  EXPECT_GT(report.at("stage_seconds").at("motion").get<double>(), 0);
  EXPECT_EQ(report.at("frame_time"), 0.45);
  EXPECT_EQ(report.at("simulated_time"), 2 * 0.45);
  EXPECT_LE(report.at("time_step").at("largest").get<double>(), 0.150001);

  Simulation simulation = build(read_scene(scene_, std::vector<std::string>{"material[0].alpha=0.5"}), 1);
  run_steps(report.at("steps").get<std::int64_t>(), 0.45, simulation);
  EXPECT_EQ(std::strtoull(report.at("state_hash").get<std::string>().c_str(), nullptr, 16),
            simulation.state_hash());
}

TEST_F(cli_run, report_and_results_count_what_tore_and_merged) {
  // Dough on a plate that turns: it is thrown off in pieces.
  const std::string scene = write("dough.toml",
                                  "[solver]\n"
                                  "gravity = [0, 0, -9.81]\n"
                                  "[[material]]\n"
                                  "name = \"paste\"\n"
                                  "alpha = 0.2\n"
                                  "plastic_yield = 0.02\n"
                                  "rest_density = 1000\n"
                                  "youngs_modulus = 2000\n"
                                  "[[body]]\n"
                                  "material = \"paste\"\n"
                                  "box = { count = [10, 10, 6], spacing = 0.01, corner = [0.1, -0.05, 0] }\n"
                                  "[[collider]]\n"
                                  "box = { min = [-0.4, -0.4, -0.1], max = [0.4, 0.4, 0] }\n"
                                  "angular_velocity = [0, 0, 12]\n"
                                  "friction = 0.8\n"
                                  "[[collider]]\n"
                                  "plane = { offset = -0.3 }\n"
                                  "[run]\n"
                                  "frames = 20\n"
                                  "frame_time = 0.033\n")
                                .string();
  const Outcome outcome = run_mallow({"run", scene, "--out", at("out"), "--no-surface", "--no-images"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json report = read_json(at("out/report.json"));
  Simulation simulation = build(read_scene(scene), 1);
  std::int64_t torn = 0, merged = 0, yielded = 0;
  double largest = 0;
  for (int frame = 1; frame <= 20; ++frame)
    while (simulation.time() < frame * 0.033) {
      largest = std::max(largest, simulation.step_towards(frame * 0.033).largest_compression);
      for (const BodyEvent& event : simulation.events()) {
        torn += event.kind == BodyEvent::Kind::torn;
        merged += event.kind == BodyEvent::Kind::merged;
        yielded += event.kind == BodyEvent::Kind::yielded;
      }
    }
  EXPECT_GT(torn, 0);
  EXPECT_EQ(report.at("events").at("torn"), torn);
  EXPECT_EQ(report.at("events").at("merged"), merged);
  EXPECT_EQ(report.at("events").at("yielded"), yielded);
  EXPECT_GT(largest, 0);
  EXPECT_EQ(report.at("compression").at("largest"), largest);
  EXPECT_NE(outcome.out.find("torn " + std::to_string(torn) + '\n'), std::string::npos) << outcome.out;
  EXPECT_NE(read_text(at("out/summary.html")).find("tore " + std::to_string(torn) + " times"),
            std::string::npos);
}

TEST_F(cli_run, warns_at_its_end_of_a_paste_that_was_crushed) {
  const auto scene = [&](const std::string& material) {
    return write(
               "paste.toml",
               "[solver]\ngravity = [0, 0, -9.81]\nvolume_iterations = 0\n[[material]]\nname = "
               "\"paste\"\nalpha = 0.2\n"
               "plastic_yield = 0.02\nrest_density = 1000\nyoungs_modulus = 5000\n" +
                   material +
                   "[[body]]\nmaterial = \"paste\"\nbox = { count = [10, 10, 6], spacing = 0.005, corner = "
                   "[0.06, -0.025, 0] }\n[[collider]]\nbox = { min = [-0.4, -0.4, -0.1], max = [0.4, 0.4, 0] "
                   "}\nangular_velocity = [0, 0, 12]\nfriction = 0.8\n[[collider]]\ncylinder = { start = [0, "
                   "0, -0.2], end = [0, 0, 0.3], radius = 0.19, inside = true }\n[run]\nframes = "
                   "20\nframe_time = 0.033\n")
        .string();
  };
  const std::string crushed = "it was crushed, as all strain beyond plastic_yield flows at once";
  const Outcome at_once = run_mallow({"run", scene(""), "--report", at("report.json")});
  EXPECT_NE(at_once.err.find(crushed), std::string::npos) << at_once.err;
  EXPECT_NE(read_text(at("report.json")).find(crushed), std::string::npos);
  const Outcome creeps = run_mallow({"run", scene("plastic_creep = 20\n")});
  EXPECT_EQ(creeps.err.find("crushed"), std::string::npos) << creeps.err;
}

TEST_F(cli_run, steps_are_kept_to_exactly) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface", "--steps", "4"}).exit_code, 0);
  EXPECT_EQ(read_json(at("out/report.json")).at("steps"), 4);
  EXPECT_EQ(names_in(at("out/particles")),
            (std::vector<std::string>{"frame_000000.ply", "frame_000001.ply"}));
}

TEST_F(cli_run, results_go_to_stdout_and_progress_to_stderr) {
  const Outcome outcome = run({});
  EXPECT_NE(outcome.out.find("particles 125\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("state_hash 0x"), std::string::npos);
  EXPECT_NE(outcome.err.find("simulating 2/2 frames"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\r'), std::string::npos) << "a bar belongs on a terminal only";
}

TEST_F(cli_run, info_names_what_would_run) {
  const Outcome outcome = run_mallow({"info", scene_, "--set", "material[0].viscosity=0.0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("particles        125 in 1 body"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("SPH              on"), std::string::npos);
  EXPECT_NE(outcome.out.find("viscosity        off"), std::string::npos);
}

TEST_F(cli_run, info_says_below_which_speed_and_after_which_time_bodies_sleep) {
  const auto said = [&](std::vector<std::string> settings) {
    std::vector<std::string> arguments = {"info", scene_};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const std::string out = run_mallow(arguments).out;
    const std::size_t at = out.find("sleep  ");
    return at == std::string::npos ? out : out.substr(at, out.find('\n', at) - at);
  };
  EXPECT_EQ(said({"solver.sleep_speed=0.25", "solver.sleep_time=7", "material[0].alpha=0.4"}),
            "sleep            1 of 1 body, slower than 0.25 m/s (as given) for 7 s (as given)");
  EXPECT_EQ(
      said({"solver.time_step=0.1", "material[0].alpha=0.4"}),
      "sleep            1 of 1 body, slower than 0.05 m/s (0.005 spacings in a time step) for 6 s (60 time "
      "steps or more)");
  EXPECT_EQ(said({"solver.sleep_speed=0"}), "sleep            never");
}

TEST_F(cli_run, info_says_what_was_left_out_and_what_bodies_are_at_the_temperatures_that_they_have) {
  const std::string scene = R"([solver]
gravity = [0, 0, -9.81]
[[body]]
material = "chocolate"
box = { count = [4, 4, 4], spacing = 0.005 }
paint = [{ box = { min = [-1, -1, 0.01], max = [1, 1, 1] }, temperature = 290 }]
)";
  const Outcome outcome = run_mallow({"info", write("warm.toml", scene).string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* text :
       {"392.4*", "* is left out: threshold, 40 times gravity", "           0 to 1.4e+04            2e+04",
        "      290 to 313       0.3 to 1           300 to 305", "gravity          0 0 -9.81 m/s2\n",
        "s, 60 time steps\n"})
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << '\n' << outcome.out;
  EXPECT_EQ(outcome.out.find("units "), std::string::npos);
  const Outcome free = run_mallow({"info", scene_, "--set", "solver.gravity=[0,0,-0.3]"});
  EXPECT_NE(free.out.find("gravity          0 0 -0.3\nunits            the scene's own"), std::string::npos)
      << free.out;
}

TEST_F(cli_run, says_where_matter_comes_from_and_goes_and_what_sinks_took) {
  const std::string scene = read_text(scene_) + R"([[body]]
material = "paste"
box = { count = [2, 2, 2], spacing = 1.0, corner = [20.0, 0.0, 3.0] }
[[sink]]
box = { min = [15, -5, -5], max = [30, 9, 30] }
[[sink]]
box = { min = [-50, -50, -5], max = [50, 50, 50] }
outside = true
)";
  const std::string file = write("sinks.toml", scene).string();
  const Outcome outcome = run_mallow({"info", file});
  EXPECT_NE(outcome.out.find("emitters         0\nsinks            2, taking what comes into [15, -5, -5] to "
                             "[30, 9, 30], what comes out of [-50, -50, -5] to [50, 50, 50]\n"),
            std::string::npos)
      << outcome.out;
  const Outcome ran = run_mallow({"run", file, "--out", at("out"), "--no-images", "--no-surface"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_NE(ran.out.find("\ndrained 8\n"), std::string::npos) << ran.out;
  EXPECT_EQ(read_json(at("out/report.json")).at("drained"), 8);
  EXPECT_EQ(run({}).out.find("drained"), std::string::npos) << "no sinks, no word";
}

TEST_F(cli_run, info_print_is_a_scene_that_gives_the_same_state) {
  const Outcome printed = run_mallow({"info", scene_, "--print"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  const std::string again = write("again.toml", printed.out).string();
  ASSERT_EQ(run({"--state-out", at("a.csv")}).exit_code, 0);
  ASSERT_EQ(run_mallow({"run", again, "--state-out", at("b.csv")}).exit_code, 0);
  EXPECT_EQ(read_text(at("a.csv")), read_text(at("b.csv")));
}

TEST_F(cli_run, sample_writes_points_that_a_scene_reads) {
  // A cube of side 10 as OFF: 1,000 cells of side 1.
  const std::string mesh =
      write("cube.off",
            "OFF\n8 6 0\n0 0 0\n10 0 0\n10 10 0\n0 10 0\n0 0 10\n10 0 10\n10 10 10\n0 10 10\n"
            "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n")
          .string();
  const Outcome outcome =
      run_mallow({"sample", mesh, "--count", "1000", "--radius", "1.5", "--out", at("p.csv")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Body points = read_points(folder_ / "p.csv", 1.0f);
  EXPECT_NEAR(static_cast<double>(points.positions.size()), 1000, 10);
  EXPECT_NE(outcome.out.find("points " + std::to_string(points.positions.size()) + "\n"), std::string::npos);
  EXPECT_NE(outcome.out.find("average_neighbors "), std::string::npos);
}

TEST_F(cli_run, what_was_done_to_a_mesh_is_a_warning_of_sample_info_and_run) {
  // The same cube inside out.
  const std::string mesh =
      write("cube.off",
            "OFF\n8 6 0\n0 0 0\n10 0 0\n10 10 0\n0 10 0\n0 0 10\n10 0 10\n10 10 10\n0 10 10\n"
            "4 0 1 2 3\n4 4 7 6 5\n4 0 4 5 1\n4 1 5 6 2\n4 2 6 7 3\n4 3 7 4 0\n")
          .string();
  const std::string scene =
      write("mesh.toml",
            "[solver]\nsupport_radius = 5\n[[material]]\nname = \"a\"\n[[body]]\n"
            "material = \"a\"\nmesh = { file = \"cube.off\", spacing = 2.5 }\n[run]\nframes = 1\n")
          .string();
  for (const auto& arguments : {std::vector<std::string>{"sample", mesh, "--spacing", "2.5"},
                                {"info", scene},
                                {"run", scene, "--report", at("report.json")}}) {
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("mallow: warning: "), std::string::npos) << arguments[0];
    EXPECT_EQ(('\n' + outcome.err).find("\nwarning: "), std::string::npos) << "in one style";
    EXPECT_NE(outcome.err.find("cube.off: the mesh is inside out: its triangles were turned\n"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.out.find("warning"), std::string::npos) << outcome.out;
  }
}

TEST_F(cli_run, quality_turns_the_scene_and_is_reported) {
  const Scene written = read_scene(scene_);
  for (const Quality quality : qualities()) {
    ASSERT_EQ(run({"--quality", name(quality), "--report", at("report.json"), "--steps", "3"}).exit_code, 0);
    EXPECT_EQ(read_json(at("report.json")).at("quality"), name(quality));
    const Outcome printed = run_mallow({"info", scene_, "--quality", name(quality), "--print"});
    const Scene turned = read_scene(write("turned.toml", printed.out));
    EXPECT_EQ(turned.solver.time_step, written.solver.time_step);
    EXPECT_EQ(turned.solver.time_step_factor, with_quality(written, quality).solver.time_step_factor);
    EXPECT_EQ(turned.materials[0].material.region_stride,
              with_quality(written, quality).materials[0].material.region_stride);
    EXPECT_EQ(turned.run.frame_time, 0.45);
    EXPECT_EQ(turned.surface.voxels, with_quality(written, quality).surface.voxels);
  }
  const Outcome refused = run({"--quality", "best"});
  EXPECT_EQ(refused.exit_code, 2);
  for (const Quality quality : qualities())
    EXPECT_NE(refused.err.find(name(quality)), std::string::npos) << refused.err;
}

TEST_F(cli_run, keys_lists_every_section) {
  const Outcome outcome = run_mallow({"keys"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* key : {"time_step", "update_threshold", "voxel_size", "frame_time", "field_of_view"}) {
    EXPECT_NE(outcome.out.find(key), std::string::npos) << key;
  }
}

TEST_F(cli_run, a_hidden_collider_acts_and_is_not_seen) {
  const std::vector<std::string> frame = {"--frames", "1", "--no-film", "--no-surface"};
  const auto run_into = [&](const std::string& folder, const std::string& visible) {
    std::vector<std::string> arguments = {"--out", at(folder), "--set", "collider[0].visible=" + visible};
    arguments.insert(arguments.end(), frame.begin(), frame.end());
    ASSERT_EQ(run(arguments, true).exit_code, 0);
  };
  run_into("seen", "true");
  run_into("hidden", "false");
  const auto picture = [&](const std::string& folder) {
    return read_text(folder_ / folder / "images/frame_000001.png");
  };
  EXPECT_EQ(read_json(at("seen/report.json")).at("state_hash"),
            read_json(at("hidden/report.json")).at("state_hash"));
  const std::string as_run = picture("seen");
  EXPECT_NE(as_run, picture("hidden"));
  const Outcome outcome =
      run_mallow({"render", at("seen"), "--no-film", "--set", "collider[0].visible=false"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(picture("seen"), picture("hidden"));
  // The next call starts from the run again.
  ASSERT_EQ(run_mallow({"render", at("seen"), "--no-film"}).exit_code, 0);
  EXPECT_EQ(picture("seen"), as_run);
}

TEST_F(cli_run, help_names_the_qualities) {
  const Outcome outcome = run_mallow({"run", "--help"});
  EXPECT_NE(outcome.out.find("{realtime,balanced,accurate}"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("->"), std::string::npos) << outcome.out;
  EXPECT_EQ(run({"--quality", "1"}).exit_code, 2);
}

}  // namespace run_test
}  // namespace mallow::test
