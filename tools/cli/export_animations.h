#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/files.h"
#include "program/cached_run.h"

/// What `mallow export` makes of all frames together.
namespace mallow::cli {

/// The file of an animation of surfaces in a format: "glb" or "meshopt".
std::string animation_name(const std::string& format);

/// The surfaces of all frames, which become one file in each of the formats that plays as the film does.
class SurfaceAnimation {
 public:
  /// formats: outlive this. Throws ConfigError where this build lacks one.
  SurfaceAnimation(const std::vector<std::string>& formats, std::span<const MeshBody> bodies,
                   double frames_per_second);
  bool any() const { return !files_.empty(); }
  /// mesh: as the cache has it.
  void add(const Mesh& mesh, int number);
  /// Into the folder `out`; once.
  void write(const std::filesystem::path& out);

 private:
  const std::vector<std::string>& formats_;
  double frames_per_second_;
  std::optional<int> first_;  ///< frame, with which it begins to play
  std::vector<GlbSeries> files_;
};

/// The skins of all frames, which become one animation that plays as the film does.
class SkinAnimation {
 public:
  /// run: outlives this. Throws IoError where no body has a skin.
  explicit SkinAnimation(const program::CachedRun& run);
  /// mesh: as the cache has it.
  void add(const Mesh& mesh, int number);
  void write(const std::filesystem::path& file, std::span<const MeshBody> bodies) const;

 private:
  const program::CachedRun& run_;
  std::vector<bool> skinned_;
  Mesh first_;
  int first_frame_ = 0;
  std::vector<MeshPose> poses_;
};

}  // namespace mallow::cli
