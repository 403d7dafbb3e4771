#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "cli/program.h"
#include "mallow/files.h"
#include "mallow/simulation.h"

namespace mallow::test {
namespace kill_test {

namespace fs = std::filesystem;
using cli_kill = CliTest;
using Clock = std::chrono::steady_clock;

/// What became of the kills: printed, and asked to be what it must.
struct Tally {
  int kills = 0, while_writing = 0, from_newest = 0, from_previous = 0, before_the_first = 0;
  int runs_ended = 0, damaged_files = 0;
};

int kills_wanted() {
  const char* given = std::getenv("MALLOW_KILLS");
  return given ? std::atoi(given) : 20;
}

/// Kills the run at a random moment of its life, every other time while a checkpoint is being written. False
/// where it came to its end before.
bool kill_at_random(Running& running, const fs::path& folder, double longest, std::mt19937& random,
                    Tally& tally) {
  std::uniform_real_distribution<double> moment(0, longest);
  std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
  const bool aim = random() % 2 == 0;
  bool writing = false;
  for (int k = 0; aim && !writing && k < 100000 && running.alive(); ++k)
    writing = fs::exists(folder / ".checkpoint.partial");
  if (writing) std::this_thread::sleep_for(std::chrono::duration<double>(moment(random) / 1000));
  running.send(SIGKILL);
  if (running.wait().exit_code != -1) return false;
  ++tally.kills;
  if (writing) ++tally.while_writing;
  return true;
}

/// Whatever stands under the names of checkpoints has to be whole at any moment.
void look_for_damage(const fs::path& folder, Tally& tally) {
  for (const fs::path& file : {folder / "checkpoint", previous_checkpoint(folder / "checkpoint")}) {
    if (!fs::exists(file)) continue;
    try {
      Simulation::restore(read_checkpoint(file), 1);
    } catch (const Error& error) {
      ++tally.damaged_files;
      ADD_FAILURE() << error.what();
    }
  }
}

TEST_F(cli_kill, at_random_moments_leaves_a_run_that_goes_on_to_the_same_bytes) {
  const std::vector<std::string> what = {scene_,        "--frames",    "60", "--set", "run.frame_time=0.15",
                                         "--no-images", "--no-surface"};
  const auto begin = [&](const std::string& folder) {
    std::vector<std::string> arguments = {"run", "--out",     folder, "--checkpoint-every",
                                          "1",   "--threads", "1"};
    arguments.insert(arguments.end(), what.begin(), what.end());
    return arguments;
  };
  // The least of several: kills that come long after the end of a run are none.
  double longest = 1e9;
  for (const char* folder : {"whole", "again", "once_more"}) {
    const Clock::time_point started = Clock::now();
    ASSERT_EQ(run_mallow(begin(at(folder))).exit_code, 0);
    longest = std::min(longest, std::chrono::duration<double>(Clock::now() - started).count());
  }
  const nlohmann::json expected = read_json(at("whole/report.json"));

  const std::string out = at("out");
  std::mt19937 random(20240607);
  Tally tally;
  std::vector<std::string> next = begin(out);
  while (tally.kills < kills_wanted()) {
    Running running(next);
    const bool killed = kill_at_random(running, out, longest, random, tally);
    const std::string said = running.wait().err;
    if (said.find("checkpoint.previous: step") != std::string::npos)
      ++tally.from_previous;
    else if (said.find("resuming from") != std::string::npos)
      ++tally.from_newest;
    look_for_damage(out, tally);
    next = {"run", "--resume", out, "--threads", std::to_string(1 + random() % 3)};
    const bool any = fs::exists(out + "/checkpoint") || fs::exists(out + "/checkpoint.previous");
    if (killed && any) continue;

    if (killed) {
      ++tally.before_the_first;
      EXPECT_EQ(run_mallow(next).exit_code, 2);
    } else {
      ++tally.runs_ended;
      const nlohmann::json report = read_json(out + "/report.json");
      for (const char* key : {"complete", "frames", "steps", "simulated_time", "time_step", "state_hash"})
        ASSERT_EQ(report.at(key), expected.at(key)) << key;
      const auto names = names_in(at("whole/particles"));
      ASSERT_EQ(names_in(out + "/particles"), names);
      for (const std::string& name : names)
        ASSERT_EQ(read_text(out + "/particles/" + name), read_text(at("whole/particles/") + name)) << name;
    }
    fs::remove_all(out);
    next = begin(out);
  }
  EXPECT_EQ(tally.damaged_files, 0);
  std::printf(
      "kills %d\nwhile a checkpoint was written %d\nresumed from the newest %d\nresumed from the previous "
      "%d\n"
      "before the first checkpoint %d\nruns that came to their end, to the same bytes %d\ndamaged files %d\n",
      tally.kills, tally.while_writing, tally.from_newest, tally.from_previous, tally.before_the_first,
      tally.runs_ended, tally.damaged_files);
}

}  // namespace kill_test
}  // namespace mallow::test
