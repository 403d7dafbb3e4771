#include "program/cache.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/run_report.h"
#include "program/shared_frames.h"
#include "program/shell_word.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view k_stem = "frame_";
constexpr std::size_t k_digits = 6;

[[noreturn]] void refuse(const fs::path& folder, const std::string& message) {
  throw IoError({folder.string(), 0, 0, "--out", message});
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

/// The folders of a cache that hold frames, and the endings of those.
struct FrameFolder {
  const char* name;
  std::vector<const char*> endings;
};
const std::array<FrameFolder, 5>& frame_folders() {
  static const std::array<FrameFolder, 5> k_folders{
      {{"particles", {"ply"}},
       {"surface", {"ply"}},
       {"images", {"png"}},
       {"export/surface", {"obj", "mtl", "glb", "vtp", "usda", "vdb"}},
       {"export/particles", {"vdb", "vtp", "csv"}}}};
  return k_folders;
}
/// A folder of the cache itself and empty; a link to a folder elsewhere is not ours to remove.
void remove_if_empty(const fs::path& folder) {
  std::error_code ignored;  // a folder with somebody's own files in it stays
  if (fs::is_directory(fs::symlink_status(folder, ignored))) fs::remove(folder, ignored);
}

/// Whether a folder without a mark holds a run of mallow before there were marks. A report alone does not
/// tell: --report puts one anywhere.
bool is_unmarked_run(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "scene.toml") ||
      !fs::is_regular_file(folder / "particles" / frame_name(0, "ply")))
    return false;
  try {
    const auto report = read_report(folder / "report.json");
    return report.contains("state_hash") && report.contains("stage_seconds");
  } catch (const IoError&) {
    return false;
  }
}

bool holds_nothing_but_mark(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != k_run_mark) return false;
  return true;
}

}  // namespace

int frame_number(const fs::path& file, const char* ending) {
  const std::string name = file.filename().string();
  if (!name.starts_with(k_stem) || file.extension() != std::string(".") + ending) return -1;
  const std::string digits = file.stem().string().substr(k_stem.size());
  int frame = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
  const bool whole = error == std::errc() && end == digits.data() + digits.size();
  return whole && digits.size() >= k_digits ? frame : -1;
}

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

std::vector<fs::path> Cache::files() const {
  std::vector<fs::path> files = half_written_files();
  for (const FrameFolder& frames : frame_folders())
    for (const char* ending : frames.endings)
      for (const int frame : frames_in(folder_ / frames.name, ending))
        files.push_back(folder_ / frames.name / frame_name(frame, ending));
  for (const char* file : k_single_files)
    if (std::string_view(file) != k_run_mark) files.push_back(folder_ / file);
  std::erase_if(files, [](const fs::path& file) {
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(file, unknown);
    return !fs::exists(status) || fs::is_directory(status);
  });
  return files;
}

/// ".frame_000012.ply.partial" and the like, as write_whole() calls them.
std::vector<fs::path> Cache::half_written_files() const {
  constexpr std::string_view k_ending = ".partial";
  std::vector<fs::path> files;
  const auto add = [&](const fs::path& folder, const auto& is_ours) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with('.') && name.ends_with(k_ending) && name.size() > 1 + k_ending.size() &&
          is_ours(name.substr(1, name.size() - 1 - k_ending.size())))
        files.push_back(entry.path());
    }
  };
  for (const FrameFolder& frames : frame_folders())
    add(folder_ / frames.name, [&](const fs::path& name) {
      return std::ranges::any_of(frames.endings,
                                 [&](const char* ending) { return frame_number(name, ending) >= 0; });
    });
  for (const char* folder : {"", "export"})
    add(folder_ / folder, [&](const fs::path& name) {
      return std::ranges::any_of(k_single_files,
                                 [&](const char* file) { return fs::path(folder) / name == file; });
    });
  return files;
}

void Cache::check(const fs::path& folder, bool overwrite) try {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) refuse(folder, "is a file, not a folder");
  if (holds_nothing_but_mark(folder)) return;
  if (mark_state(folder) != MarkState::run) {
    // A wrong folder after --out must not cost anybody a file that only happens to have one of our names.
    if (!overwrite) refuse(folder, "is not empty; give another folder");
    if (is_unmarked_run(folder))
      refuse(folder, std::string("holds a run of an earlier mallow (no ") + k_run_mark +
                         "), which --overwrite leaves alone; remove the folder, or give another one");
    refuse(folder, std::string("holds files but no run of mallow (no ") + k_run_mark +
                       "), so --overwrite leaves it alone; give another folder");
  }
  if (!overwrite)
    refuse(folder, "is not empty; give another folder, or --overwrite to replace the run in it");
  RunLock::for_reading(folder);
} catch (const fs::filesystem_error& error) {
  refuse(folder, "cannot be read: " + error.code().message());
}

Cache Cache::create(const fs::path& folder, bool overwrite) {
  check(folder, overwrite);
  Cache cache(folder);
  try {
    fs::create_directories(folder);
    cache.lock_ = RunLock::for_writing(folder);
    // Between the check and the lock somebody else may have run here, or be gone again.
    if (!overwrite && !holds_nothing_but_mark(folder)) refuse(folder, "is not empty any more");
    for (const fs::path& file : cache.files()) fs::remove(file);
    for (const fs::path& shared : {folder, folder / "export"}) forget_shared_frames(shared);
    for (const char* empty : {"export/surface", "export/particles", "export", "surface", "images"})
      remove_if_empty(folder / empty);
    fs::create_directories(folder / "particles");
  } catch (const fs::filesystem_error& error) {
    refuse(folder, "cannot be written: " + error.code().message());
  }
  return cache;
}

Cache Cache::open_to_resume(const fs::path& folder) {
  Cache cache(folder);
  const bool marked = mark_state(folder) == MarkState::run;
  if (!fs::is_regular_file(cache.scene_file()) || !(marked || is_unmarked_run(folder)))
    throw IoError({folder.string(), 0, 0, "--resume",
                   std::string("holds no run of mallow (no ") + (marked ? "scene.toml" : k_run_mark) +
                       "); start one with: mallow run SCENE --out " + shell_word(folder.string())});
  cache.lock_ = RunLock::for_writing(folder);
  for (const fs::path& file : cache.half_written_files()) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
  return cache;
}

Cache Cache::open(const fs::path& folder, Access access) {
  Cache cache(folder);
  for (const auto& file : {cache.scene_file(), cache.report_file()}) {
    if (!fs::is_regular_file(file)) {
      throw IoError(
          {folder.string(), 0, 0, "", "holds no run of mallow (no " + file.filename().string() + ")"});
    }
  }
  const bool marked = mark_state(folder) == MarkState::run;
  if (!marked && !is_unmarked_run(folder))
    throw IoError({folder.string(), 0, 0, "", std::string("holds no run of mallow (no ") + k_run_mark + ")"});
  if (access == Access::write) {
    cache.lock_ = RunLock::for_writing(folder);
    forget_shared_frames(folder);
  } else {
    if (!marked && access == Access::share) RunLock::for_writing(folder);  // makes the mark
    if (access == Access::look && marked)
      cache.lock_ = RunLock::for_looking(folder);
    else if (marked || access == Access::share)
      cache.lock_ = RunLock::for_reading(folder);
  }
  if (access != Access::look && cache.particle_frames().empty())
    throw IoError({folder.string(), 0, 0, "", "holds no particles of any frame"});
  return cache;
}

void Cache::check_names(const fs::path& folder, const Scene& scene) {
  Scene moved = Cache(folder).moved_here(scene);
  const auto check = [&](const fs::path& file) {
    try {
      nlohmann::json(file.string()).dump();
    } catch (const nlohmann::json::exception&) {
      refuse(folder, "cannot hold this run: the name '" + file.string() +
                         "' is not UTF-8, so that no scene.toml can hold it");
    }
  };
  for (const fs::path* file : named_files(moved)) check(*file);
}

void Cache::refuse_inputs(const fs::path& folder, const InputFiles& inputs, const std::string& option,
                          bool own_scene) {
  const Cache cache(folder);
  for (const fs::path& file : cache.files())
    if (own_scene || file != cache.scene_file()) inputs.refuse(file, option);
}

void Cache::remove_images_but(const std::vector<int>& frames) const {
  for (const int frame : image_frames())
    if (!std::ranges::binary_search(frames, frame)) fs::remove(image_file(frame));
}

Scene Cache::moved_here(Scene scene) const {
  // Links are followed, as `..` behind one leads elsewhere than the name before it says. The file itself may
  // be a link and keeps its name, whose ending tells what it is.
  std::error_code unknown;
  const fs::path home = fs::absolute(scene.file).parent_path();
  const fs::path here = fs::weakly_canonical(fs::absolute(folder_), unknown);
  const auto moved = [&](const fs::path& file) {
    if (file.is_absolute()) return file;
    const fs::path folder = fs::weakly_canonical((home / file).parent_path(), unknown);
    return (folder / file.filename()).lexically_proximate(here);
  };
  for (fs::path* file : named_files(scene)) *file = moved(*file);
  scene.file = scene_file();
  return scene;
}

std::string Cache::scene_text(const fs::path& folder, const Scene& scene) {
  return print_scene(Cache(folder).moved_here(scene));
}

void Cache::write_scene(const Scene& scene) const {
  const std::string text = scene_text(folder_, scene);
  try {
    if (print_scene(read_scene(scene_file(), {}, {.allow_outside_paths = true})) == text) return;
  } catch (const ConfigError&) {
    // There is none yet, or a broken one.
  }
  write_whole(scene_file(), text);
}

}  // namespace mallow::program
