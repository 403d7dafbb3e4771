#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/elsewhere_options.h"
#include "program/shared_frames.h"

namespace CLI {
class App;
}

namespace mallow::cli {

/// Which frames a command works on, and whether others work beside it.
struct FrameOptions {
  std::string range;   ///< "A:B" or "A:B:S"; empty: all
  bool share = false;  ///< take those that nobody has
  ElsewhereOptions elsewhere;
  const CLI::App* command = nullptr;  ///< whose they are
  /// Others may work on the same folder.
  bool shared() const { return share || !range.empty() || elsewhere.by_scheduler(); }
};
/// --frames, --share and --on.
void add_frame_options(CLI::App& command, FrameOptions& options);
/// Throws ConfigError where an option is given that --on does not have.
void check(const FrameOptions& options);
/// Says which of `frames` are not there yet, as others do them or nobody was asked to. then: what the call
/// that does the last of them adds.
void print_left(const program::SharedFrames& shared, const std::vector<int>& frames, const std::string& then);

/// Held while a frame is worked on, its done() called once its files are there; null where nobody else can
/// work on the folder.
using FrameClaim = std::shared_ptr<const program::SharedFrames::Claim>;

/// Calls `work` for every frame, with progress on stderr. Throws RunFailure at Ctrl-C. Returns how many
/// frames that were. shared: null where nobody else works on them; else no frame is worked on while another
/// process does, and with `share` none that is done already: this returns when all are, or are being written
/// by this process.
std::size_t for_each_frame(const std::vector<int>& frames, const program::SharedFrames* shared, bool share,
                           const char* verb,
                           const std::function<void(int frame, const FrameClaim& claim)>& work);
/// The same by a scheduler, whose tasks are this command with --share: so a task that is killed loses no more
/// than the frame it was at, and the last one joins. folder: which is shared. threads: of each task, 0: those
/// of its slot. Throws RunFailure where some are left.
std::size_t do_frames_elsewhere(const FrameOptions& options, const std::vector<int>& frames,
                                const program::SharedFrames& shared, const std::filesystem::path& folder,
                                int threads);
/// The same where nobody else works on them.
std::size_t for_each_frame(const std::vector<int>& frames, const char* verb,
                           const std::function<void(int frame)>& work);

}  // namespace mallow::cli
