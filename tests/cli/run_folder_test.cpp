#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <functional>
#include <thread>

#include "cli/program.h"
#include "mallow/files.h"

namespace mallow::test {
namespace run_folder_test {

namespace fs = std::filesystem;
using cli_run_folder = CliTest;

const std::vector<std::string> k_quick = {"--no-surface", "--frames", "1"};

void expect_refused(const Outcome& outcome, const std::string& word) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find(word), std::string::npos) << "'" << word << "' is not in: " << outcome.err;
}

/// What another mallow holds, for as long as it lives.
class Held {
 public:
  Held(const std::string& file, int kind) : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    EXPECT_EQ(::flock(descriptor_, kind | LOCK_NB), 0) << file;
  }
  ~Held() { ::close(descriptor_); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  int descriptor_;
};

TEST_F(cli_run_folder, is_marked_and_the_mark_names_nobody_afterwards) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  EXPECT_EQ(read_text(at("out/.mallow-run")), "mallow run, format 1\n");
}

TEST_F(cli_run_folder, of_an_earlier_mallow_is_read_and_gets_a_mark_but_is_not_overwritten) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  fs::remove(at("out/.mallow-run"));
  const std::vector<std::string> names = names_in(at("out"));
  expect_refused(run({"--out", at("out"), "--overwrite"}), "a run of an earlier mallow");
  ASSERT_EQ(run_mallow({"export", at("out"), "--particles", "csv", "--out", at("csv")}).exit_code, 0);
  EXPECT_EQ(names_in(at("out")), names);
  ASSERT_EQ(run_mallow({"surface", at("out")}).exit_code, 0);
  EXPECT_TRUE(fs::exists(at("out/.mallow-run")));
  EXPECT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface"}).exit_code, 0);
}

TEST_F(cli_run_folder, with_a_mark_that_is_none_is_left_alone) {
  const auto try_mark = [&](const std::string& mark) {
    fs::create_directory(at("out"));
    write("out/.mallow-run", mark);
    write("out/summary.html", "mine");
  };
  try_mark("");
  expect_refused(run({"--out", at("out"), "--overwrite"}), "no .mallow-run");
  try_mark("mine");
  expect_refused(run({"--out", at("out"), "--overwrite"}), "no .mallow-run");
  EXPECT_EQ(read_text(at("out/.mallow-run")), "mine");
  try_mark("mallow run, format 12\n");
  expect_refused(run({"--out", at("out"), "--overwrite"}), "later version of mallow");
  EXPECT_EQ(read_text(at("out/summary.html")), "mine");

  // A run that was killed before it had written the mark leaves a folder that counts as empty.
  fs::remove(at("out/summary.html"));
  write("out/.mallow-run", "");
  EXPECT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
}

TEST_F(cli_run_folder, loses_only_what_a_run_wrote) {
  ASSERT_EQ(run({"--out", at("out"), "--checkpoint-every", "1"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "obj,vtp", "--particles", "csv"}).exit_code, 0);
  fs::create_directory(at("elsewhere"));
  fs::rename(at("out/surface"), at("elsewhere/surface"));
  fs::create_directory_symlink(at("elsewhere/surface"), at("out/surface"));
  const std::vector<std::string> mine = {
      "out/notes.txt",         "out/particles/frame_12.ply",     "out/particles/frame_000001.csv",
      "out/.notes.partial",    "out/particles/.my.ply.partial",  "out/export/surface/frame_000000.png",
      "out/export/readme.txt", "out/images/frame_000000000.jpg", "out/checkpoint.old"};
  fs::create_directory(at("out/images"));
  fs::create_directory(at("out/film.mp4"));
  for (const std::string& file : mine) write(file, "mine");
  for (const char* file : {"out/.checkpoint.partial", "out/particles/.frame_000007.ply.partial"})
    write(file, "half");
  ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface", "--frames", "0"}).exit_code, 0);
  for (const std::string& file : mine) EXPECT_EQ(read_text(at(file)), "mine") << file;
  EXPECT_TRUE(fs::is_symlink(at("out/surface")));
  EXPECT_EQ(names_in(at("elsewhere/surface")), std::vector<std::string>{});
  EXPECT_EQ(names_in(at("out/particles")), (std::vector<std::string>{".my.ply.partial", "frame_000000.ply",
                                                                     "frame_000001.csv", "frame_12.ply"}));
  EXPECT_EQ(names_in(at("out/export")), (std::vector<std::string>{"readme.txt", "surface"}));
}

TEST_F(cli_run_folder, is_that_of_one_run_until_it_ends_or_is_killed) {
  const auto started = std::chrono::steady_clock::now();
  Running first({"run", scene_, "--out", at("out"), "--threads", "1", "--no-surface", "--no-images",
                 "--frames", "1000000", "--checkpoint-every", "1"});
  while (!fs::exists(at("out/checkpoint"))) {
    ASSERT_TRUE(first.alive());
    ASSERT_LT(std::chrono::steady_clock::now() - started, std::chrono::minutes(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::string in_use = at("out") + ": is in use by process " + std::to_string(first.process()) + " on ";
  expect_refused(run({"--out", at("out"), "--overwrite"}), in_use);
  expect_refused(run_mallow({"run", "--resume", at("out")}), in_use);
  expect_refused(run_mallow({"surface", at("out")}), in_use);
  expect_refused(run_mallow({"render", at("out"), "--no-film"}), in_use);
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv", "--out", at("csv")}), in_use);
  while (fs::exists(at("out/checkpoint.previous")) == false) ASSERT_TRUE(first.alive());
  Outcome info = run_mallow({"info", at("out")});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  for (const std::string& part :
       {"not yet: process " + std::to_string(first.process()) + " on ", std::string(" of 1000000, step ")})
    EXPECT_NE(info.out.find(part), std::string::npos) << info.out;
  EXPECT_EQ(info.out.find("frames           0 of"), std::string::npos) << "it has come farther: " << info.out;
  EXPECT_EQ(info.out.find("to go on"), std::string::npos) << info.out;
  ASSERT_TRUE(first.alive());
  first.send(SIGKILL);
  first.wait();
  info = run_mallow({"info", at("out")});
  for (const std::string& part : {std::string("ended            not complete: the run was killed"),
                                  std::string("checkpoint       at frame "),
                                  "to go on         mallow run --resume " + at("out") + "\n"})
    EXPECT_NE(info.out.find(part), std::string::npos) << info.out;
  EXPECT_EQ(info.out.find("frames           0 of"), std::string::npos) << info.out;
  const Outcome outcome = run_mallow({"run", "--resume", at("out"), "--steps", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(cli_run_folder, is_that_of_one_run_of_two_that_begin_at_once) {
  const std::vector<std::string> command = {"run",       scene_, "--out",    at("out"), "--no-images",
                                            "--threads", "1",    "--frames", "20",      "--no-surface"};
  Running first(command), second(command);
  const Outcome one = first.wait(), other = second.wait();
  EXPECT_EQ(std::min(one.exit_code, other.exit_code), 0) << one.err << other.err;
  EXPECT_EQ(std::max(one.exit_code, other.exit_code), 2) << one.err << other.err;
  EXPECT_EQ(names_in(at("out/particles")).size(), 21u);
}

TEST_F(cli_run_folder, can_be_exported_from_by_several_and_into_by_one) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const std::vector<std::string> command = {"export", at("out"), "--particles", "csv"};
  {
    const Held other_export(at("out/.mallow-run"), LOCK_SH);
    EXPECT_EQ(run_mallow(command).exit_code, 0);
    expect_refused(run_mallow({"surface", at("out")}), "out: is in use; wait");
  }
  const Held other_export(at("out/export"), LOCK_EX);
  expect_refused(run_mallow(command), "out/export: is in use; wait");
}

TEST_F(cli_run_folder, that_lacks_the_last_surface_gets_no_picture_of_that_frame) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  fs::remove(at("out/surface/frame_000002.ply"));
  fs::create_directory(at("out/images"));
  write("out/images/frame_000002.png", "of an earlier rendering");
  const Outcome outcome = run_mallow({"render", at("out"), "--no-film"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "pictures 2\n");
  EXPECT_EQ(names_in(at("out/images")).size(), 2u);
}

TEST_F(cli_run_folder, is_told_of_by_info) {
  ASSERT_EQ(run({"--out", at("out"), "--set", "solver.time_step=0.1", "--checkpoint-every", "1"}).exit_code,
            0);
  const Outcome outcome = run_mallow({"info", at("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& line :
       {"run              " + at("out"), "scene            " + scene_ + " --set solver.time_step=0.1",
        std::string("particles        125 in 1 body"), std::string("frames           2 of 2, 0.45 s each"),
        std::string("ended            complete"),
        "to go on         mallow run --resume " + at("out") + " --frames N",
        std::string("files            3 of particles, 3 surfaces, 0 pictures")})
    EXPECT_NE(outcome.out.find(line + "\n"), std::string::npos) << line << " is not in\n" << outcome.out;
  EXPECT_EQ(run_mallow({"info", at("out"), "--print"}).out, read_text(at("out/scene.toml")));
  expect_refused(run_mallow({"info", at("out"), "--set", "solver.time_step=0.2"}),
                 "--set and --quality go with");
  fs::create_directory(at("empty"));
  expect_refused(run_mallow({"info", at("empty")}), "empty: holds no run of mallow");
}

TEST_F(cli_run_folder, of_a_run_that_was_ended_says_so) {
  Running running({"run", scene_, "--out", at("out"), "--frames", "1000000", "--no-surface", "--no-images"});
  while (!fs::exists(at("out/particles/frame_000003.ply"))) ASSERT_TRUE(running.alive());
  running.send(SIGTERM);
  const Outcome ended = running.wait();
  EXPECT_EQ(ended.exit_code, 128 + SIGTERM);
  EXPECT_NE(ended.err.find(" frames are whole, and a checkpoint is there"), std::string::npos) << ended.err;
  const std::string told = run_mallow({"info", at("out")}).out;
  EXPECT_NE(told.find("ended            not complete: interrupted after "), std::string::npos) << told;
}

/// A run that waits for its scene, with its handlers in place.
bool waits_with_handlers(Running& running) {
  const std::string status = "/proc/" + std::to_string(running.process()) + "/status";
  for (int k = 0; k < 100'000 && running.alive(); ++k) {
    const std::string text = read_text(status);
    const std::size_t at = text.find("SigCgt:");
    if (at != text.npos && (std::stoull(text.substr(at + 8), nullptr, 16) >> (SIGTERM - 1) & 1) != 0)
      return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST_F(cli_run_folder, is_not_touched_by_a_run_that_is_ended_before_it_began) {
  ASSERT_EQ(run({"--out", at("old"), "--no-surface", "--checkpoint-every", "1"}).exit_code, 0);
  const std::string report = read_text(at("old/report.json"));
  ASSERT_EQ(::mkfifo(at("pipe.toml").c_str(), 0600), 0);
  for (const int signal : {SIGINT, SIGTERM})
    for (const std::string& out : {at("new"), at("old")}) {
      Running running({"run", at("pipe.toml"), "--out", out, "--overwrite"});
      ASSERT_TRUE(waits_with_handlers(running));
      running.send(signal);
      const Outcome outcome = running.wait();
      EXPECT_EQ(outcome.exit_code, 128 + signal);
      EXPECT_EQ(outcome.err, "mallow: interrupted before the run began; nothing was written\n");
    }
  EXPECT_FALSE(fs::exists(at("new")));
  EXPECT_EQ(read_text(at("old/report.json")), report);
  EXPECT_EQ(run_mallow({"run", "--resume", at("old"), "--frames", "3"}).exit_code, 0);
}

/// Calls `work` in a thread whose programs find a disk without locks.
void without_locks(const std::function<void()>& work) {
  std::thread([&] {
    std::array<sock_filter, 4> filter = {
        sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_flock, 0, 1),
        sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOLCK),
        sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
    const sock_fprog program = {static_cast<unsigned short>(filter.size()), filter.data()};
    ASSERT_EQ(::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0), 0);
    ASSERT_EQ(::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program), 0);
    work();
  }).join();
}

TEST_F(cli_run_folder, on_a_disk_without_locks_gets_its_pictures) {
  without_locks([&] {
    const Outcome ran = run({"--out", at("out"), "--no-film"}, true);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(names_in(at("out/images")).size(), 3u);
    const Outcome rendered = run_mallow({"render", at("out"), "--no-film"});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
    EXPECT_EQ(run_mallow({"render", at("out"), "--no-film", "--share"}).exit_code, 2)
        << "who shares needs them";
  });
}

}  // namespace run_folder_test
}  // namespace mallow::test
