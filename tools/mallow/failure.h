#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

namespace mallow::cli {

/// What the program ends with.
inline constexpr int k_exit_done = 0;
inline constexpr int k_exit_run_failed = 1;  ///< a step that cannot be taken, a full disk
inline constexpr int k_exit_bad_input = 2;   ///< command line, scene, input files, output folder

/// Something that went wrong while a run was under way: exit code 1.
class RunFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Says what is not wrong, but worth to be known, on stderr: "warning: ..." for each.
void print_warnings(std::span<const std::string> notes);

/// Throws IoError where `file` cannot be written, now and not after hours of work. Leaves nothing behind.
void check_writable(const std::filesystem::path& file);

}  // namespace mallow::cli
