#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "program/background_writer.h"
#include "program/cache.h"
#include "render/renderer.h"

namespace mallow::view {

/// Pictures to a film: every frame of the scene once, however fast it is drawn. Pictures are written beside,
/// and joined at the end.
class FilmRecorder {
 public:
  FilmRecorder(std::filesystem::path film, int frames_per_second);
  void add(render::Image picture);
  int frames() const { return frames_; }
  /// Joins the pictures and says where the film is, or where the pictures are if ffmpeg is not installed.
  std::string finish();

 private:
  std::filesystem::path film_, folder_;
  int frames_per_second_;
  int frames_ = 0;
  std::optional<program::Cache> cache_;
  std::unique_ptr<program::BackgroundWriter> writer_;
};

/// The first name that is free: "view.mp4", "view_2.mp4", ...
std::filesystem::path free_name(const std::string& stem, const std::string& ending);

}  // namespace mallow::view
