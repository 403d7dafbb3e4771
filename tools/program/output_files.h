#pragma once

#include <filesystem>

namespace mallow::program {

/// Throws IoError where `file` cannot be written, now and not after hours of work. Leaves nothing behind.
void check_writable(const std::filesystem::path& file);

}  // namespace mallow::program
