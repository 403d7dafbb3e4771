#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/frame_loop.h"
#include "program/cached_run.h"
#include "program/shared_frames.h"

namespace mallow::cli {

struct ExportOptions : program::CachedRunOptions {
  std::vector<std::string> surface;    ///< formats
  std::vector<std::string> particles;  ///< formats
  std::vector<std::string> animation;  ///< formats
  std::vector<std::string> skins;      ///< formats
  std::string up = "z";
  std::string out;
  FrameOptions frames;
};

/// All that an export writes, below a folder: surface/frame_000000.glb and the like, and what plays them.
class Export {
 public:
  /// options, run: outlive this. Throws IoError where `out` cannot be written.
  Export(const ExportOptions& options, const program::CachedRun& run, const std::filesystem::path& out);
  ~Export();
  Export(const Export&) = delete;
  Export& operator=(const Export&) = delete;

  /// The files of a frame.
  void write_frame(int number);
  /// Takes in a frame for what plays all of them; ascending.
  void add_frame(int number);
  /// Writes what plays the frames that were added, and prints how many those are.
  void finish();
  /// What write_frame() reads and writes.
  program::SharedFrames::Files files(int number) const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace mallow::cli
