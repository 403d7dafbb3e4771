// mallow run --series: a row for each frame, whatever interrupts the run.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cli/program.h"
#include "mallow/files.h"
#include "program/frame_surface.h"

namespace mallow::test {
namespace series_test {

namespace fs = std::filesystem;

/// The columns of a series, by name without unit; cells stand between commas and none is in quotes.
std::map<std::string, std::vector<double>> columns(const std::string& text) {
  std::istringstream lines(text);
  std::string line, cell;
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (std::size_t k = 0; std::getline(cells, cell, ','); ++k)
      if (columns.empty() || names.size() == k)
        columns[names.emplace_back(cell.substr(0, cell.find(" [")))];
      else
        columns.at(names.at(k)).push_back(std::strtod(cell.c_str(), nullptr));
  }
  return columns;
}

class cli_series : public CliTest {
 protected:
  bool wait_for_lines(const std::string& file, int lines) const {
    for (int k = 0; k < 200'000; ++k) {
      const std::string text = read_text(folder_ / file);
      if (std::count(text.begin(), text.end(), '\n') >= lines) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
};

TEST_F(cli_series, has_a_row_for_each_frame_and_changes_no_bit_of_the_run) {
  const Outcome with = run({"--frames", "12", "--series", at("a.csv")}), without = run({"--frames", "12"});
  ASSERT_EQ(with.exit_code, 0) << with.err;
  EXPECT_EQ(with.out, without.out);
  const std::string text = read_text(at("a.csv"));
  EXPECT_TRUE(text.starts_with("frame,time,steps,particles,height,")) << "units of its own\n" << text;
  auto series = columns(text);
  ASSERT_EQ(series.at("frame").size(), 13u);
  for (std::size_t k = 0; k <= 12; ++k) {
    EXPECT_EQ(series.at("frame")[k], static_cast<double>(k));
    EXPECT_NEAR(series.at("time")[k], 0.45 * static_cast<double>(k), 1e-9);
    EXPECT_EQ(series.at("steps")[k], 3 * static_cast<double>(k));
    EXPECT_EQ(series.at("particles")[k], 125);
    EXPECT_EQ(series.at("parts")[k], 1);
  }
  EXPECT_NEAR(series.at("height")[0], 4, 0.4);
  EXPECT_NEAR(series.at("volume")[0], 125, 0.02 * 125);
  ASSERT_EQ(run({"--frames", "12", "--series", at("b.csv"), "--threads", "3"}).exit_code, 2) << "given twice";
  ASSERT_EQ(
      run_mallow({"run", scene_, "--frames", "12", "--series", at("b.csv"), "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(read_text(at("b.csv")), text) << "whatever the number of threads";
}

TEST_F(cli_series, counts_what_was_torn_off_a_body_and_pictures_of_it_are_taken) {
  const std::string cut = write("cut.toml", R"([solver]
support_radius = 2.1
[[material]]
name = "jelly"
[[body]]
material = "jelly"
splits = true
box = { count = [24, 3, 3], spacing = 1.0, corner = [0, 0, 5], jitter = 0 }
[[sink]]
box = { min = [10, -9, -9], max = [14, 9, 19] }
[run]
frames = 4
frame_time = 0.45
[render]
width = 64
height = 36
samples = 1
)");
  const Outcome made = run_mallow({"run", cut, "--out", at("cut"), "--series", at("cut.csv"), "--no-film"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  auto series = columns(read_text(at("cut.csv")));
  for (std::size_t k = 1; k <= 4; ++k) {
    EXPECT_EQ(series.at("particles")[k], 20 * 9) << k;
    EXPECT_EQ(series.at("parts")[k], 2) << k;
    EXPECT_EQ(series.at("awake_bodies")[k], 2) << k;
    EXPECT_NEAR(series.at("extent_x")[k], 23, 0.5) << k;
    EXPECT_NEAR(series.at("momentum_z")[k], -0.3 * 0.45 * static_cast<double>(k) * 180, 0.5) << k;
  }
  const nlohmann::json groups = read_json(at("cut/report.json")).at("groups");
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[1].at("name"), "body[0], part 2");
  EXPECT_EQ(groups[1].at("color"), groups[0].at("color"));
  const Outcome again = run_mallow({"render", at("cut"), "--no-film"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(cli_series, counts_no_parts_that_a_sink_took_and_reports_say_what_each_sink_took) {
  // A bar that the first sink cuts in two; the second takes one half.
  const std::string cut = write("cut.toml", R"([solver]
support_radius = 2.1
gravity = [0.0, 0.0, 0.0]
[[material]]
name = "jelly"
[[body]]
material = "jelly"
box = { count = [24, 3, 3], spacing = 1.0, corner = [0, 0, 5], jitter = 0 }
velocity = [1.0, 0.0, 0.0]
[[sink]]
box = { min = [9.6, -9, -9], max = [13.4, 9, 19] }
[[sink]]
box = { min = [24.5, -9, -9], max = [60, 9, 19] }
[run]
frames = 30
frame_time = 0.45
)");
  const Outcome made =
      run_mallow({"run", cut, "--out", at("cut"), "--series", at("cut.csv"), "--no-surface", "--no-images"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  auto series = columns(read_text(at("cut.csv")));
  EXPECT_EQ(series.at("parts")[1], 2) << "cut by the first sink";
  EXPECT_EQ(series.at("parts").back(), 0) << "all is gone";
  EXPECT_EQ(series.at("particles").back(), 0);
  const nlohmann::json report = read_json(at("cut/report.json"));
  const auto& sinks = report.at("sinks");
  ASSERT_EQ(sinks.size(), 2u);
  EXPECT_EQ(sinks[0].at("name"), "sink[0]");
  const int first = sinks[0].at("drained"), second = sinks[1].at("drained");
  EXPECT_GE(first, 10 * 9) << "ten layers come to it, and what they cling to";
  EXPECT_GE(second, 10 * 9) << "as many have passed it";
  EXPECT_EQ(first + second, 24 * 9);
  EXPECT_EQ(report.at("drained"), 24 * 9);
  EXPECT_NE(made.out.find("\ndrained 216\nsink[0].drained " + std::to_string(first) + "\nsink[1].drained " +
                          std::to_string(second) + '\n'),
            std::string::npos)
      << made.out;
}

TEST_F(cli_series, forces_on_colliders_and_weight_are_what_changes_the_momentum) {
  ASSERT_EQ(run({"--frames", "20", "--series", at("a.csv")}).exit_code, 0);
  auto series = columns(read_text(at("a.csv")));
  const std::vector<double>&time = series.at("time"), &momentum = series.at("momentum_z");
  const double weight = -momentum[1] / time[1];  // it falls freely at first
  EXPECT_GT(weight, 0);
  double largest = 0;
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double force = series.at("collider[0].force_z")[k];  // the floor is pushed down
    const double seconds = time[k] - time[k - 1];
    EXPECT_NEAR(momentum[k] - momentum[k - 1], (-weight - force) * seconds, 2e-5 * weight * time.back()) << k;
    largest = std::max(largest, -force);
  }
  EXPECT_GT(largest, weight) << "it has hit the floor";
}

TEST_F(cli_series, torques_on_colliders_are_the_moments_of_their_forces_and_the_report_has_their_means) {
  // A cube lies on a floor of which the origin is 10 away: its weight turns the floor about y.
  const std::string scene =
      write("lies.toml",
            "[solver]\nsupport_radius = 2.1\nsleep_speed = 0\ngravity = [0, 0, -0.3]\n[[material]]\nname = "
            "\"jelly\"\nalpha = "
            "0.2\n"
            "[[body]]\nmaterial = \"jelly\"\n"
            "box = { count = [5, 5, 5], spacing = 1, corner = [7.5, -2.5, 0.5], jitter = 0 }\n"
            "[[collider]]\nsphere = { center = [0, 0, 500], radius = 1 }\n"
            "[[collider]]\nplane = { normal = [0, 0, 1], offset = 0 }\nfriction = 0.5\n"
            "[run]\nframes = 120\nframe_time = 1\n")
          .string();
  const Outcome outcome = run_mallow({"run", scene, "--out", at("out"), "--no-surface", "--no-images",
                                      "--series", at("a.csv"), "--threads", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  auto series = columns(read_text(at("a.csv")));
  const double force = series.at("collider[1].force_z")[120], torque = series.at("collider[1].torque_y")[120];
  EXPECT_LT(force, 0);
  EXPECT_NEAR(torque, -10 * force, 0.01 * std::abs(10 * force)) << "x × F, x the middle of the cube";
  EXPECT_EQ(series.at("collider[0].torque_y")[120], 0);
  const nlohmann::json loads = read_json(at("out/report.json")).at("loads");
  ASSERT_EQ(loads.size(), 2u);
  EXPECT_EQ(loads[1].at("collider"), 1);
  double sum = 0, turned = 0, most = 0;
  for (std::size_t k = 1; k <= 120; ++k) {
    sum += series.at("collider[1].force_z")[k] / 120;
    turned += series.at("collider[1].torque_y")[k] / 120;
    most = std::max(most, -series.at("collider[1].force_z")[k]);
  }
  EXPECT_NEAR(loads[1].at("mean_force").at(2).get<double>(), sum, 1e-6 * std::abs(sum));
  EXPECT_NEAR(loads[1].at("mean_torque").at(1).get<double>(), turned, 1e-6 * std::abs(turned));
  EXPECT_GE(loads[1].at("largest_force").get<double>(), most);
  EXPECT_EQ(loads[0].at("largest_torque"), 0);
}

TEST_F(cli_series, volume_is_that_of_the_surface_where_one_is_drawn) {
  ASSERT_EQ(run({"--out", at("out"), "--series", at("a.csv")}).exit_code, 0);
  const auto series = columns(read_text(at("a.csv")));
  for (const int frame : {0, 1, 2}) {
    const Mesh mesh = read_mesh(at("out/surface/frame_00000" + std::to_string(frame) + ".ply"));
    EXPECT_NEAR(series.at("volume")[static_cast<std::size_t>(frame)], program::enclosed_volume(mesh), 1e-6);
  }
}

TEST_F(cli_series, volume_of_elastic_bodies_is_that_of_their_stretched_regions) {
  // Its top is pulled up by a tenth of the height while the base stands.
  write("bar.toml", R"([solver]
gravity = [0, 0, 0]
support_radius = 2.1
time_step = 0.15
[run]
frame_time = 15
[[material]]
name = "rubber"
alpha = 0
[[body]]
material = "rubber"
box = { count = [4, 4, 21], spacing = 1.0, corner = [0, 0, 0], jitter = 0 }
[[pin]]
box = { min = [-1, -1, -1], max = [5, 5, 1.1] }
[[pin]]
box = { min = [-1, -1, 18.9], max = [5, 5, 22] }
velocity = [0, 0, 0.03]
)");
  ASSERT_EQ(run_mallow({"run", at("bar.toml"), "--frames", "4", "--series", at("bar.csv")}).exit_code, 0);
  const auto bar = columns(read_text(at("bar.csv")));
  const std::vector<double>& volume = bar.at("volume");
  EXPECT_NEAR(volume[0], 16 * 21, 0.02 * 16 * 21);
  EXPECT_GT(volume[4], 1.02 * volume[0]) << "stretched by 1.8 of 20, it has grown";
  EXPECT_LT(volume[4], 1.12 * volume[0]);
}

TEST_F(cli_series, leaves_out_what_a_nozzle_still_holds) {
  write("nozzle.toml", R"([solver]
gravity = [0, 0, -0.3]
support_radius = 2.1
time_step = 0.15
[run]
frame_time = 1.5
[[material]]
name = "paste"
alpha = 0.3
[[emitter]]
material = "paste"
radius = 1.5
spacing = 1.0
speed = 1.0
translate = [0, 0, 10]
rotate = [180, 0, 0]
)");
  ASSERT_EQ(run_mallow({"run", at("nozzle.toml"), "--frames", "4", "--series", at("a.csv")}).exit_code, 0);
  const auto series = columns(read_text(at("a.csv")));
  EXPECT_EQ(series.at("particles")[0], 0);
  EXPECT_EQ(series.at("height")[0], 0);
  for (std::size_t k = 1; k <= 4; ++k) {
    EXPECT_GT(series.at("particles")[k], series.at("particles")[k - 1]);
    EXPECT_LE(series.at("top")[k], 10 + 1e-4) << "the nozzle is there";
    EXPECT_GT(series.at("top")[k], 8);
  }
}

TEST_F(cli_series, of_several_bodies_has_columns_of_each) {
  std::string scene = read_text(scene_);
  scene.insert(scene.find("[[collider]]"), R"([[body]]
material = "paste"
group = "ball, high"
box = { count = [3, 3, 3], spacing = 1.0, corner = [-1, -1, 8] }
)");
  ASSERT_EQ(run_mallow({"run", write("two.toml", scene).string(), "--series", at("a.csv")}).exit_code, 0);
  const std::string text = read_text(at("a.csv"));
  EXPECT_NE(text.find(",cube.height,cube.top,cube.x,"), std::string::npos) << text;
  EXPECT_NE(text.find(",\"ball, high.height\","), std::string::npos) << text;
}

TEST_F(cli_series, has_the_temperatures_of_bodies_that_carry_heat_and_units_where_gravity_is_in_metres) {
  const std::string scene = R"([solver]
gravity = [0, 0, -9.81]
[[material]]
name = "hot"
alpha = 0.3
youngs_modulus = 2e4
rest_density = 1000
temperature = 300
conductivity = 50
[[material]]
name = "plain"
alpha = 0.3
youngs_modulus = 2e4
rest_density = 1000
[[body]]
material = "hot"
group = "warm"
box = { count = [4, 4, 4], spacing = 0.01, corner = [0, 0, 0] }
paint = [{ box = { min = [-1, -1, 0.02], max = [1, 1, 1] }, temperature = 360 }]
[[body]]
material = "plain"
group = "plain"
box = { count = [3, 3, 3], spacing = 0.01, corner = [1, 0, 0] }
[run]
frames = 4
frame_time = 0.02
)";
  ASSERT_EQ(run_mallow({"run", write("hot.toml", scene).string(), "--series", at("a.csv")}).exit_code, 0);
  const std::string text = read_text(at("a.csv"));
  EXPECT_TRUE(text.starts_with("frame,time [s],steps,particles,height [m],")) << text;
  EXPECT_NE(text.find(",warm.temperature_min [K],warm.temperature_mean [K],warm.temperature_max [K]\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("plain.temperature"), std::string::npos);
  const auto series = columns(text);
  const std::vector<double>&least = series.at("warm.temperature_min"),
        &mean = series.at("warm.temperature_mean"), &most = series.at("warm.temperature_max");
  ASSERT_EQ(mean.size(), 5u);
  EXPECT_EQ(least[0], 300);
  EXPECT_EQ(most[0], 360);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(mean[k], 330, 1e-3) << "none goes out, so far";
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_GT(least[k] - least[k - 1], 0) << k;
    EXPECT_LT(most[k] - most[k - 1], 0) << k;
  }
}

TEST_F(cli_series, of_an_interrupted_run_goes_on_to_the_same_bytes) {
  const std::vector<std::string> what = {"run", scene_, "--no-images"};
  std::vector<std::string> whole = what, halves = what;
  // Its end is chosen once it was interrupted: before, it would have to be killed in time.
  halves.insert(halves.end(), {"--frames", "1000000", "--out", at("halves"), "--series", at("halves.csv"),
                               "--threads", "2", "--checkpoint-seconds", "1e-9"});
  {
    Running running(halves);
    ASSERT_TRUE(wait_for_lines("halves.csv", 6));
    running.send(SIGINT);
    ASSERT_EQ(running.wait().exit_code, 128 + SIGINT);
  }
  {
    Running running({"run", "--resume", at("halves")});
    ASSERT_TRUE(wait_for_lines("halves.csv", 15));
    running.send(SIGKILL);
    running.wait();
  }
  const std::string left = read_text(at("halves.csv"));
  EXPECT_TRUE(left.ends_with('\n')) << "whole lines are left";
  const std::string frames = std::to_string(std::ranges::count(left, '\n') + 10);
  whole.insert(whole.end(),
               {"--frames", frames, "--out", at("whole"), "--series", at("whole.csv"), "--threads", "1"});
  ASSERT_EQ(run_mallow(whole).exit_code, 0);
  EXPECT_TRUE(read_text(at("whole.csv")).starts_with(left));
  fs::rename(at("halves.csv"), at("moved.csv"));
  Outcome outcome = run_mallow({"run", "--resume", at("halves")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("halves.csv: --series: cannot be continued: No such file"), std::string::npos)
      << outcome.err;
  outcome = run_mallow({"run", "--resume", at("halves"), "--frames", frames, "--series", at("moved.csv")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_text(at("moved.csv")), read_text(at("whole.csv")));
}

TEST_F(cli_series, begins_where_a_run_goes_on_that_had_none_and_has_the_same_rows_from_there) {
  ASSERT_EQ(run({"--out", at("whole"), "--frames", "5", "--series", at("whole.csv")}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("out"), "--checkpoint-every", "1"}).exit_code, 0);
  const Outcome outcome =
      run_mallow({"run", "--resume", at("out"), "--frames", "4", "--series", at("late.csv")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("begins behind frame 2"), std::string::npos) << outcome.err;
  ASSERT_EQ(run_mallow({"run", "--resume", at("out"), "--frames", "5"}).exit_code, 0)
      << "and goes on by itself";
  const std::string whole = read_text(at("whole.csv")), late = read_text(at("late.csv"));
  const std::string header = whole.substr(0, whole.find('\n') + 1);
  EXPECT_EQ(late, header + whole.substr(whole.find("\n3,") + 1));
}

TEST_F(cli_series, is_written_over_no_input_and_continued_in_no_other_file) {
  Outcome outcome = run({"--series", scene_});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("cube.toml: --series: would be written over"), std::string::npos) << outcome.err;
  ASSERT_EQ(run({"--out", at("two"), "--checkpoint-every", "1", "--series", at("a.csv")}).exit_code, 0);
  const std::string mine = "0123456789\n" + read_text(at("a.csv"));
  write("mine.csv", mine);
  write("short.csv", "frame\n");
  for (const char* other : {"mine.csv", "short.csv"}) {
    const std::string before = read_text(at(other));
    outcome = run_mallow({"run", "--resume", at("two"), "--frames", "4", "--series", at(other)});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("is not the series of this run"), std::string::npos) << outcome.err;
    EXPECT_EQ(read_text(at(other)), before);
  }
}

}  // namespace series_test
}  // namespace mallow::test
