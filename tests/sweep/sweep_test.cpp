#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
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
  // Several tries: where this process has to wait meanwhile, the other comes to its end.
  int exit_code = 0;
  for (int attempt = 0; attempt < 20 && exit_code == 0; ++attempt) {
    fs::remove_all(at("cut"));
    Running running({"sweep", spec_, "--out", at("cut"), "--jobs", "1"});
    while (!fs::exists(at("cut/points/00003/point.json")) && running.alive())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    running.send(SIGTERM);
    exit_code = running.wait().exit_code;
  }
  ASSERT_EQ(exit_code, 128 + SIGTERM);
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
  write_spec("[1]", 2000);
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
  refused({"sweep", at("bad.toml"), "--dry-run"}, "bad.toml:3:13: measures: 'hight' is no column");
  write("plot.toml", read_text(spec_) + "[[plot]]\nx = \"point\"\ny = \"hight\"\n");
  refused({"sweep", at("plot.toml"), "--out", at("plot")}, ":14:5: plot[0].y: 'hight' is no column");
  EXPECT_FALSE(fs::exists(at("plot"))) << "before anything is run";
  write("key.toml", read_text(spec_).replace(read_text(spec_).find("].alpha"), 7, "].alhpa"));
  refused({"sweep", at("key.toml"), "--out", at("key")}, "did you mean 'alpha'?");
}

TEST_F(sweep_runs, of_a_command_in_point_json_give_its_row) {
  sweep("all");
  const nlohmann::json point = read_json(at("all/points/00004/point.json"));
  EXPECT_EQ(point.at("seed"), 1);
  const std::string before = read_text(at("all/points/00004/series.csv"));
  fs::remove(at("all/points/00004/series.csv"));
  ASSERT_EQ(std::system((point.at("command").get<std::string>() + " >/dev/null 2>&1").c_str()), 0);
  EXPECT_EQ(read_text(at("all/points/00004/series.csv")), before);
}

TEST_F(sweep_runs, take_the_processors_of_the_slot_that_slurm_gives) {
  write_spec("[1]", 1);
  ::setenv("SLURM_CPUS_PER_TASK", "1", 1);
  sweep("out", {"--jobs", "1"});
  ::unsetenv("SLURM_CPUS_PER_TASK");
  EXPECT_EQ(read_json(at("out/points/00000/report.json")).at("threads"), 1);
}

TEST_F(sweep_runs, have_a_folder_to_themselves_until_they_end_however_that_comes) {
  write_spec("[1]", 40000);
  Running running({"sweep", spec_, "--out", at("out"), "--jobs", "1"});
  while (!fs::exists(at("out/points/00000/series.csv")) && running.alive())
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Outcome other = run_mallow({"sweep", spec_, "--out", at("out")});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("is in use by another mallow sweep"), std::string::npos) << other.err;
  running.send(SIGKILL);
  EXPECT_EQ(running.wait().exit_code, -1) << "it was still at work";
  // A run that the dead one left over has the folder of its point, and writes into it, until it ends.
  const auto is_left_over = [&] {
    return std::system(("pgrep -f '[r]un .*" + at("out/points") + "' >/dev/null").c_str()) == 0;
  };
  EXPECT_TRUE(is_left_over()) << "it was to outlive its sweep, or this shows nothing";
  write_spec("[1]", 8);
  const std::string table = sweep("out");
  EXPECT_FALSE(is_left_over()) << "the sweep waited for it";
  EXPECT_EQ(table, sweep("fresh"));
}

TEST_F(sweep_runs, of_one_point_by_two_processes_are_run_once) {
  write_spec("[1]", 8000);
  const std::vector<std::string> point{"sweep", spec_, "--out", at("out"), "--point", "2"};
  Running one(point), other(point);
  const Outcome first = one.wait(), second = other.wait();
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(first.err.find("point 2 done"), std::string::npos) << first.err;
  // Who waited says how long the other one took.
  EXPECT_EQ(first.err, second.err);
}

TEST_F(sweep_runs, whose_groups_differ_in_case_are_columns_of_both_tables) {
  std::string scene = read_text(scene_);
  const std::size_t body = scene.find("[[body]]"), next = scene.find("[[collider]]");
  std::string second = scene.substr(body, next - body);
  second.replace(second.find("\"cube\""), 6, "\"CUBE\"").replace(second.find("0.6"), 3, "9.6");
  std::ofstream(scene_) << scene.insert(next, second);
  write("case.toml",
        read_text(spec_).replace(read_text(spec_).find("\"height\""), 8, "\"cube.height\", \"CUBE.height\""));
  spec_ = at("case.toml");
  EXPECT_EQ(lines(sweep("out"))[0],
            "point,material[0].alpha,material[0].region_stride,status,cube.height,CUBE.height,height.max,"
            "volume.mean,message");
  EXPECT_TRUE(fs::exists(at("out/table.sqlite")));
}

TEST_F(sweep_runs, read_points_of_a_table_that_a_spreadsheet_wrote) {
  write("points.csv", "\xEF\xBB\xBFmaterial[0].alpha,material[0].region_stride\r\n0.5,1\r\n0.25,2\r\n");
  write("spec.toml", "scene = \"" + fs::path(scene_).filename().string() +
                         "\"\nframes = 2\nmeasures = [\"height\"]\npoints_file = \"points.csv\"\n");
  EXPECT_EQ(lines(sweep("out"))[0],
            "point,material[0].alpha,material[0].region_stride,status,height,message");
}

/// A small disk of its own, where root may mount one.
class sweep_runs_on_a_full_disk : public sweep_runs {
 protected:
  sweep_runs_on_a_full_disk() {
    fs::create_directories(at("disk"));
    mounted_ = std::system(("mount -t tmpfs -o size=2m none '" + at("disk") + "' 2>/dev/null").c_str()) == 0;
  }
  ~sweep_runs_on_a_full_disk() override {
    if (mounted_) [[maybe_unused]]
      const int code = std::system(("umount '" + at("disk") + "'").c_str());
  }
  bool mounted_ = false;
};

TEST_F(sweep_runs_on_a_full_disk, leave_the_table_of_those_that_had_room) {
  if (!mounted_) GTEST_SKIP() << "no disk can be mounted here: that takes root's rights";
  write_spec("[1]", 8);
  const std::string whole = sweep("disk/whole");
  const auto used = fs::space(at("disk")).capacity - fs::space(at("disk")).free;
  fs::remove_all(at("disk/whole"));
  // Room for the table, which is 68 kB or less, and for half of what the points take.
  std::ofstream(at("disk/ballast")) << std::string(fs::space(at("disk")).free - 72 * 1024 - used / 2, 'x');
  const Outcome outcome = run_mallow({"sweep", spec_, "--out", at("disk/out"), "--jobs", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = lines(read_text(at("disk/out/table.csv")));
  ASSERT_EQ(rows.size(), 5u) << outcome.err;
  EXPECT_EQ(rows[1], lines(whole)[1]);
  EXPECT_NE(rows[4].find("failed"), std::string::npos) << rows[4];
  EXPECT_NE(rows[4].find("No space left"), std::string::npos) << rows[4];
  EXPECT_TRUE(fs::exists(at("disk/out/table.sqlite")));
  fs::remove(at("disk/ballast"));
  EXPECT_EQ(sweep("disk/out"), whole);
}

TEST_F(sweep_runs, refuse_names_that_cannot_be_before_anything_is_run) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& part,
                           const std::vector<std::string>& more = {}) {
    std::string text = read_text(spec_);
    text.replace(text.find(from), from.size(), to);
    write("bad.toml", text);
    std::vector<std::string> arguments{"sweep", at("bad.toml"), "--out", at("bad")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << part;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(at("bad/points"))) << part;
  };
  refused("\"height.max\"", "\"height\"", "bad.toml:3:23: measures: 'height' is a column already");
  refused("\"height.max\"", "\"hight\"", "'hight' is no column of a series", {"--on", "parallel"});
  refused("\"material[0].region_stride\"", "\"run.frames\"",
          "frames: is not allowed where run.frames is varied");
  refused("[[vary]]", "[[plot]]\nx = \"point\"\ny = \"status\"\n[[vary]]", "plot[0].y: 'status' has texts");
  refused("frames = 8", "frames = 8", "'0,2,1:4' names point 2 twice", {"--point", "0,2,1:4"});
  refused("frames = 8", "frames = 8", "--sbatch: is not allowed without --on slurm", {"--sbatch=--hold"});
}

}  // namespace sweep_test
}  // namespace mallow::test
