#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace mallow::scene_file {

/// Marks a folder whose scenes may name each other's files: those below the nearest one above a scene.
inline constexpr const char* k_root_marker = ".mallow-root";

/// Which files a scene may name. A scene comes from anywhere, so it must not choose what is opened on this
/// machine.
class SceneFiles {
 public:
  /// outside: all files there are.
  SceneFiles(const std::filesystem::path& scene_file, bool outside);

  std::filesystem::path full_name(const std::filesystem::path& name) const { return folder_ / name; }
  /// Whether a file lies below the root once `..` and links are followed; it need not exist.
  bool may_name(const std::filesystem::path& name) const;
  /// What names must not lead out of: the nearest folder at or above the scene's that is marked, or the
  /// scene's.
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path root_;
  bool outside_;
};

}  // namespace mallow::scene_file
