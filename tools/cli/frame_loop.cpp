#include "cli/frame_loop.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>
#include <thread>

#include "program/failure.h"
#include "program/interrupt.h"
#include "program/progress.h"

namespace mallow::cli {
namespace {

void end_if_interrupted(std::size_t done) {
  if (const int signal = program::interrupted())
    throw program::Interrupted("interrupted after " + std::to_string(done) + " frames", signal);
}

}  // namespace

void add_frame_options(CLI::App& command, FrameOptions& options) {
  command
      .add_option(
          "--frames", options.range,
          "Only frames A to B, B not included, every S-th of them, as in Python: negative numbers "
          "count from the end. Many processes may work on one folder; no two write one frame. Who does "
          "the last frame makes the film, or what plays an export")
      ->option_text("A:B[:S]");
  command.add_flag("--share", options.share,
                   "Take the frames that no other process with --share has taken or done, also those of one "
                   "that was killed, and end when all are there. The files have the same bits as by one "
                   "process");
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
