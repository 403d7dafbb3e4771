#pragma once

#include <filesystem>
#include <future>
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
  /// width, height: of its pictures, in pixels.
  FilmRecorder(std::filesystem::path film, int frames_per_second, int width, int height);
  /// Whether add() would wait for pictures to be written.
  bool is_busy() const { return !writer_->has_room(); }
  /// scene_frame: which frame of the scene it shows.
  void add(render::Image picture, int scene_frame);
  int width() const { return width_; }
  int height() const { return height_; }
  int frames() const { return frames_; }
  int first() const { return first_; }  ///< frame of the scene that the first picture shows
  int last() const { return last_; }    ///< the same of the last one
  /// Joins the pictures on a thread of its own, which holds the recorder until then. It says where the film
  /// is, or where the pictures are if ffmpeg is not installed, or throws what went wrong.
  static std::future<std::string> finish(std::unique_ptr<FilmRecorder> recorder);

 private:
  std::string join();

  std::filesystem::path film_, folder_;
  int frames_per_second_, width_, height_;
  int frames_ = 0, first_ = 0, last_ = 0;
  std::optional<program::Cache> cache_;
  std::unique_ptr<program::BackgroundWriter> writer_;
};

/// The first name that is free: "view.mp4", "view_2.mp4", ... One whose pictures are still being joined is
/// not.
std::filesystem::path free_name(const std::string& stem, const std::string& ending);

}  // namespace mallow::view
