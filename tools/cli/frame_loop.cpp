#include "cli/frame_loop.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "mallow/errors.h"
#include "program/failure.h"
#include "program/frame_range.h"
#include "program/interrupt.h"
#include "program/machine.h"
#include "program/progress.h"

namespace mallow::cli {
namespace {

void end_if_interrupted(std::size_t done) {
  if (const int signal = program::interrupted())
    throw program::Interrupted("interrupted after " + std::to_string(done) + " frames", signal);
}

/// As many tasks as may be of use: those that come late find nothing left to do, and end.
std::size_t task_count(const ElsewhereOptions& options, std::size_t frames, const sweep::Elsewhere& where) {
  constexpr std::size_t k_most_unless_told = 64;
  std::size_t count = std::min(frames, k_most_unless_told);
  if (options.jobs > 0)
    count = std::min(frames, static_cast<std::size_t>(options.jobs));
  else if (options.on == "parallel" && options.hosts.empty())
    count = std::min(frames, static_cast<std::size_t>(program::resolve_threads(0)));
  return options.on == "slurm" ? std::min(count, sweep::most_slurm_tasks(where)) : count;
}

}  // namespace

void add_frame_options(CLI::App& command, FrameOptions& options) {
  command
      .add_option(
          "--frames", options.range,
          "Only frames A to B, B not included, every S-th of them, as in Python: negative numbers "
          "count from the end. Many processes may work on one folder; no two write one frame. Who does "
          "the last frame makes the film; what plays an export plays these frames alone, or with --share "
          "all, and "
          "is made by who does the last one")
      ->option_text("A:B[:S]");
  options.command = &command;
  add_elsewhere_options(command, options.elsewhere, "the frames", {"local", "parallel", "slurm"});
  command.add_flag("--share", options.share,
                   "Take the frames that no other process with --share has taken or done, also those of one "
                   "that was killed, and end when all are there. The files have the same bits as by one "
                   "process");
}

std::size_t do_frames_elsewhere(const FrameOptions& options, const std::vector<int>& frames,
                                const program::SharedFrames& shared, const std::filesystem::path& folder,
                                int threads) {
  const std::size_t before = shared.count_left(frames);
  if (before == 0) return 0;
  program::watch_for_interrupt();
  std::vector<std::string> command = words_of(*options.command, {"--share", "--threads"});
  command.push_back("--threads=" + std::to_string(threads_of_task(options.elsewhere, threads)));
  const sweep::Elsewhere where =
      elsewhere(options.elsewhere, folder / program::k_share_folder, "mallow-" + options.command->get_name());
  const std::vector<std::string> words(task_count(options.elsewhere, before, where), "--share");
  const std::string said = run_elsewhere(options.elsewhere, {std::move(command), words}, where);
  const std::size_t left = shared.count_left(frames);
  if (left > 0)
    throw program::RunFailure(
        std::to_string(left) +
        " frames were not made; the same command goes on with them; what the tasks said "
        "is in " +
        where.folder.string() + (said.empty() ? "" : ":\n  " + said));
  return before;
}

void check(const FrameOptions& options) {
  check(options.elsewhere);
  if (options.elsewhere.jobs > 0 && !options.elsewhere.by_scheduler())
    throw ConfigError("--jobs", "is not allowed without --on parallel or slurm");
}

void print_left(const program::SharedFrames& shared, const std::vector<int>& frames,
                const std::string& then) {
  const std::vector<int> left = shared.left(frames);
  if (!left.empty())
    std::printf("still to do: %s%s\n", program::frames_text(left).c_str(),
                then.empty() ? "" : ("; the call that does the last of them adds " + then).c_str());
}

std::size_t for_each_frame(const std::vector<int>& frames, const char* verb,
                           const std::function<void(int frame)>& work) {
  return for_each_frame(frames, nullptr, false, verb, [&](int frame, const FrameClaim&) { work(frame); });
}

std::size_t for_each_frame(const std::vector<int>& frames, const program::SharedFrames* shared, bool share,
                           const char* verb,
                           const std::function<void(int frame, const FrameClaim& claim)>& work) {
  program::watch_for_interrupt();
  program::Progress progress(verb, static_cast<long long>(frames.size()), "frames");
  std::size_t count = 0;
  std::vector<int> left = frames, busy;
  while (!left.empty()) {
    busy.clear();
    for (const int frame : left) {
      end_if_interrupted(count);
      const FrameClaim claim = shared ? shared->try_claim(frame) : nullptr;
      if (shared && !claim) {
        busy.push_back(frame);
        continue;
      }
      if (!shared || !share || !shared->is_done(frame)) {
        work(frame, claim);
        ++count;
      }
      progress.show(static_cast<long long>(count));
    }
    // What others have now may be left undone by them.
    if (busy.size() == left.size()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    left.swap(busy);
  }
  return count;
}

}  // namespace mallow::cli
