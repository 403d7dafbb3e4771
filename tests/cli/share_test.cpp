// --frames and --share: many processes over one folder write what one would.
#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/program.h"
#include "program/external_program.h"

namespace mallow::test {
namespace share_test {

namespace fs = std::filesystem;

class cli_share : public CliTest {
 protected:
  /// All that a command made, by name; not reports, which tell how long it took.
  std::map<std::string, std::string> files(const std::string& folder,
                                           const std::vector<std::string>& parts) const {
    std::map<std::string, std::string> contents;
    for (const std::string& part : parts) {
      if (fs::is_regular_file(folder_ / folder / part))
        contents[part] = read_text(folder_ / folder / part);
      else
        for (const std::string& name : names_in(folder_ / folder / part))
          if (fs::is_regular_file(folder_ / folder / part / name))
            contents[part + '/' + name] = read_text(folder_ / folder / part / name);
    }
    return contents;
  }
  void expect_same(const std::string& folder, const std::string& other,
                   const std::vector<std::string>& parts) const {
    const auto a = files(folder, parts), b = files(other, parts);
    ASSERT_EQ(a.size(), b.size());
    ASSERT_FALSE(a.empty());
    for (const auto& [name, content] : b) {
      ASSERT_TRUE(a.contains(name)) << name;
      EXPECT_TRUE(a.at(name) == content) << name;
    }
  }
  /// Two folders with the same frames, without pictures.
  void make_runs(const std::string& frames) const {
    ASSERT_EQ(run({"--out", at("one"), "--frames", frames}).exit_code, 0);
    fs::copy(at("one"), at("many"), fs::copy_options::recursive);
  }
  /// What it said where it had come to its end before.
  static std::string kill(std::unique_ptr<Running>& running) {
    running->send(SIGKILL);
    const Outcome outcome = running->wait();
    running.reset();
    EXPECT_LE(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == -1 ? "" : outcome.out;
  }
  static bool wait_for_files(const fs::path& folder, std::size_t count) {
    for (int k = 0; k < 200'000; ++k) {
      if (names_in(folder).size() >= count) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
};

TEST_F(cli_share, four_processes_of_which_one_is_killed_write_what_one_writes) {
  make_runs("24");
  const auto draw = [&](const std::string& folder) -> std::vector<std::string> {
    return {"surface", at(folder), "--threads", "1", "--set", "surface.voxels=24"};
  };
  const auto render = [&](const std::string& folder) -> std::vector<std::string> {
    return {"render",           at(folder), "--threads",       "1", "--set", "render.samples=16", "--set",
            "render.width=160", "--set",    "render.height=90"};
  };
  using Command = std::function<std::vector<std::string>(const std::string& folder)>;
  for (const Command& command : {Command(draw), Command(render)}) {
    ASSERT_EQ(run_mallow(command("one")).exit_code, 0);
    std::vector<std::string> share = command("many");
    share.push_back("--share");
    std::vector<std::unique_ptr<Running>> slots;
    for (int slot = 0; slot < 4; ++slot) slots.push_back(std::make_unique<Running>(share));
    const bool pictures = share[0] == "render";
    if (pictures) {
      ASSERT_TRUE(wait_for_files(folder_ / "many/images", 4));
      EXPECT_TRUE(kill(slots[1]).empty() || names_in(at("many/images")).size() == 25) << "still at work";
      slots[1] = std::make_unique<Running>(share);
      ASSERT_TRUE(wait_for_files(folder_ / "many/images", 9));
      EXPECT_TRUE(kill(slots[3]).empty() || names_in(at("many/images")).size() == 25) << "still at work";
    }
    std::size_t done = 0;
    for (auto& slot : slots) {
      if (!slot) continue;
      const Outcome outcome = slot->wait();
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.out.find("left"), std::string::npos) << "each ends when all is there";
      done += static_cast<std::size_t>(std::stoi(outcome.out.substr(outcome.out.find(' '))));
    }
    if (!pictures) {
      EXPECT_EQ(done, 25u) << "each frame by one of them";
    }
    expect_same("many", "one", {pictures ? "images" : "surface", "scene.toml"});
    if (pictures && program::is_installed("ffmpeg")) expect_same("many", "one", {"film.mp4"});
    const Outcome late = run_mallow(share);
    EXPECT_EQ(late.out, pictures ? "pictures 0\n" : "surfaces 0\n") << "all are there";
  }
  for (const auto& entry : fs::recursive_directory_iterator(at("many")))
    EXPECT_FALSE(entry.path().filename().string().ends_with(".partial")) << entry.path();
}

TEST_F(cli_share, frames_are_named_as_in_python_and_the_last_part_joins_the_film) {
  make_runs("6");
  ASSERT_EQ(run_mallow({"render", at("one")}).exit_code, 0);
  const auto part = [&](const std::string& frames) {
    return run_mallow({"render", at("many"), "--frames", frames});
  };
  const std::string film = std::string("; the call that does the last of them adds ") +
                           (program::is_installed("ffmpeg") ? "the film\n" : "summary.html\n");
  EXPECT_EQ(part("1:-1:2").out, "pictures 3\nstill to do: frames 0, 2, 4, 6" + film);
  EXPECT_EQ(names_in(at("many/images")),
            (std::vector<std::string>{"frame_000001.png", "frame_000003.png", "frame_000005.png"}));
  EXPECT_FALSE(fs::exists(at("many/film.mp4")));
  EXPECT_EQ(part("-1:").out, "pictures 1\nstill to do: frames 0, 2, 4" + film);
  EXPECT_EQ(part(":5:2").out, "pictures 3\n");
  expect_same("many", "one", {"images"});
  if (program::is_installed("ffmpeg")) expect_same("many", "one", {"film.mp4"});

  EXPECT_EQ(run_mallow({"render", at("many"), "--frames", "2:4", "--set", "render.width=80"}).out,
            "pictures 2\nstill to do: frames 0, 1, 4 to 6" + film)
      << "pictures of other settings do not count";
  EXPECT_EQ(run_mallow({"render", at("many"), "--share"}).out, "pictures 2\n") << "those are taken again";
  expect_same("many", "one", {"images"});
}

TEST_F(cli_share, exports_are_shared_and_what_plays_them_is_added_once) {
  make_runs("24");
  const auto write = [&](const std::string& folder) -> std::vector<std::string> {
    return {"export",      at(folder), "--surface",   "glb,vtp,usda,vdb",
            "--particles", "vtp,csv",  "--animation", "glb"};
  };
  ASSERT_EQ(run_mallow(write("one")).exit_code, 0);
  std::vector<std::string> share = write("many");
  share.push_back("--share");
  std::vector<std::unique_ptr<Running>> slots;
  for (int slot = 0; slot < 4; ++slot) slots.push_back(std::make_unique<Running>(share));
  ASSERT_TRUE(wait_for_files(folder_ / "many/export/particles", 3));
  std::string said = kill(slots[2]);
  slots[2] = std::make_unique<Running>(share);
  for (auto& slot : slots) {
    const Outcome outcome = slot->wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    said += outcome.out;
  }
  EXPECT_EQ(said, "surface 25\nparticles 25\nanimation 25\n");
  // What the killed one was writing stays behind under a name of its own.
  for (const char* part : {"many/export/surface", "many/export/particles"})
    for (const std::string& name : names_in(at(part)))
      if (name.starts_with(".mallow-")) fs::remove(folder_ / part / name);
  std::vector<std::string> parts = {"export/particles", "export/surface.pvd", "export/particles.pvd",
                                    "export/surface.usda", "export/surface.glb"};
  expect_same("many", "one", parts);
  EXPECT_EQ(names_in(at("many/export/surface")), names_in(at("one/export/surface")));
  for (const std::string& name : names_in(at("one/export/surface"))) {
    if (name.ends_with(".vdb")) continue;  // which holds an id of its own
    EXPECT_TRUE(read_text(at("one/export/surface/" + name)) == read_text(at("many/export/surface/" + name)))
        << name;
  }
}

TEST_F(cli_share,
       what_plays_an_export_of_some_frames_plays_these_and_says_which_are_missing_where_all_are_asked_for) {
  make_runs("6");
  const auto part = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"export", at("one"), "--surface", "usda", "--animation", "glb"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome outcome = run_mallow(all);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_EQ(part({"--frames", "2:5"}), "surface 3\nanimation 3\n");
  const std::string three = read_text(at("one/export/surface.glb"));
  EXPECT_NE(three.find("\"frame 2\""), std::string::npos);
  EXPECT_EQ(three.find("\"frame 3\""), std::string::npos);
  const std::string usda = read_text(at("one/export/surface.usda"));
  EXPECT_NE(usda.find("startTimeCode = 2"), std::string::npos) << usda.substr(0, 400);
  EXPECT_NE(usda.find("endTimeCode = 4"), std::string::npos) << usda.substr(0, 400);
  EXPECT_EQ(part({"--frames", "2:5", "--share"}),
            "still to do: frames 0, 1, 5, 6; the call that does the last of them adds surface.usda, "
            "surface.glb\n");
  EXPECT_EQ(part({"--share"}), "surface 7\nanimation 7\n");
  EXPECT_EQ(run_mallow({"surface", at("one"), "--frames", "1:7", "--set", "surface.voxels=20"}).out,
            "surfaces 6\nstill to do: frame 0; the call that does the last of them adds summary.html\n");
  fs::remove(at("one/surface/frame_000003.ply"));
  const Outcome none = run_mallow({"export", at("one"), "--animation", "glb", "--frames", "3:4"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("--frames: '3:4' names no frame that has a surface"), std::string::npos)
      << none.err;
}

TEST_F(cli_share, whole_commands_and_those_that_share_wait_for_each_other) {
  make_runs("3");
  Running running({"render", at("many"), "--share", "--set", "render.width=1920", "--set",
                   "render.height=1080", "--set", "render.samples=64"});
  ASSERT_TRUE(wait_for_files(folder_ / "many/.mallow-share/render", 1));
  const Outcome outcome = run_mallow({"render", at("many")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("is in use"), std::string::npos) << outcome.err;
  running.send(SIGKILL);
  running.wait();
  EXPECT_EQ(run_mallow({"render", at("many"), "--no-film"}).exit_code, 0);
  EXPECT_EQ(run_mallow({"render", at("many"), "--no-film", "--share"}).out, "pictures 0\n")
      << "the whole command notes what it took";
  EXPECT_EQ(run_mallow({"surface", at("many")}).exit_code, 0);
  EXPECT_FALSE(fs::exists(at("many/.mallow-share"))) << "it has all frames, and forgets who had which";
}

TEST_F(cli_share, frames_that_are_none_are_refused) {
  make_runs("3");
  for (const char* bad : {"3", "a:b", "0:4:0", "0:4:-1", "1:2:3:4", "1.5:2"}) {
    const Outcome outcome = run_mallow({"surface", at("many"), "--frames", bad});
    EXPECT_EQ(outcome.exit_code, 2) << bad;
    EXPECT_NE(outcome.err.find(std::string("--frames: '") + bad + "' is not allowed: A:B or A:B:S"),
              std::string::npos)
        << outcome.err;
  }
  const Outcome outcome = run_mallow({"export", at("many"), "--surface", "obj", "--frames", "4:9"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--frames: '4:9' names none of the frames 0 to 3"), std::string::npos)
      << outcome.err;
}

}  // namespace share_test
}  // namespace mallow::test
