#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "program/external_program.h"

namespace mallow::test {
namespace film_test {

namespace fs = std::filesystem;
using cli_film = CliTest;

const std::vector<std::string> k_run_without_film = {".mallow-run", ".mallow-share", "checkpoint",
                                                     "images",      "particles",     "report.json",
                                                     "scene.toml",  "summary.html",  "surface"};

/// A PATH on which there is no ffmpeg, for as long as it lives.
class NoPrograms {
 public:
  explicit NoPrograms(const std::string& empty_folder) : path_(std::getenv("PATH")) {
    fs::create_directory(empty_folder);
    ::setenv("PATH", empty_folder.c_str(), 1);
  }
  ~NoPrograms() { ::setenv("PATH", path_.c_str(), 1); }
  NoPrograms(const NoPrograms&) = delete;
  NoPrograms& operator=(const NoPrograms&) = delete;

 private:
  std::string path_;
};

/// An MP4 begins with the size of its first box, and "ftyp".
bool is_mp4(const fs::path& file) {
  return read_text(file).substr(4, 4) == "ftyp";
}

TEST_F(cli_film, goes_to_the_file_that_is_named_and_not_into_the_folder) {
  if (!program::is_installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  Outcome outcome = run({"--out", at("out"), "--film", at("a: b.mp4")}, true);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(is_mp4(at("a: b.mp4")));
  EXPECT_EQ(names_in(at("out")), k_run_without_film);
  EXPECT_EQ(names_in(folder_), (std::vector<std::string>{"a: b.mp4", "cube.toml", "out"}));

  const std::string first = read_text(at("a: b.mp4"));
  for (int time = 0; time < 2; ++time)  // a film of mallow's may be replaced by another
    outcome = run_mallow({"render", at("out"), "--film", at("again.mp4"), "--threads", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_text(at("again.mp4")), first);
  EXPECT_EQ(names_in(at("out")), k_run_without_film);

  outcome = run_mallow({"render", at("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(is_mp4(at("out/film.mp4")));
}

TEST_F(cli_film, without_ffmpeg_all_else_is_made_and_a_film_asked_for_by_name_fails_the_command) {
  const NoPrograms none(at("bin"));
  for (const std::string verb : {"run", "render"}) {
    const Outcome outcome = verb == "run" ? run({"--out", at("out"), "--film", at("a.mp4")}, true)
                                          : run_mallow({"render", at("out"), "--film", at("a.mp4")});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    const std::size_t warned = outcome.err.find("a.mp4 will not be made");
    EXPECT_LT(warned, outcome.err.find(verb == "run" ? "simulating" : "rendering")) << outcome.err;
    EXPECT_NE(outcome.err.find("a.mp4 was not made"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("ffmpeg is not installed"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.out, "");
    EXPECT_EQ(names_in(at("out")), k_run_without_film);
    EXPECT_EQ(names_in(at("out/images")).size(), 3u);
    EXPECT_EQ(read_json(at("out/report.json")).at("complete"), true);
    EXPECT_FALSE(fs::exists(at("a.mp4")));
  }
}

TEST_F(cli_film, without_ffmpeg_the_film_of_the_folder_is_left_out_with_a_word) {
  const NoPrograms none(at("bin"));
  const Outcome outcome = run({"--out", at("out")}, true);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("no film, because the program ffmpeg is not installed"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(names_in(at("out")), k_run_without_film);
}

TEST_F(cli_film, is_refused_before_a_run_goes_on_where_a_picture_is_missing) {
  if (!program::is_installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  // Where the scene does not say from where, all pictures are taken at the end.
  const std::vector<std::string> seen = {"--out",     at("out"), "--checkpoint-every",   "1",
                                         "--no-film", "--set",   "render.eye=[9, -9, 9]"};
  ASSERT_EQ(run(seen, true).exit_code, 0);
  fs::remove(at("out/images/frame_000001.png"));
  Outcome outcome = run_mallow({"run", "--resume", at("out"), "--frames", "3"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("the picture of frame 1 is missing; 'mallow render"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("simulating"), std::string::npos) << outcome.err;
  outcome = run_mallow({"run", "--resume", at("out"), "--frames", "3", "--no-film"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(run_mallow({"render", at("out")}).exit_code, 0);
  EXPECT_TRUE(is_mp4(at("out/film.mp4")));
}

TEST_F(cli_film, wrong_use_is_refused_before_anything_runs) {
  const auto expect_refused = [&](const Outcome& outcome, const std::string& word) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(at("out")));
  };
  expect_refused(run({"--out", at("out"), "--film", at("a.mp4"), "--no-film"}, true), "--film");
  expect_refused(run({"--out", at("out"), "--film", at("a.mp4"), "--no-images"}, true), "--no-images");
  expect_refused(run({"--film", at("a.mp4")}, true), "--out");
  expect_refused(run({"--out", at("out"), "--film", at("a.gif")}, true), ".mp4");
  expect_refused(run({"--out", at("out"), "--film", at("no/such/a.mp4")}, true), "No such file or directory");
  fs::create_directory(at("folder.mp4"));
  expect_refused(run({"--out", at("out"), "--film", at("folder.mp4")}, true), "is a folder");
  expect_refused(run_mallow({"render", at("out"), "--film", at("a.mp4"), "--no-film"}), "--film");
  expect_refused(run_mallow({"render", at("out"), "--film", at("no/such/a.mp4")}), "No such file");
}

}  // namespace film_test
}  // namespace mallow::test
