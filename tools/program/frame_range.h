#pragma once

#include <string>
#include <vector>

namespace mallow::program {

/// Those of some frames, ascending, that "A:B" or "A:B:S" names as Python does: from A on, B not included,
/// every S-th; what is left out is the first, behind the last, and 1; negative numbers count from behind the
/// last frame. Empty text: all. Throws ConfigError for --frames where it is nothing like it or names none.
std::vector<int> choose_frames(const std::string& text, const std::vector<int>& frames);

}  // namespace mallow::program
