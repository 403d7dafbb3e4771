#pragma once

#include <span>
#include <string>
#include <vector>

namespace mallow::program {

/// Those of some frames, ascending, that "A:B" or "A:B:S" names as Python does: from A on, B not included,
/// every S-th; what is left out is the first, behind the last, and 1; negative numbers count from behind the
/// last frame. Empty text: all. Throws ConfigError for --frames where it is nothing like it or names none.
std::vector<int> choose_frames(const std::string& text, const std::vector<int>& frames);

/// Some frames, ascending, by their numbers: "frame 3", "frames 0 to 59, 61".
std::string frames_text(std::span<const int> frames);

}  // namespace mallow::program
