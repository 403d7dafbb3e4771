#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mallow/scene.h"

namespace mallow::cli {

/// "frame_000012.ply"
std::filesystem::path frame_name(int frame, const std::string& ending);

/// A folder that holds a run, so that its parts can be made again apart from each other:
///   scene.toml  report.json  summary.html  film.mp4
///   checkpoint  checkpoint.previous  what an unfinished run goes on from
///   particles/frame_000000.ply  surface/frame_000000.ply  images/frame_000000.png
///   export/                     what `mallow export` made of these for other programs
/// Frame 0 is the initial state.
class Cache {
 public:
  /// An empty cache in a folder that does not exist yet or is empty. With `overwrite` an earlier cache there
  /// is removed: the files named above and no others. Throws IoError where the folder holds something else or
  /// cannot be written.
  static Cache create(const std::filesystem::path& folder, bool overwrite);
  /// What create() would throw, found out without a change on disk.
  static void check(const std::filesystem::path& folder, bool overwrite);
  /// The cache of a run that goes on; removes what a killed writer left half written. Throws IoError where
  /// the folder holds no run.
  static Cache open_to_resume(const std::filesystem::path& folder);
  /// The cache of an earlier run. Throws IoError where the folder holds none.
  static Cache open(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path scene_file() const { return folder_ / "scene.toml"; }
  std::filesystem::path report_file() const { return folder_ / "report.json"; }
  std::filesystem::path summary_file() const { return folder_ / "summary.html"; }
  std::filesystem::path checkpoint_file() const { return folder_ / "checkpoint"; }
  std::filesystem::path film_file() const { return folder_ / "film.mp4"; }
  std::filesystem::path images_folder() const { return folder_ / "images"; }
  std::filesystem::path particles_file(int frame) const;
  std::filesystem::path surface_file(int frame) const;
  std::filesystem::path image_file(int frame) const;
  std::filesystem::path export_folder() const { return folder_ / "export"; }

  /// Frames there are, ascending.
  std::vector<int> particle_frames() const;
  std::vector<int> surface_frames() const;
  std::vector<int> image_frames() const;

  void remove_surfaces() const;
  /// The pictures and the film of them.
  void remove_images() const;

  /// Exports of every format, which an earlier run's frames would be among.
  void remove_exports() const;

  /// A scene with the paths in it made right for scene.toml.
  Scene moved_here(Scene scene) const;
  /// scene.toml
  void write_scene(const Scene& scene) const;

 private:
  explicit Cache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path folder_;
};

}  // namespace mallow::cli
