#include "view/film_recorder.h"

#include <utility>

#include "program/film.h"

namespace mallow::view {
namespace fs = std::filesystem;
namespace {

/// What the name of a film is followed by in that of the folder of its pictures.
constexpr const char* k_pictures = ".frames";

}  // namespace

fs::path free_name(const std::string& stem, const std::string& ending) {
  for (int k = 1;; ++k) {
    const fs::path name = stem + (k == 1 ? "" : "_" + std::to_string(k)) + ending;
    if (!fs::exists(name) && !fs::exists(name.string() + k_pictures)) return name;
  }
}

FilmRecorder::FilmRecorder(fs::path film, int frames_per_second, int width, int height)
    : film_(std::move(film)),
      folder_(film_.string() + k_pictures),
      frames_per_second_(frames_per_second),
      width_(width),
      height_(height),
      cache_(program::Cache::create(folder_, true)),
      writer_(std::make_unique<program::BackgroundWriter>()) {
  fs::create_directories(cache_->images_folder());
}

void FilmRecorder::add(render::Image picture, int scene_frame) {
  if (frames_ == 0) first_ = scene_frame;
  last_ = scene_frame;
  const fs::path file = cache_->image_file(frames_++);
  writer_->add([file, picture = std::move(picture)] { render::write_png(file, picture); });
}

std::future<std::string> FilmRecorder::finish(std::unique_ptr<FilmRecorder> recorder) {
  return std::async(std::launch::async, [held = std::move(recorder)] { return held->join(); });
}

std::string FilmRecorder::join() {
  writer_->finish();
  writer_.reset();
  if (frames_ == 0) {
    cache_.reset();
    fs::remove_all(folder_);
    return "no film: no frame of the scene ended meanwhile";
  }
  if (!program::can_make_films())
    return "ffmpeg is not installed; the pictures are in " + (folder_ / "images").string();
  program::make_film(*cache_, film_, frames_per_second_);
  cache_.reset();
  fs::remove_all(folder_);
  return "film of " + std::to_string(frames_) + " frames: " + film_.string();
}

}  // namespace mallow::view
