#include <sys/mount.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <map>
#include <thread>

#include "cli/program.h"
#include "mallow/files.h"

namespace mallow::test {
namespace checkpoint_test {

namespace fs = std::filesystem;

class cli_checkpoint : public CliTest {
 protected:
  /// Content of all frames of a run, by name.
  std::map<std::string, std::string> frames(const std::string& folder) const {
    std::map<std::string, std::string> contents;
    for (const char* what : {"particles", "surface", "images"})
      for (const std::string& name : names_in(folder_ / folder / what))
        contents[what + ('/' + name)] = read_text(folder_ / folder / what / name);
    return contents;
  }

  void expect_same_run(const std::string& folder, const std::string& uninterrupted) const {
    const auto a = frames(folder), b = frames(uninterrupted);
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [name, content] : b) {
      ASSERT_TRUE(a.contains(name)) << name;
      EXPECT_TRUE(a.at(name) == content) << name;
    }
    const nlohmann::json report = read_json(folder_ / folder / "report.json"),
                         expected = read_json(folder_ / uninterrupted / "report.json");
    for (const char* key : {"complete", "error", "scene", "overrides", "frames", "steps", "simulated_time",
                            "time_step", "reference_updates", "events", "compression", "state_hash"})
      EXPECT_EQ(report.at(key), expected.at(key)) << key;
    EXPECT_EQ(read_text(folder_ / folder / "scene.toml"), read_text(folder_ / uninterrupted / "scene.toml"));
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / folder))
      EXPECT_FALSE(entry.path().filename().string().ends_with(".partial")) << entry.path();
  }

  Outcome resume(const std::string& folder, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", "--resume", at(folder)});
    return run_mallow(more);
  }

  void flip_a_bit(const std::string& file) const {
    std::string bytes = read_text(folder_ / file);
    bytes[bytes.size() / 2] ^= 4;
    write(file, bytes);
  }
};

bool wait_for(const fs::path& file) {
  for (int k = 0; k < 200'000; ++k) {
    if (fs::exists(file)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST_F(cli_checkpoint, run_goes_on_and_is_drawn_after_a_sink_took_a_body) {
  write("sink.toml", R"([solver]
support_radius = 2.1
[[material]]
name = "jelly"
alpha = 0.2
[[body]]
material = "jelly"
box = { count = [4, 4, 4], spacing = 1.0, corner = [20, 0, 3] }
[[body]]
material = "jelly"
box = { count = [4, 4, 4], spacing = 1.0, corner = [0, 0, 3] }
[[collider]]
plane = { offset = 0.0 }
[[sink]]
box = { min = [15, -5, -5], max = [30, 9, 30] }
)");
  Running running({"run", at("sink.toml"), "--frames", "100000", "--no-images", "--out", at("sunk")});
  ASSERT_TRUE(wait_for(folder_ / "sunk/particles/frame_000004.ply"));
  running.send(SIGINT);
  running.wait();
  const int frames = static_cast<int>(names_in(folder_ / "sunk/particles").size());
  const Outcome longer = resume("sunk", {"--frames", std::to_string(frames + 3)});
  ASSERT_EQ(longer.exit_code, 0);
  EXPECT_TRUE(longer.out.starts_with("particles 64\n")) << longer.out;
  EXPECT_EQ(read_json(folder_ / "sunk/report.json").at("groups").size(), 2u);
  EXPECT_EQ(run_mallow({"surface", at("sunk")}).exit_code, 0);
}

TEST_F(cli_checkpoint, interrupted_run_goes_on_to_the_same_bytes) {
  const std::vector<std::string> what = {"run", scene_, "--no-images"};
  std::vector<std::string> whole = what, halves = what;
  // Its end is chosen once it was interrupted: before, it would have to be killed in time.
  halves.insert(halves.end(), {"--frames", "1000000", "--out", at("halves"), "--threads", "2"});

  int threads = 3;
  Running running(halves);
  ASSERT_TRUE(wait_for(folder_ / "halves/particles/frame_000002.ply"));
  running.send(SIGINT);
  Outcome outcome = running.wait();
  ASSERT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
  EXPECT_NE(outcome.err.find("to go on: mallow run --resume " + at("halves")), std::string::npos)
      << outcome.err;
  EXPECT_EQ(read_json(at("halves/report.json")).at("complete"), false);

  // Once more, by the other signal.
  {
    Running again({"run", "--resume", at("halves"), "--threads", std::to_string(threads)});
    ASSERT_TRUE(wait_for(folder_ / "halves/particles/frame_000040.ply"));
    again.send(SIGTERM);
    ASSERT_EQ(again.wait().exit_code, 128 + SIGTERM);
  }
  const std::string frames = std::to_string(read_json(at("halves/report.json")).at("frames").get<int>() + 10);
  outcome = resume("halves", {"--threads", "1", "--frames", frames});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  whole.insert(whole.end(), {"--frames", frames, "--out", at("whole"), "--threads", "1"});
  ASSERT_EQ(run_mallow(whole).exit_code, 0);
  EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
  expect_same_run("halves", "whole");
  EXPECT_EQ(read_json(at("halves/report.json")).at("resumed_after").size(), 2u);
}

TEST_F(cli_checkpoint, run_of_so_many_steps_goes_on_to_the_same_state) {
  Running running({"run", scene_, "--steps", "100000000", "--out", at("out"), "--no-images", "--no-surface"});
  ASSERT_TRUE(wait_for(folder_ / "out/particles/frame_000003.ply"));
  running.send(SIGINT);
  ASSERT_EQ(running.wait().exit_code, 128 + SIGINT);
  const std::string steps = std::to_string(read_json(at("out/report.json")).at("steps").get<int>() + 20);
  ASSERT_EQ(resume("out", {"--steps", steps, "--state-out", at("state.csv")}).exit_code, 0);
  ASSERT_EQ(run({"--steps", steps, "--state-out", at("whole.csv")}).exit_code, 0);
  EXPECT_EQ(read_text(at("state.csv")), read_text(at("whole.csv")));
  EXPECT_EQ(names_in(at("out")),
            (std::vector<std::string>{".mallow-run", "checkpoint", "checkpoint.previous", "particles",
                                      "report.json", "scene.toml", "summary.html"}));
}

TEST_F(cli_checkpoint, are_written_every_so_many_frames_and_a_run_can_be_made_longer) {
  ASSERT_EQ(run({"--out", at("out"), "--checkpoint-every", "2", "--frames", "5"}, true).exit_code, 0);
  EXPECT_TRUE(fs::exists(at("out/checkpoint")) && fs::exists(at("out/checkpoint.previous")));
  const Outcome outcome = resume("out", {"--frames", "9"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("frame 5\n"), std::string::npos) << outcome.err;
  ASSERT_EQ(run({"--out", at("whole"), "--frames", "9"}, true).exit_code, 0);
  expect_same_run("out", "whole");
  EXPECT_EQ(frames("out").size(), 30u);
}

TEST_F(cli_checkpoint, is_left_by_a_run_that_is_complete_and_it_goes_on_from_its_end) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "3"}, true).exit_code, 0);
  EXPECT_FALSE(fs::exists(at("out/checkpoint.previous"))) << "one is enough";
  Outcome outcome = resume("out", {"--frames", "6"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("frame 3\n"), std::string::npos) << outcome.err;
  ASSERT_EQ(run({"--out", at("whole"), "--frames", "6"}, true).exit_code, 0);
  expect_same_run("out", "whole");
  // Nothing to do: nothing is written.
  const std::string last = read_text(at("out/checkpoint"));
  ASSERT_EQ(resume("out").exit_code, 0);
  EXPECT_EQ(read_text(at("out/checkpoint")), last);
  // One of so many steps ends between two frames.
  ASSERT_EQ(run({"--out", at("steps"), "--steps", "7"}).exit_code, 0);
  outcome = resume("steps", {"--frames", "6"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("step 7, frame 2\n"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_json(at("steps/report.json")).at("state_hash"),
            read_json(at("whole/report.json")).at("state_hash"));
}

TEST_F(cli_checkpoint, are_written_every_so_many_seconds) {
  const Outcome outcome = run({"--out", at("out"), "--checkpoint-seconds", "0.001", "--frames", "9"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(at("out/checkpoint")));
}

TEST_F(cli_checkpoint, that_is_damaged_is_passed_over_for_the_one_before) {
  ASSERT_EQ(run({"--out", at("whole"), "--frames", "6"}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("out"), "--frames", "6", "--checkpoint-every", "2"}).exit_code, 0);
  flip_a_bit("out/checkpoint");
  fs::remove(at("out/particles/frame_000005.ply"));
  const Outcome outcome = resume("out");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("mallow: warning: " + at("out/checkpoint") + ": "), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("damaged"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("checkpoint.previous: step 12, frame 4"), std::string::npos) << outcome.err;
  expect_same_run("out", "whole");
}

TEST_F(cli_checkpoint, says_what_to_do_where_there_is_none_to_resume) {
  Outcome outcome = resume("nowhere");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("holds no run of mallow"), std::string::npos) << outcome.err;

  ASSERT_EQ(run({"--out", at("out"), "--no-surface", "--checkpoint-seconds", "0"}).exit_code, 0);
  outcome = resume("out", {"--frames", "5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("holds a run that is complete"), std::string::npos) << outcome.err;

  fs::remove(at("out/report.json"));
  outcome = resume("out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("holds no checkpoint"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("--overwrite"), std::string::npos) << outcome.err;

  const std::string last = read_text(at("out/particles/frame_000002.ply"));
  for (const char* file : {"out/checkpoint", "out/checkpoint.previous"}) write(file, "half of a checkpoint");
  outcome = resume("out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("checkpoint: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("checkpoint.previous: "), std::string::npos) << outcome.err;
  EXPECT_EQ(read_text(at("out/particles/frame_000002.ply")), last);
}

TEST_F(cli_checkpoint, warns_of_a_scene_that_has_changed_and_moves_as_before) {
  ASSERT_EQ(run({"--out", at("whole"), "--frames", "6"}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("out"), "--frames", "3", "--checkpoint-every", "3"}).exit_code, 0);
  std::string changed = read_text(scene_);
  changed.replace(changed.find("alpha = 0.7"), 11, "alpha = 0.4");
  write("changed.toml", changed);
  const Outcome outcome = run_mallow({"run", at("changed.toml"), "--resume", at("out"), "--frames", "6"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string whose = at("changed.toml") + " is not as the scene that the run began with";
  for (const std::string& line : {std::string("material[0].alpha is 0.4, was 0.7: without effect"), whose})
    EXPECT_NE(outcome.err.find(line), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("time_step"), std::string::npos) << outcome.err;
  expect_same_run("out", "whole");

  const Outcome same = run_mallow({"run", scene_, "--resume", at("out"), "--frames", "6"});
  ASSERT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(same.err.find("warning"), std::string::npos) << same.err;
  EXPECT_NE(same.err.find("nothing is left to run"), std::string::npos) << same.err;
  EXPECT_NE(same.err.find("--frames 12"), std::string::npos) << "what to ask for\n" << same.err;
  EXPECT_EQ(outcome.err.find("nothing is left"), std::string::npos) << outcome.err;
}

TEST_F(cli_checkpoint, refuses_options_that_ask_a_run_that_goes_on_to_move_otherwise) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "3", "--set", "solver.time_step=0.1"}).exit_code, 0);
  Outcome outcome = resume(
      "out", {"--frames", "6", "--set", "solver.gravity=[0.0, 0.0, -1.0]", "--set", "surface.voxels=20"});
  EXPECT_EQ(outcome.exit_code, 2);
  for (const char* text : {"--set: is not allowed with --resume", "solver.gravity is [0.0, 0.0, -1.0], was ",
                           "leave it out, or begin another run"})
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  outcome = resume("out", {"--frames", "6", "--quality", "accurate"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--quality accurate: is not allowed with --resume"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("solver.time_step_factor is 0.5, was "), std::string::npos) << outcome.err;
  EXPECT_EQ(names_in(at("out/particles")).size(), 4u) << "nothing was run";

  // What it began with, and how frames look, may be said.
  outcome = resume("out", {"--frames", "6", "--set", "solver.time_step=0.1", "--set", "surface.voxels=20"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("--set: surface.voxels is 20, was "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("from the next frame on"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("has changed since"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("time_step"), std::string::npos) << outcome.err;

  ASSERT_EQ(run({"--out", at("fast"), "--frames", "3", "--quality", "realtime"}).exit_code, 0);
  for (const std::vector<std::string>& same :
       {std::vector<std::string>{"run", "--resume", at("fast"), "--quality", "realtime"},
        {"run", scene_, "--resume", at("fast"), "--quality", "realtime"}}) {
    outcome = run_mallow(same);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("time_step"), std::string::npos) << outcome.err;
  }
}

TEST_F(cli_checkpoint, run_that_goes_on_keeps_the_pictures_that_are_there_as_it_would_take_them) {
  std::string scene = read_text(scene_);
  ASSERT_EQ(scene.find("eye"), std::string::npos) << "its camera has the whole film in view";
  const std::vector<std::string> small = {"--set", "render.width=64", "--set", "render.height=36",
                                          "--set", "render.samples=1"};
  const auto with = [&](std::vector<std::string> what) {
    what.insert(what.end(), small.begin(), small.end());
    return what;
  };
  ASSERT_EQ(run(with({"--out", at("out"), "--frames", "4"}), true).exit_code, 0);
  const auto picture = [&](int frame) {
    return at("out/images/frame_00000" + std::to_string(frame) + ".png");
  };
  const auto age = [&](int frame) { return fs::last_write_time(picture(frame)); };
  const auto first = age(0);
  const std::string content = read_text(picture(2));
  fs::remove(picture(2));
  write("out/images/frame_000003.png", "half of a picture");
  ASSERT_EQ(resume("out").exit_code, 0);
  EXPECT_EQ(age(0), first) << "it is as it would be taken";
  EXPECT_EQ(read_text(picture(2)), content);
  EXPECT_EQ(read_text(picture(3)).substr(1, 3), "PNG") << "what is not whole is taken again";
  ASSERT_EQ(resume("out", {"--set", "render.samples=2"}).exit_code, 0);
  EXPECT_NE(age(0), first) << "another picture";
}

TEST_F(cli_checkpoint, is_left_by_a_run_whose_step_fails_and_it_says_that_the_step_would_fail_again) {
  // Heat that spreads nearly as fast as steps carry, and faster once the cube lies on the plate.
  const std::string scene = write("hot.toml", R"([solver]
gravity = [0.0, 0.0, -9.81]
time_step = 0.01
[[material]]
name = "metal"
alpha = 0.2
rest_density = 1000.0
temperature = 300.0
conductivity = 6.5e5
specific_heat = 1000.0
[[body]]
material = "metal"
box = { count = [6, 6, 6], spacing = 0.01, corner = [0, 0, 0.2], jitter = 0 }
[[collider]]
plane = {}
temperature = 350.0
[run]
frames = 15
frame_time = 0.0333333
)")
                                .string();
  const Outcome failed = run_mallow({"run", scene, "--out", at("out"), "--no-images", "--no-surface"});
  EXPECT_EQ(failed.exit_code, 1);
  for (const char* text : {"carries heat that spreads so fast", "frames are whole, and a checkpoint is there",
                           "would fail in the same step"})
    EXPECT_NE(failed.err.find(text), std::string::npos) << failed.err;
  const nlohmann::json report = read_json(at("out/report.json"));
  ASSERT_GT(report.at("steps"), 6);
  const Outcome again = resume("out");
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("step " + std::to_string(report.at("steps").get<int>()) + ", frame " +
                           std::to_string(report.at("frames").get<int>())),
            std::string::npos)
      << again.err;
  EXPECT_EQ(read_json(at("out/report.json")).at("state_hash"), report.at("state_hash"));
}

TEST_F(cli_checkpoint, overwrite_removes_them) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "4", "--checkpoint-every", "1"}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface"}).exit_code, 0);
  EXPECT_EQ(names_in(at("out")), (std::vector<std::string>{".mallow-run", "checkpoint", "particles",
                                                           "report.json", "scene.toml", "summary.html"}));
}

TEST_F(cli_checkpoint, options_that_contradict_are_refused) {
  for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{
           {"run", "--resume", at("out"), "--out", at("other")},
           {"run", "--resume", at("out"), "--overwrite"},
           {"run", scene_, "--checkpoint-every", "5"},
           {"run", scene_, "--out", at("other"), "--checkpoint-every", "0"}}) {
    const Outcome outcome = run_mallow(bad);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  }
}

TEST_F(cli_checkpoint, goes_on_after_a_full_disk_was_given_room) {
  fs::create_directory(at("disk"));
  if (::mount("none", at("disk").c_str(), "tmpfs", 0, "size=512k") != 0)
    GTEST_SKIP() << "only root can mount a small disk";
  const std::vector<std::string> what = {"--frames", "200", "--no-surface", "--checkpoint-every", "1"};
  std::vector<std::string> full = what, whole = what;
  full.insert(full.end(), {"--out", at("disk/out")});
  whole.insert(whole.end(), {"--out", at("whole")});
  Outcome outcome = run(full);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("No space left"), std::string::npos) << outcome.err;
  outcome = resume("disk/out");
  EXPECT_EQ(outcome.exit_code, 1) << "the disk is still full; " << outcome.err;

  ASSERT_EQ(::mount("none", at("disk").c_str(), "tmpfs", MS_REMOUNT, "size=16m"), 0);
  outcome = resume("disk/out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(run(whole).exit_code, 0);
  expect_same_run("disk/out", "whole");
  ::umount(at("disk").c_str());
}

TEST_F(cli_checkpoint, run_that_goes_on_knows_a_part_that_came_and_is_gone) {
  // The first sink cuts the bar, the second takes the part that was split off.
  write("parts.toml", R"([solver]
support_radius = 2.1
gravity = [0.0, 0.0, 0.0]
[[material]]
name = "blue"
[[body]]
material = "blue"
splits = true
box = { count = [3, 3, 18], spacing = 1.0, corner = [20, 0, 0], jitter = 0 }
velocity = [2.0, 0.0, 0.0]
[[sink]]
box = { min = [27.0, -9.0, 6.5], max = [60.0, 9.0, 10.5] }
[[sink]]
box = { min = [33.0, -9.0, -9.0], max = [60.0, 9.0, 6.4] }
[run]
frames = 20
frame_time = 0.45
)");
  ASSERT_EQ(run_mallow({"run", at("parts.toml"), "--out", at("out"), "--no-images"}).exit_code, 0);
  const auto groups = [&] {
    std::vector<std::string> names;
    const nlohmann::json report = read_json(at("out/report.json"));
    for (const auto& group : report.at("groups")) names.push_back(group.at("name"));
    return names;
  };
  const std::vector<std::string> all = {"body[0]", "body[0], part 2"};
  ASSERT_EQ(groups(), all);
  fs::remove(at("out/report.json"));  // as if it had been killed before it wrote this one
  write("out/report.json", R"({"groups": [{"name": "body[0]", "material": "blue", "spacing": 1.0}]})");
  const Outcome longer = resume("out", {"--frames", "22"});
  ASSERT_EQ(longer.exit_code, 0) << longer.err;
  EXPECT_EQ(groups(), all);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"surface", at("out")}, {"export", at("out"), "--surface", "obj"}}) {
    const Outcome outcome = run_mallow(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
}

TEST_F(cli_checkpoint, options_that_the_run_began_with_may_be_said_again_where_quality_turns_them) {
  std::vector<std::string> options = {
      "--set", "solver.time_step_factor=0.8", "--set", "surface.voxels=20", "--quality", "accurate"};
  std::vector<std::string> began = {"--out", at("out"), "--frames", "3"};
  began.insert(began.end(), options.begin(), options.end());
  ASSERT_EQ(run(began).exit_code, 0);
  const auto resume_with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "run");
    words.insert(words.end(), {"--resume", at("out")});
    words.insert(words.end(), options.begin(), options.end());
    return run_mallow(words);
  };
  for (const std::vector<std::string>& scene : {std::vector<std::string>{}, {scene_}}) {
    const Outcome outcome = resume_with(scene);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("voxels"), std::string::npos) << outcome.err;
  }
  // The scene alone need not hold.
  std::string wrong = read_text(scene_);
  wrong.replace(wrong.find("voxels = 16"), 11, "voxels = -1");
  write("cube.toml", wrong);
  EXPECT_EQ(resume_with({scene_}).exit_code, 0);
  options[1] = "solver.time_step_factor=0.9";
  EXPECT_EQ(resume_with({}).exit_code, 2);
}

TEST_F(cli_checkpoint, run_that_goes_on_takes_pictures_again_where_their_light_is_another) {
  const auto light = [&](char red) {
    std::string pixels;
    for (int k = 0; k < 8; ++k) pixels += {red, char(100), char(100), char(129)};
    write("sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + pixels);
  };
  light(10);
  ASSERT_EQ(run({"--out", at("out"), "--set", "render.environment=sky.hdr"}, true).exit_code, 0);
  const std::string before = read_text(at("out/images/frame_000001.png"));
  light(120);
  ASSERT_EQ(resume("out").exit_code, 0);
  EXPECT_NE(read_text(at("out/images/frame_000001.png")), before);
}

}  // namespace checkpoint_test
}  // namespace mallow::test
