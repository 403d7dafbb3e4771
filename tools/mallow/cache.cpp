#include "mallow/cache.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>

#include "mallow/errors.h"
#include "mallow/failure.h"
#include "mallow/files.h"

namespace mallow::cli {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view k_stem = "frame_";
constexpr std::size_t k_digits = 6;

[[noreturn]] void refuse(const fs::path& folder, const std::string& message) {
  throw IoError({folder.string(), 0, 0, "--out", message});
}

/// The number in "frame_000012.ply", or -1 where a file is not ours.
int frame_number(const fs::path& file, const char* ending) {
  const std::string name = file.filename().string();
  if (!name.starts_with(k_stem) || file.extension() != std::string(".") + ending) return -1;
  const std::string digits = file.stem().string().substr(k_stem.size());
  int frame = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
  const bool whole = error == std::errc() && end == digits.data() + digits.size();
  return whole && digits.size() >= k_digits ? frame : -1;
}

std::vector<int> frames_in(const fs::path& folder, const char* ending) {
  std::vector<int> frames;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (const int frame = frame_number(entry.path(), ending); frame >= 0) frames.push_back(frame);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

void remove_frames(const fs::path& folder, const char* ending) {
  for (const int frame : frames_in(folder, ending)) fs::remove(folder / frame_name(frame, ending));
  std::error_code ignored;  // a folder with somebody's own files in it stays
  fs::remove(folder, ignored);
}

}  // namespace

fs::path frame_name(int frame, const std::string& ending) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%06d.", frame);
  return name + ending;
}

fs::path Cache::particles_file(int frame) const {
  return folder_ / "particles" / frame_name(frame, "ply");
}
fs::path Cache::surface_file(int frame) const {
  return folder_ / "surface" / frame_name(frame, "ply");
}
fs::path Cache::image_file(int frame) const {
  return images_folder() / frame_name(frame, "png");
}

std::vector<int> Cache::particle_frames() const {
  return frames_in(folder_ / "particles", "ply");
}
std::vector<int> Cache::surface_frames() const {
  return frames_in(folder_ / "surface", "ply");
}
std::vector<int> Cache::image_frames() const {
  return frames_in(images_folder(), "png");
}

void Cache::remove_surfaces() const {
  remove_frames(folder_ / "surface", "ply");
}

void Cache::remove_images() const {
  remove_frames(images_folder(), "png");
  fs::remove(film_file());
}

void Cache::remove_exports() const {
  for (const char* what : {"surface", "particles"}) {
    for (const char* ending : {"obj", "glb", "vtp", "usda", "vdb", "csv"})
      remove_frames(export_folder() / what, ending);
    for (const char* ending : {".pvd", ".usda"}) fs::remove(export_folder() / what += ending);
  }
  std::error_code ignored;  // a folder with somebody's own files in it stays
  fs::remove(export_folder(), ignored);
}

void Cache::check(const fs::path& folder, bool overwrite) try {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) refuse(folder, "is a file, not a folder");
  if (fs::is_empty(folder)) return;
  if (!overwrite)
    refuse(folder, "is not empty; give another folder, or --overwrite to replace the run in it");
  // A wrong folder after --out must not cost anybody a file that only happens to have one of our names.
  if (!fs::exists(folder / "scene.toml")) {
    refuse(folder, "holds files but no run of mallow (no scene.toml), so --overwrite leaves it alone");
  }
} catch (const fs::filesystem_error& error) {
  refuse(folder, "cannot be read: " + error.code().message());
}

Cache Cache::create(const fs::path& folder, bool overwrite) {
  check(folder, overwrite);
  Cache cache(folder);
  try {
    fs::create_directories(folder);
    check_writable(cache.scene_file());
    remove_frames(folder / "particles", "ply");
    cache.remove_surfaces();
    cache.remove_images();
    cache.remove_exports();
    // scene.toml is what marks a run, so it goes last: an interrupted removal can be done again.
    for (const auto& file : {cache.checkpoint_file(), previous_checkpoint(cache.checkpoint_file()),
                             cache.report_file(), cache.summary_file(), cache.scene_file()})
      fs::remove(file);
    fs::create_directories(folder / "particles");
  } catch (const fs::filesystem_error& error) {
    refuse(folder, "cannot be written: " + error.code().message());
  }
  return cache;
}

Cache Cache::open_to_resume(const fs::path& folder) {
  Cache cache(folder);
  if (!fs::is_regular_file(cache.scene_file()))
    throw IoError({folder.string(), 0, 0, "--resume",
                   "holds no run of mallow (no scene.toml); start one with: mallow run SCENE --out " +
                       folder.string()});
  for (const fs::path& place : {folder, folder / "particles", folder / "surface", cache.images_folder()}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(place, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with('.') && name.ends_with(".partial")) fs::remove(entry.path(), error);
    }
  }
  return cache;
}

Cache Cache::open(const fs::path& folder) {
  Cache cache(folder);
  for (const auto& file : {cache.scene_file(), cache.report_file()}) {
    if (!fs::is_regular_file(file)) {
      throw IoError(
          {folder.string(), 0, 0, "", "holds no run of mallow (no " + file.filename().string() + ")"});
    }
  }
  if (cache.particle_frames().empty())
    throw IoError({folder.string(), 0, 0, "", "holds no particles of any frame"});
  return cache;
}

Scene Cache::moved_here(Scene scene) const {
  const fs::path home = fs::absolute(scene.file).parent_path();
  const fs::path here = fs::absolute(folder_);
  const auto moved = [&](const fs::path& file) {
    return file.is_absolute() ? file
                              : (home / file).lexically_normal().lexically_proximate(here.lexically_normal());
  };
  for (SceneBody& body : scene.bodies) {
    if (auto* mesh = std::get_if<MeshSource>(&body.source)) mesh->file = moved(mesh->file);
    if (auto* points = std::get_if<PointsSource>(&body.source)) points->file = moved(points->file);
  }
  scene.file = scene_file();
  return scene;
}

void Cache::write_scene(const Scene& scene) const {
  write_whole(scene_file(), print_scene(moved_here(scene)));
}

}  // namespace mallow::cli
