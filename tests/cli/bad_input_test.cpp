#include "cli/program.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace mallow::test {
namespace bad_input_test {

using cli_bad_input = CliTest;

void expect_refused(const Outcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& word : words) {
    EXPECT_NE(outcome.err.find(word), std::string::npos) << "'" << word << "' is not in: " << outcome.err;
  }
}

TEST_F(cli_bad_input, command_line_that_makes_no_sense) {
  expect_refused(run_mallow({}), {"run", "info", "sample", "surface", "render", "export", "keys"});
  expect_refused(run_mallow({"walk"}), {"walk"});
  expect_refused(run_mallow({"run"}), {"SCENE"});
  expect_refused(run({"--frames", "-1"}), {"--frames", "must be a number >= 0, is -1"});
  expect_refused(run({"--frames", "many"}), {"--frames"});
  expect_refused(run({"--frames", "1", "--steps", "1"}), {"--steps", "--frames"});
  expect_refused(run({"--threads", "100000"}), {"--threads"});
  expect_refused(run({"--no-surfaces"}), {"--no-surfaces", "did you mean --no-surface?"});
  expect_refused(run({"--ot", at("run")}), {"did you mean --out?"});
  expect_refused(run_mallow({"sample", at("m.off")}), {"--count", "--spacing"});
  expect_refused(run_mallow({"sample", at("m.off"), "--count", "9", "--out", at("p.xyz")}), {".csv", ".ply"});
}

TEST_F(cli_bad_input, is_easily_avoided_where_help_shows_how_values_are_set) {
  for (const char* command : {"run", "info", "render", "surface"}) {
    const Outcome help = run_mallow({command, "--help"});
    EXPECT_NE(help.out.find("--set KEY=VALUE "), help.out.npos) << help.out;
    EXPECT_EQ(help.out.find("--set TEXT"), help.out.npos) << help.out;
  }
  EXPECT_NE(run_mallow({"run", "--help"}).out.find("--set body[0].material=honey"), std::string::npos);
}

TEST_F(cli_bad_input, help_and_version_are_no_errors) {
  EXPECT_EQ(run_mallow({"--help"}).exit_code, 0);
  EXPECT_EQ(run_mallow({"run", "--help"}).exit_code, 0);
  EXPECT_EQ(run_mallow({"--version"}).exit_code, 0);
}

TEST_F(cli_bad_input, scene_that_is_missing_or_broken) {
  expect_refused(run_mallow({"run", at("none.toml")}), {"none.toml"});
  write("broken.toml", "[solver\n");
  expect_refused(run_mallow({"run", at("broken.toml")}), {"broken.toml:1:"});
}

TEST_F(cli_bad_input, every_problem_of_a_scene_at_once_with_its_line) {
  write("bad.toml",
        "[solver]\ntime_stp = 0.1\nsupport_radius = -1.0\n[[material]]\nname = \"a\"\nalpha = 1.5\n"
        "[[body]]\nmaterial = \"a\"\nbox = { count = [2, 2, 2], spacing = 1.0 }\n");
  expect_refused(run_mallow({"run", at("bad.toml")}),
                 {"bad.toml:2:", "time_step", "bad.toml:3:", "bad.toml:6:"});
}

TEST_F(cli_bad_input, overrides_are_checked_like_the_scene) {
  expect_refused(run({"--set", "solver.tim_step=0.1"}), {"time_step"});
  expect_refused(run({"--set", "material[0].alpha=2"}), {"material[0].alpha", "2"});
  expect_refused(run({"--set", "nonsense"}), {"nonsense"});
}

TEST_F(cli_bad_input, outputs_are_checked_before_anything_runs) {
  expect_refused(run({"--state-out", at("no/such/folder/s.csv")}), {"s.csv", "No such file or directory"});
  expect_refused(run({"--report", folder_.string()}), {"is a folder"});
  write("file", "");
  expect_refused(run({"--out", at("file")}), {"is a file"});
  expect_refused(run({"--out", at("file/out")}), {"file/out"});
  expect_refused(run({"--out", "/proc/mallow"}), {"/proc/mallow"});
}

TEST_F(cli_bad_input, a_scene_that_is_refused_leaves_no_folder) {
  expect_refused(run({"--out", at("out"), "--set", "material[0].alpha=2"}), {"alpha"});
  EXPECT_FALSE(std::filesystem::exists(at("out")));
}

TEST_F(cli_bad_input, mesh_that_is_open_or_missing) {
  expect_refused(run_mallow({"sample", at("none.off"), "--count", "9"}), {"none.off"});
  write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expect_refused(run_mallow({"sample", at("open.off"), "--count", "9"}), {"open"});
}

TEST_F(cli_bad_input, folder_that_holds_no_run) {
  expect_refused(run_mallow({"surface", folder_.string()}), {"no scene.toml"});
  expect_refused(run_mallow({"render", at("none")}), {"no scene.toml"});
}

TEST_F(cli_bad_input, a_step_that_cannot_be_taken_fails_the_run_and_is_reported) {
  // Gravity makes it so fast that a particle would cross its support radius in less than a thousandth of the
  // time step.
  write(
      "fast.toml",
      "[solver]\nsupport_radius = 2.0\ntime_step = 0.15\ngravity = [0.0, 0.0, -1e6]\n[[material]]\nname = \"a\"\nalpha = 0.7\n[[body]]\nmaterial = \"a\"\n"
      "box = { count = [3, 3, 3], spacing = 1.0 }\n");
  const Outcome outcome =
      run_mallow({"run", at("fast.toml"), "--report", at("report.json"), "--state-out", at("state.csv")});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  // Header and 27 particles: what was computed is not lost.
  const std::string state = read_text(at("state.csv"));
  EXPECT_EQ(std::count(state.begin(), state.end(), '\n'), 28);
  EXPECT_NE(outcome.err.find("particle"), std::string::npos) << outcome.err;
  const nlohmann::json report = read_json(at("report.json"));
  EXPECT_EQ(report.at("complete"), false);
  EXPECT_EQ(report.at("steps"), 0);
  EXPECT_NE(report.at("error"), "");
}

}  // namespace bad_input_test
}  // namespace mallow::test
