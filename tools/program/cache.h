#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "program/input_files.h"
#include "program/run_mark.h"

namespace mallow::program {

/// "frame_000012.ply"
std::filesystem::path frame_name(int frame, const std::string& ending);
/// The number in "frame_000012.ply", or -1 where a file is not called so.
int frame_number(const std::filesystem::path& file, const char* ending);

/// A folder that holds a run, so that its parts can be made again apart from each other:
///   .mallow-run                 what marks the folder as a run's, and is locked by whoever writes into it
///   scene.toml  report.json  summary.html  film.mp4
///   checkpoint  checkpoint.previous  what a run goes on from
///   particles/frame_000000.ply  surface/frame_000000.ply  images/frame_000000.png
///   export/                     what `mallow export` made of these for other programs
///   .mallow-share/              what each picture is of; who works on which frame, where several programs
///                               share them
/// Frame 0 is the initial state. A folder of an earlier mallow has no mark: it is known by its report.json
/// and its frame 0, gets a mark from what writes into it, but is not overwritten.
class Cache {
 public:
  /// What there is one of.
  static constexpr std::array k_single_files = {k_run_mark,
                                                "scene.toml",
                                                "report.json",
                                                "checkpoint",
                                                "checkpoint.previous",
                                                "summary.html",
                                                "film.mp4",
                                                "export/surface.pvd",
                                                "export/skins.glb",
                                                "export/surface.glb",
                                                "export/surface.meshopt.glb",
                                                "export/surface.usda",
                                                "export/particles.pvd",
                                                "export/surface.manifest.usda",
                                                "export/surface/materials.mtl"};

  /// An empty cache in a folder that does not exist yet or is empty. With `overwrite` an earlier cache there
  /// is removed: the files named above and no others. Throws IoError where the folder holds something else,
  /// is in use or cannot be written.
  static Cache create(const std::filesystem::path& folder, bool overwrite);
  /// What create() would throw, found out without a change on disk.
  static void check(const std::filesystem::path& folder, bool overwrite);
  /// The cache of a run that goes on; removes what a killed writer left half written. Throws IoError where
  /// the folder holds no run or is in use.
  static Cache open_to_resume(const std::filesystem::path& folder);
  /// The cache of an earlier run, to write into it, to read it, or to write into it beside others that do the
  /// same (SharedFrames). Throws IoError where the folder holds none or is in use. look: as read, also while
  /// somebody writes, and before there is a frame: each file is whole, but they need not be of one moment.
  enum class Access { read, write, share, look };
  static Cache open(const std::filesystem::path& folder, Access access);

  /// Throws IoError where the scene.toml of a run in `folder` could not name the scene's files: TOML has no
  /// word for a name that is not UTF-8.
  static void check_names(const std::filesystem::path& folder, const Scene& scene);
  /// Throws IoError where a file of a run in `folder` is an input. own_scene: also its scene.toml.
  static void refuse_inputs(const std::filesystem::path& folder, const InputFiles& inputs,
                            const std::string& option, bool own_scene);

  const std::filesystem::path& folder() const { return folder_; }
  /// What to warn of where the disk has no locks, so that others can write here; else empty.
  const std::string& lock_warning() const { return lock_.warning(); }
  /// Who writes into a cache that is looked at; empty where nobody does.
  const std::string& writer() const { return lock_.writer(); }
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

  /// Pictures of other frames are of an earlier rendering.
  void remove_images_but(const std::vector<int>& frames) const;

  /// A scene with the paths in it made right for scene.toml: relative to it, once links are followed.
  Scene moved_here(Scene scene) const;
  /// scene.toml, unless it says the same already, with comments perhaps.
  void write_scene(const Scene& scene) const;
  /// What scene.toml of a run in `folder` says: its files are named as from there.
  static std::string scene_text(const std::filesystem::path& folder, const Scene& scene);

 private:
  explicit Cache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The files of a run that are there: those named above, without the mark, and what killed writers left
  /// half written of them.
  std::vector<std::filesystem::path> files() const;
  std::vector<std::filesystem::path> half_written_files() const;

  std::filesystem::path folder_;
  RunLock lock_;
};

}  // namespace mallow::program
