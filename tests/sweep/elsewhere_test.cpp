// Sweeps and frames by the schedulers that people have, for real; left out where they are not installed.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "cli/program.h"

namespace mallow::test {
namespace elsewhere_test {
namespace fs = std::filesystem;

/// Forty points.
class sweep_by : public CliTest {
 protected:
  sweep_by() { write_spec(20); }
  void write_spec(int frames) {
    spec_ = write("spec.toml", "scene = \"" + fs::path(scene_).filename().string() +
                                   "\"\nframes = " + std::to_string(frames) +
                                   "\nmethod = \"latin_hypercube\"\npoints = 40\n[[vary]]\nkey = "
                                   "\"material[0].alpha\"\nfrom = 0.0\nto = 1.0\n")
                .string();
  }
  /// The exit status of a line of shell; `mallow`, its spec and its folder are in $M, $S and $F.
  int shell(const std::string& line) const {
    ::setenv("M", MALLOW_PROGRAM, 1);
    ::setenv("S", spec_.c_str(), 1);
    ::setenv("F", folder_.c_str(), 1);
    const int status = std::system(("cd '" + folder_.string() + "'; " + line).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  /// The same beside a Slurm of its own.
  int with_slurm(const std::string& script) const {
    write("script", script);
    return shell("'" MALLOW_WITH_SLURM "' slurm bash script >log.txt 2>&1");
  }
  std::string serial() const {
    EXPECT_EQ(run_mallow({"sweep", spec_, "--out", at("serial"), "--jobs", "1"}).exit_code, 0);
    return read_text(at("serial/table.csv"));
  }
  std::string log() const { return read_text(at("log.txt")); }
  /// Rows of a table with a word in them.
  static std::ptrdiff_t rows_with(const std::string& table, const std::string& word) {
    std::istringstream lines(table);
    std::ptrdiff_t count = 0;
    for (std::string line; std::getline(lines, line);) count += line.find(word) != line.npos ? 1 : 0;
    return count;
  }
  bool has_parallel() const { return shell("command -v parallel >/dev/null") == 0; }
  std::string spec_;
};

constexpr const char* k_no_parallel = "GNU parallel is not installed (tools/setup --cluster)";

using sweep_by_parallel = sweep_by;
TEST_F(sweep_by_parallel, gives_the_table_of_a_serial_one_also_where_a_task_is_killed) {
  if (!has_parallel()) GTEST_SKIP() << k_no_parallel;
  // Runs of points that are seen are killed, until a point says that its run failed: a kill may come too
  // late.
  EXPECT_EQ(shell("(until { pkill -KILL -f \"[r]un .*$F/out/points\" && touch killed && sleep 0.2 && "
                  "grep -qs '\"failed\"' out/points/*/point.json; } || [ -e stop ]; do sleep 0.01; "
                  "done) & \"$M\" sweep \"$S\" --out \"$F/out\" --on parallel --jobs 2 --points-per-task 4 "
                  ">log.txt 2>&1; status=$?; "
                  "touch stop; wait; exit $status"),
            0);
  ASSERT_TRUE(fs::exists(at("killed")));
  const std::string first = read_text(at("out/table.csv"));
  EXPECT_GE(rows_with(first, ",failed,"), 1) << first;
  EXPECT_LE(rows_with(first, ",failed,"), 10) << first;
  EXPECT_EQ(rows_with(first, ",done,") + rows_with(first, ",failed,"), 40) << first;
  EXPECT_EQ(shell("\"$M\" sweep \"$S\" --out \"$F/out\" --on parallel --jobs 2 >log.txt 2>&1"), 0) << log();
  EXPECT_EQ(read_text(at("out/table.csv")), serial());
  EXPECT_TRUE(read_text(at("out/table.sqlite")) == read_text(at("serial/table.sqlite")));
}

TEST_F(sweep_by_parallel, names_hosts_that_it_cannot_reach) {
  if (!has_parallel()) GTEST_SKIP() << k_no_parallel;
  write("hosts", "nobody@host.invalid\n");
  EXPECT_EQ(shell("\"$M\" sweep \"$S\" --out out --on parallel --hosts hosts >log.txt 2>&1"), 1);
  EXPECT_NE(log().find("40 points were not run"), std::string::npos) << log();
  EXPECT_NE(log().find("GNU parallel said:\n  "), std::string::npos) << log();
  EXPECT_TRUE(log().find("host.invalid") != std::string::npos || log().find("ssh") != std::string::npos)
      << log();
}

TEST_F(sweep_by_parallel, ends_its_tasks_where_it_is_told_to_end) {
  if (!has_parallel()) GTEST_SKIP() << k_no_parallel;
  write_spec(20'000);
  Running running({"sweep", spec_, "--out", at("out"), "--on", "parallel", "--jobs", "2"});
  while (shell("ls out/points/*/series.csv >/dev/null 2>&1") != 0 && running.alive())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  running.send(SIGTERM);
  const Outcome outcome = running.wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM);
  EXPECT_NE(outcome.err.find("the same command goes on with what is left"), std::string::npos) << outcome.err;
  EXPECT_EQ(shell("pgrep -f \"[r]un .*$F/out/points\" >/dev/null"), 1) << "nothing runs on";
}

TEST_F(sweep_by_parallel, draws_takes_and_writes_frames_with_the_bits_of_one_process) {
  if (!has_parallel()) GTEST_SKIP() << k_no_parallel;
  ASSERT_EQ(run({"--out", at("one"), "--frames", "11"}).exit_code, 0);
  fs::copy(at("one"), at("many"), fs::copy_options::recursive);
  for (const std::string command : {"surface --set surface.voxels=24", "render --set render.samples=4",
                                    "export --surface obj --particles csv"}) {
    EXPECT_EQ(shell("\"$M\" " + command.substr(0, command.find(' ')) + " one" +
                    command.substr(command.find(' ')) + " >log.txt 2>&1"),
              0)
        << log();
    EXPECT_EQ(shell("\"$M\" " + command.substr(0, command.find(' ')) + " many" +
                    command.substr(command.find(' ')) + " --on parallel --jobs 3 >log.txt 2>&1"),
              0)
        << log();
  }
  for (const char* part : {"surface", "images", "export/surface", "export/particles"}) {
    EXPECT_EQ(names_in(at(std::string("many/") + part)), names_in(at(std::string("one/") + part)));
    EXPECT_EQ(shell(std::string("diff -r one/") + part + " many/" + part + " >log.txt 2>&1"), 0) << log();
  }
  if (fs::exists(at("one/film.mp4"))) {
    EXPECT_EQ(shell("cmp one/film.mp4 many/film.mp4"), 0);
  }
  EXPECT_EQ(run_mallow({"render", at("many"), "--on", "parallel", "--set", "render.samples=4"}).out,
            "pictures 0\n")
      << "all are there";
}

TEST_F(sweep_by_parallel, frames_of_tasks_that_are_killed_are_made_by_others_or_by_the_same_command) {
  if (!has_parallel()) GTEST_SKIP() << k_no_parallel;
  ASSERT_EQ(run({"--out", at("one"), "--frames", "11"}).exit_code, 0);
  fs::copy(at("one"), at("many"), fs::copy_options::recursive);
  const std::string options = " --set render.samples=16 --set render.width=160 --set render.height=90 ";
  ASSERT_EQ(shell("\"$M\" render one" + options + ">log.txt 2>&1"), 0) << log();
  // All tasks that are at it once two pictures are there. Others' tasks have another folder.
  EXPECT_EQ(shell("(until [ -e stop ]; do [ \"$(ls many/images 2>/dev/null | wc -l)\" -ge 2 ] && "
                  "pkill -KILL -f \"[r]ender $F/many .*--share\" && touch killed; sleep 0.01; done) & "
                  "\"$M\" render \"$F/many\" --on parallel --jobs 2" +
                  options + ">log.txt 2>&1; status=$?; touch stop; wait; exit $status"),
            1);
  ASSERT_TRUE(fs::exists(at("killed")));
  EXPECT_NE(log().find("frames were not made; the same command goes on with them"), std::string::npos)
      << log();
  EXPECT_EQ(shell("\"$M\" render many --on parallel --jobs 2" + options + ">log.txt 2>&1"), 0) << log();
  EXPECT_EQ(shell("diff -r one/images many/images >log.txt 2>&1"), 0) << log();
  if (fs::exists(at("one/film.mp4"))) {
    EXPECT_EQ(shell("cmp one/film.mp4 many/film.mp4"), 0);
  }
}

using sweep_by_slurm = sweep_by;
TEST_F(sweep_by_slurm, gives_the_table_of_a_serial_one_also_where_a_node_dies) {
  // One of the two nodes dies, with what runs, while the job is on its way; the same command sends the rest.
  // There are more points than the cluster takes tasks.
  const int status = with_slurm(R"sh(
(until ls out/points/*/point.json >/dev/null 2>&1; do sleep 0.05; done
 kill -KILL "$(cat "$SLURM_TEST_FOLDER/b.pid")" && touch node_killed
 until pkill -KILL -f "[r]un .*$F/out/points" && touch task_killed || [ -e stop ]; do sleep 0.01; done
 sleep 1; scontrol update nodename=b state=down reason=died) &
timeout 280 "$M" sweep "$S" --out out --on slurm
touch stop
cp out/table.csv first.csv
wait
timeout 280 "$M" sweep "$S" --out out --on slurm
)sh");
  if (status == 77) GTEST_SKIP() << log();
  EXPECT_EQ(status, 0) << log();
  EXPECT_TRUE(fs::exists(at("node_killed"))) << log();
  EXPECT_TRUE(fs::exists(at("task_killed"))) << log();
  EXPECT_LT(rows_with(read_text(at("first.csv")), ",done,"), 40) << "something was lost";
  EXPECT_EQ(read_text(at("out/table.csv")), serial());
}

TEST_F(sweep_by_slurm, cancels_its_job_where_it_is_told_to_end_and_minds_what_sbatch_and_slots_say) {
  write_spec(4000);
  const int status = with_slurm(R"sh(
"$M" sweep "$S" --out out --on slurm --jobs 1 2>said.txt & sweep=$!
until ls out/points/*/series.csv >/dev/null 2>&1; do sleep 0.05; done
kill -INT $sweep; wait $sweep; echo $? >status.txt
for _ in $(seq 1000); do squeue --noheader >queue.txt; [ -s queue.txt ] || break; sleep 0.1; done
sed -i 's/frames = 4000/frames = 2/; s/points = 40/points = 4/' "$S"
timeout 280 "$M" sweep "$S" --out two --on slurm --sbatch=--parsable --sbatch=--cpus-per-task=2
)sh");
  if (status == 77) GTEST_SKIP() << log();
  EXPECT_EQ(status, 0) << log();
  EXPECT_EQ(read_text(at("status.txt")), std::to_string(128 + SIGINT) + "\n");
  EXPECT_NE(read_text(at("said.txt")).find("is cancelled; the same command goes on"), std::string::npos)
      << read_text(at("said.txt"));
  EXPECT_EQ(read_text(at("queue.txt")), "") << "nothing runs on";
  EXPECT_EQ(read_json(at("two/points/00003/report.json")).at("threads"), 2) << "those of its slot";
}

TEST_F(sweep_by_slurm, draws_and_takes_frames_with_the_bits_of_one_process) {
  ASSERT_EQ(run({"--out", at("one"), "--frames", "11"}).exit_code, 0);
  fs::copy(at("one"), at("many"), fs::copy_options::recursive);
  for (const char* command : {"surface", "render"}) ASSERT_EQ(run_mallow({command, at("one")}).exit_code, 0);
  const int status = with_slurm(R"sh(set -e
timeout 280 "$M" surface many --on slurm --jobs 3
timeout 280 "$M" render many --on slurm)sh");
  if (status == 77) GTEST_SKIP() << log();
  EXPECT_EQ(status, 0) << log();
  EXPECT_NE(log().find("surfaces 12\npictures 12\n"), std::string::npos) << log();
  for (const char* part : {"surface", "images"})
    EXPECT_EQ(shell(std::string("diff -r one/") + part + " many/" + part + " >log.txt 2>&1"), 0) << log();
  if (fs::exists(at("one/film.mp4"))) {
    EXPECT_EQ(shell("cmp one/film.mp4 many/film.mp4"), 0);
  }
}

}  // namespace elsewhere_test
}  // namespace mallow::test
