#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace mallow::program {

/// The file that marks a folder as a run's. It holds "mallow run, format 1" and, while somebody writes into
/// the folder, the process that does.
inline constexpr const char* k_run_mark = ".mallow-run";

/// What the mark of a folder says.
enum class MarkState {
  none,   ///< there is none, or a file of that name that is none of ours
  empty,  ///< it was being made when its writer was killed
  run,
};
/// Throws IoError where the mark is of a later format, or cannot be read.
MarkState mark_state(const std::filesystem::path& folder);

/// A lock on the folder of a run, on its mark. The system frees it when the program ends, however that comes,
/// so there is no stale one. On a disk without locks there is only a warning.
class RunLock {
 public:
  RunLock() = default;  ///< holds nothing
  /// Nobody else writes, and nobody reads. Makes the mark where there is none. Throws IoError where another
  /// program has the folder or the mark cannot be written.
  static RunLock for_writing(const std::filesystem::path& folder);
  /// Nobody writes. Throws IoError where somebody does.
  static RunLock for_reading(const std::filesystem::path& folder);
  /// The same where nobody writes; else it holds nothing, and writer() says who writes.
  static RunLock for_looking(const std::filesystem::path& folder);
  /// Nobody else exports into `folder`, which has no mark: the lock is on the folder itself. shared: but for
  /// others that say the same, and share the frames.
  static RunLock for_exports(const std::filesystem::path& folder, bool shared = false);

  ~RunLock();
  RunLock(RunLock&& other) noexcept;
  RunLock& operator=(RunLock&& other) noexcept;

  /// Why nothing is locked, on a disk without locks; else empty.
  const std::string& warning() const { return warning_; }
  /// "process 42 on HOST" or "another mallow", of for_looking(); else empty.
  const std::string& writer() const { return writer_; }

 private:
  RunLock(int descriptor, std::string warning, bool signed_by_us)
      : descriptor_(descriptor), warning_(std::move(warning)), signed_(signed_by_us) {}

  int descriptor_ = -1;
  std::string warning_;
  std::string writer_ = {};
  bool signed_ = false;  ///< the mark says that this process writes
};

}  // namespace mallow::program
