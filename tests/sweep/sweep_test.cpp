#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cli/program.h"

namespace mallow::test {
namespace sweep_test {
namespace fs = std::filesystem;

/// Twelve points of a small cube; the last value of the stride is none.
class sweep_runs : public CliTest {
 protected:
  sweep_runs() { spec_ = write_spec("[1, 2, 0]", 8); }
  std::string write_spec(const std::string& strides, int frames) const {
    return write("spec.toml",
                 "scene = \"" + fs::path(scene_).filename().string() +
                     "\"\nframes = " + std::to_string(frames) +
                     "\nmeasures = [\"height\", \"height.max\", \"volume.mean\"]\n[[vary]]\nkey = "
                     "\"material[0].alpha\"\nfrom = 0.0\nto = 0.9\ncount = 4\n[[vary]]\nkey = "
                     "\"material[0].region_stride\"\nvalues = " +
                     strides + "\n")
        .string();
  }
  std::string sweep(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"sweep", spec_, "--out", at(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_text(at(out + "/table.csv"));
  }
  std::vector<std::string> lines(const std::string& table) const {
    std::vector<std::string> all;
    std::istringstream text(table);
    for (std::string line; std::getline(text, line);) all.push_back(line);
    return all;
  }
  std::string spec_;
};

TEST_F(sweep_runs, make_the_same_table_for_any_number_at_a_time) {
  const std::string one = sweep("one", {"--jobs", "1"});
  EXPECT_EQ(sweep("many", {"--jobs", "3"}), one);
  const auto rows = lines(one);
  ASSERT_EQ(rows.size(), 13u);
  EXPECT_EQ(rows[0],
            "point,material[0].alpha,material[0].region_stride,status,height,height.max,volume.mean,message");
  EXPECT_TRUE(rows[1].starts_with("0,0,1,done,")) << rows[1];
  EXPECT_TRUE(rows[3].starts_with("2,0,0,refused,,,,\"--set material[0].region_stride=0")) << rows[3];
}

TEST_F(sweep_runs, of_one_point_alone_give_its_row) {
  const auto rows = lines(sweep("all"));
  ASSERT_EQ(run_mallow({"sweep", spec_, "--out", at("alone"), "--point", "4"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(at("alone/table.csv")));
  const auto alone = lines(sweep("alone"));
  EXPECT_EQ(alone[5], rows[5]);
  // By hand, from the command that its point.json has.
  EXPECT_EQ(read_text(at("alone/points/00004/series.csv")), read_text(at("all/points/00004/series.csv")));
}

TEST_F(sweep_runs, that_are_done_are_not_run_again_and_what_changed_is) {
  sweep("out");
  const auto time = [&](int point) {
    return fs::last_write_time(at("out/points/0000" + std::to_string(point) + "/point.json"));
  };
  const auto before = time(0);
  sweep("out");
  EXPECT_EQ(time(0), before);
  std::string scene = read_text(scene_);
  std::ofstream(scene_) << scene << "\n# a word changes nothing\n";
  sweep("out");
  EXPECT_EQ(time(0), before);
  write_spec("[1, 2, 0]", 9);
  sweep("out");
  EXPECT_NE(time(0), before);
}

TEST_F(sweep_runs, of_a_shorter_spec_leave_out_points_of_before_and_name_them) {
  sweep("out");
  write_spec("[1]", 8);
  const Outcome outcome = run_mallow({"sweep", spec_, "--out", at("out")});
  EXPECT_NE(outcome.err.find("still has points 4 to 11 of an earlier"), std::string::npos) << outcome.err;
  EXPECT_EQ(lines(read_text(at("out/table.csv"))).size(), 5u);
  EXPECT_EQ(sweep("fresh"), read_text(at("out/table.csv")));
}

TEST_F(sweep_runs, take_one_picture_of_each_point_and_show_it_under_its_name) {
  write_spec("[1]", 2);
  write("images.toml", "images = true\n" + read_text(spec_));
  spec_ = at("images.toml");
  sweep("out");
  const std::string sheet = read_text(at("out/sheet.html"));
  for (const char* part : {"points/00002/run/images/frame_000002.png", "<b>2</b><br>material[0].alpha = 0.6"})
    EXPECT_NE(sheet.find(part), std::string::npos) << sheet;
  const fs::directory_iterator pictures(at("out/points/00002/run/images"));
  EXPECT_EQ(std::distance(begin(pictures), end(pictures)), 1);
}

TEST_F(sweep_runs, are_refused_where_the_scene_no_longer_takes_their_values) {
  sweep("out");
  std::string scene = read_text(scene_);
  scene.replace(scene.find("[[body]]"), 0, "update_intervall = 3\n");
  std::ofstream(scene_) << scene;
  const Outcome outcome = run_mallow({"sweep", spec_, "--out", at("out")});
  EXPECT_EQ(outcome.exit_code, 2) << "no point can be run: the scene itself is wrong";
  EXPECT_NE(outcome.err.find("update_intervall"), std::string::npos) << outcome.err;
}

TEST_F(sweep_runs, that_were_cut_off_end_with_the_table_of_those_that_were_not) {
  const std::string whole = sweep("whole");
  Running running({"sweep", spec_, "--out", at("cut"), "--jobs", "1"});
  while (!fs::exists(at("cut/points/00003/point.json")) && running.alive())
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  running.send(SIGTERM);
  EXPECT_EQ(running.wait().exit_code, 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(at("cut/table.csv")));
  EXPECT_EQ(sweep("cut"), whole);
}

TEST_F(sweep_runs, take_what_lies_between_whole_numbers_where_the_key_does) {
  write("spec.toml",
        "scene = \"" + fs::path(scene_).filename().string() +
            "\"\nframes = 1\nmethod = \"random\"\npoints = 20\n[[vary]]\nkey = [\"material[0].friction\", "
            "\"material[0].alpha\"]\nfrom = 0\nto = 1\n[[vary]]\nkey = \"material[0].region_stride\"\nfrom = "
            "1\nto = "
            "3\n");
  const Outcome outcome = run_mallow({"sweep", spec_, "--dry-run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("0 material[0].friction=0."), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("region_stride=1."), std::string::npos) << outcome.out;
  sweep("out");
  EXPECT_NE(read_text(at("out/points/00000/scene.toml")).find("alpha = 0."), std::string::npos);
  // The command of a point is good from any folder.
  EXPECT_NE(read_text(at("out/points/00000/point.json")).find("run " + scene_), std::string::npos);
}

TEST_F(sweep_runs, whose_scene_is_changed_meanwhile_are_not_called_done) {
  write_spec("[1]", 400);
  Running running({"sweep", spec_, "--out", at("out"), "--jobs", "1"});
  while (!fs::exists(at("out/points/00000/point.json")) && running.alive())
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::string scene = read_text(scene_);
  scene.replace(scene.find("[solver]"), 8, "[solver]\nsleep_time = 7");
  std::ofstream(scene_) << scene;
  const Outcome outcome = running.wait();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_NE(outcome.err.find("changed meanwhile"), std::string::npos) << outcome.err;
}

TEST_F(sweep_runs, that_cannot_write_are_rows_with_their_message) {
  fs::create_directories(at("out/points"));
  write("out/sweep.toml", "");
  write("out/points/00001", "a file where the folder should be");
  const Outcome outcome = run_mallow({"sweep", spec_, "--out", at("out")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = lines(read_text(at("out/table.csv")));
  EXPECT_NE(rows[2].find("failed"), std::string::npos) << rows[2];
  EXPECT_TRUE(rows[1].starts_with("0,0,1,done")) << rows[1];
}

TEST_F(sweep_runs, refuse_what_they_cannot_mean) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& part) {
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  fs::create_directories(at("mine"));
  write("mine/keep.txt", "mine");
  refused({"sweep", spec_, "--out", at("mine")}, "holds no sweep");
  refused({"sweep", spec_}, "--out");
  refused({"sweep", spec_, "--out", at("out"), "--point", "12"}, "points below 12");
  write("bad.toml", read_text(spec_).replace(read_text(spec_).find("\"height\""), 8, "\"hight\""));
  refused({"sweep", at("bad.toml"), "--out", at("bad")}, "bad.toml:3:13: measures: 'hight' is no column");
  write("plot.toml", read_text(spec_) + "[[plot]]\nx = \"point\"\ny = \"hight\"\n");
  refused({"sweep", at("plot.toml"), "--out", at("plot")}, ":14:5: plot[0].y: 'hight' is no column");
  EXPECT_FALSE(fs::exists(at("plot"))) << "before anything is run";
  write("key.toml", read_text(spec_).replace(read_text(spec_).find("].alpha"), 7, "].alhpa"));
  refused({"sweep", at("key.toml"), "--out", at("key")}, "did you mean 'alpha'?");
}

}  // namespace sweep_test
}  // namespace mallow::test
