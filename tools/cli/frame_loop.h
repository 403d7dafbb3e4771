#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace mallow::cli {

/// Calls `work` for every frame, with progress on stderr. Throws RunFailure at Ctrl-C. Returns how many
/// frames that were.
std::size_t for_each_frame(const std::vector<int>& frames, const char* verb,
                           const std::function<void(int frame)>& work);

}  // namespace mallow::cli
