#include <nlohmann/json.hpp>
// Frame k of a run shows the time k · frame_time, whatever the steps are, and all that a run writes says so.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "cli/program.h"
#include "mallow/files.h"
#include "mallow/quality.h"
#include "program/external_program.h"

namespace mallow::test {
namespace frames_test {

/// A scene in metres under 9.81 m/s², whose steps the speed of sound holds far below time_step.
constexpr const char* k_limited = R"(
[solver]
support_radius = 0.21
time_step = 0.15
gravity = [0, 0, -9.81]
[[material]]
name = "a"
alpha = 0.7
pressure_coefficient = 1600
update_threshold = 400
[[body]]
material = "a"
box = { count = [6, 6, 6], spacing = 0.1, corner = [0, 0, 1] }
[run]
frames = 12
frame_time = 0.041666667
[render]
width = 64
height = 36
samples = 1
)";

/// Frames four times as dense as steps.
constexpr const char* k_dense = R"(
[solver]
support_radius = 0.21
time_step = 0.04
gravity = [0, 0, 0]
[[material]]
name = "a"
alpha = 0
[[body]]
material = "a"
box = { count = [3, 3, 3], spacing = 0.1 }
velocity = [1.0, 0.0, 0.0]
[run]
frames = 8
frame_time = 0.01
)";

std::string frame_name(int frame) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frame_%06d", frame);
  return name.data();
}

class cli_frames : public CliTest {
 protected:
  Outcome run_scene(const char* scene, const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {
        "run", write("scene.toml", scene).string(), "--out", at(out), "--threads", "1", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_mallow(arguments);
  }
  ParticleFrame frame(const std::string& out, int number) const {
    return read_particles(folder_ / out / "particles" / (frame_name(number) + ".ply"));
  }
  void expect_times(const std::string& out, int frames, double frame_time) const {
    for (int k = 0; k <= frames; ++k) ASSERT_EQ(frame(out, k).time, k * frame_time) << out << ", frame " << k;
    EXPECT_EQ(names_in(folder_ / out / "particles").size(), static_cast<std::size_t>(frames) + 1);
  }
};

TEST_F(cli_frames, show_whole_multiples_of_the_frame_time_where_limits_shorten_the_steps) {
  ASSERT_EQ(run_scene(k_limited, "out", {"--no-surface", "--no-images"}).exit_code, 0);
  expect_times("out", 12, 0.041666667);
  const nlohmann::json report = read_json(at("out/report.json"));
  EXPECT_EQ(report.at("frame_time"), 0.041666667);
  EXPECT_EQ(report.at("simulated_time"), 12 * 0.041666667);
  EXPECT_GT(report.at("time_step").at("limited_steps"), 12) << "the scene is one whose steps are limited";
  EXPECT_NE(read_text(at("out/summary.html")).find("<th>frames</th><td>12, 0.04167 s from one to the next"),
            std::string::npos);
}

TEST_F(cli_frames, that_are_denser_than_the_steps_each_show_a_time_of_their_own) {
  ASSERT_EQ(run_scene(k_dense, "out", {"--no-surface", "--no-images"}).exit_code, 0);
  expect_times("out", 8, 0.01);
  const float start = frame("out", 0).positions[0].x();
  for (int k = 1; k <= 8; ++k)
    EXPECT_NEAR(frame("out", k).positions[0].x() - start, 0.01f * static_cast<float>(k), 1e-6f);
  const nlohmann::json report = read_json(at("out/report.json"));
  EXPECT_EQ(report.at("steps"), 8);
  EXPECT_EQ(report.at("time_step").at("limited_steps"), 0) << "no limit shortened them";
}

TEST_F(cli_frames, are_a_full_step_apart_where_no_frame_time_is_given) {
  std::string scene = k_limited;
  scene.replace(scene.find("frame_time = 0.041666667\n"), 25, "");
  const std::vector<std::string> few = {"--no-surface", "--no-images", "--frames", "4"};
  ASSERT_EQ(run_scene(scene.c_str(), "out", few).exit_code, 0);
  expect_times("out", 4, static_cast<double>(0.15f));
  EXPECT_GT(read_json(at("out/report.json")).at("steps"), 20) << "many steps a frame, and no slow motion";
}

TEST_F(cli_frames, of_all_qualities_show_the_same_times) {
  std::string scene = k_limited;
  for (const double frame_time : {0.041666667, static_cast<double>(0.15f)}) {
    for (const Quality quality : qualities()) {
      const std::vector<std::string> turned = {"--no-surface", "--no-images", "--frames", "3",
                                               "--quality",    name(quality)};
      ASSERT_EQ(run_scene(scene.c_str(), "out", turned).exit_code, 0);
      expect_times("out", 3, frame_time);
    }
    if (frame_time < 0.1) scene.replace(scene.find("frame_time = 0.041666667\n"), 25, "");
  }
}

TEST_F(cli_frames, have_the_same_times_in_every_file_that_plays_them) {
  Outcome outcome = run_scene(k_limited, "out");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  outcome = run_mallow({"export", at("out"), "--surface", "vtp,usda", "--particles", "vtp"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string kind : {"surface", "particles"}) {
    const std::string text = read_text(folder_ / "out/export" / (kind + ".pvd"));
    std::size_t found = 0;
    for (int k = 0; k <= 12; ++k) {
      found = text.find("timestep=\"", found) + 10;
      EXPECT_EQ(std::strtod(text.c_str() + found, nullptr), k * 0.041666667) << kind << ", frame " << k;
    }
  }
  // A time code of USD is a frame of the film, at 30 frames a second.
  const std::string usd = read_text(at("out/export/surface.usda"));
  const std::size_t rate = usd.find("timeCodesPerSecond = ");
  ASSERT_NE(rate, std::string::npos);
  EXPECT_NEAR(std::strtod(usd.c_str() + rate + 21, nullptr), 30, 1e-9);
  EXPECT_NE(usd.find("endTimeCode = 12\n"), std::string::npos);
  EXPECT_EQ(names_in(at("out/images")).size(), 13u);
  if (!program::is_installed("ffprobe")) return;
  const std::string ask =
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=nb_read_frames,r_frame_rate -of csv=p=0 '" +
      at("out/film.mp4") + "'";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(ask.c_str(), "r"), ::pclose);
  std::array<char, 64> answer{};
  ASSERT_TRUE(std::fgets(answer.data(), answer.size(), pipe.get()));
  EXPECT_STREQ(answer.data(), "30/1,13\n");
}

TEST_F(cli_frames, of_a_run_that_is_resumed_between_two_are_those_of_one_that_was_not) {
  const std::vector<std::string> plain = {"--no-surface", "--no-images"};
  ASSERT_EQ(run_scene(k_limited, "whole", plain).exit_code, 0);
  std::vector<std::string> begun = plain;
  begun.insert(begun.end(), {"--steps", "7", "--checkpoint-seconds", "1e-9"});
  ASSERT_EQ(run_scene(k_limited, "out", begun).exit_code, 0);
  const int frames = read_json(at("out/report.json")).at("frames");
  EXPECT_NE(frame("out", frames).step, 7) << "the last step is one between two frames";
  const Outcome outcome = run_mallow({"run", "--resume", at("out"), "--frames", "12", "--threads", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("checkpoint: step 7, frame " + std::to_string(frames)), std::string::npos)
      << outcome.err;
  for (int k = 0; k <= 12; ++k) {
    const std::string name = "particles/" + frame_name(k) + ".ply";
    EXPECT_TRUE(read_text(folder_ / "out" / name) == read_text(folder_ / "whole" / name)) << name;
  }
  EXPECT_EQ(read_json(at("out/report.json")).at("state_hash"),
            read_json(at("whole/report.json")).at("state_hash"));
}

}  // namespace frames_test
}  // namespace mallow::test
