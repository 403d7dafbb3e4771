#pragma once

#include <filesystem>
#include <string_view>

namespace mallow {

/// As write_whole(); what `file` was becomes `previous`, in the same folder, once the new content is on the
/// disk. Whenever this ends, killed or not, one of the two is whole if `file` was.
void write_whole_keeping(const std::filesystem::path& file, std::string_view content,
                         const std::filesystem::path& previous);

}  // namespace mallow
