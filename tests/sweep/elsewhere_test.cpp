// Sweeps by the schedulers that people have, for real; left out where they are not installed.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "cli/program.h"

namespace mallow::test {
namespace elsewhere_test {
namespace fs = std::filesystem;

/// Forty points.
class sweep_by : public CliTest {
 protected:
  sweep_by() {
    spec_ =
        write("spec.toml", "scene = \"" + fs::path(scene_).filename().string() +
                               "\"\nframes = 20\nmethod = \"latin_hypercube\"\npoints = 40\n[[vary]]\nkey = "
                               "\"material[0].alpha\"\nfrom = 0.0\nto = 1.0\n")
            .string();
  }
  /// The exit status of a line of shell; `mallow` and its spec are in $M and $S.
  int shell(const std::string& line) const {
    ::setenv("M", MALLOW_PROGRAM, 1);
    ::setenv("S", spec_.c_str(), 1);
    const int status = std::system(("cd '" + folder_.string() + "'; " + line).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  std::string serial() const {
    EXPECT_EQ(run_mallow({"sweep", spec_, "--out", at("serial"), "--jobs", "1"}).exit_code, 0);
    return read_text(at("serial/table.csv"));
  }
  std::string spec_;
};

using sweep_by_parallel = sweep_by;
TEST_F(sweep_by_parallel, gives_the_table_of_a_serial_one_also_where_a_task_is_killed) {
  if (shell("command -v parallel >/dev/null") != 0)
    GTEST_SKIP() << "GNU parallel is not installed (tools/setup --cluster)";
  // The first run of a point that is seen is killed.
  EXPECT_EQ(
      shell("(until pkill -KILL -f \"[r]un .*$PWD/out/points\" || [ -e stop ]; do sleep 0.01; done) & "
            "\"$M\" sweep \"$S\" --out \"$PWD/out\" --on parallel --jobs 2 >log.txt 2>&1; touch stop; wait"),
      0);
  EXPECT_EQ(shell("\"$M\" sweep \"$S\" --out \"$PWD/out\" --on parallel --jobs 2 >log.txt 2>&1"), 0)
      << read_text(at("log.txt"));
  EXPECT_EQ(read_text(at("out/table.csv")), serial());
}

using sweep_by_slurm = sweep_by;
TEST_F(sweep_by_slurm, gives_the_table_of_a_serial_one_also_where_a_node_dies) {
  // One of the two nodes dies, with what it runs, while the job is on its way; the same command sends the
  // rest.
  const int status = shell("'" MALLOW_WITH_SLURM
                           "' slurm sh -c '"
                           "(until ls out/points/*/point.json >/dev/null 2>&1; do sleep 0.05; done; kill "
                           "-KILL $(pgrep -f \"[s]lurmd -D -N b\"); "
                           "pkill -KILL -f \"[r]un .*$PWD/out/points\"; sleep 1; scontrol update nodename=b "
                           "state=down reason=died) & "
                           "timeout 60 \"$M\" sweep \"$S\" --out out --on slurm --points-per-task 2; wait; "
                           "timeout 60 \"$M\" sweep \"$S\" --out out --on slurm' >log.txt 2>&1");
  if (status == 77) GTEST_SKIP() << read_text(at("log.txt"));
  EXPECT_EQ(status, 0) << read_text(at("log.txt"));
  EXPECT_EQ(read_text(at("out/table.csv")), serial());
}

}  // namespace elsewhere_test
}  // namespace mallow::test
