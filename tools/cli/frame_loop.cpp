#include "cli/frame_loop.h"

#include <string>

#include "program/failure.h"
#include "program/interrupt.h"
#include "program/progress.h"

namespace mallow::cli {

std::size_t for_each_frame(const std::vector<int>& frames, const char* verb,
                           const std::function<void(int frame)>& work) {
  program::watch_for_interrupt();
  program::Progress progress(verb, static_cast<long long>(frames.size()), "frames");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (const int signal = program::interrupted())
      throw program::Interrupted("interrupted after " + std::to_string(i) + " frames", signal);
    work(frames[i]);
    progress.show(static_cast<long long>(i) + 1);
  }
  return frames.size();
}

}  // namespace mallow::cli
