#include "scene/scene_files.h"

#include <algorithm>
#include <system_error>

namespace mallow::scene_file {
namespace {

/// The nearest folder at or above this one that is marked, or this one.
std::filesystem::path root_of(const std::filesystem::path& folder) {
  for (std::filesystem::path above = folder;; above = above.parent_path()) {
    std::error_code error;
    if (std::filesystem::exists(above / k_root_marker, error)) return above;
    if (above == above.parent_path()) return folder;
  }
}

}  // namespace

SceneFiles::SceneFiles(const std::filesystem::path& scene_file, bool outside)
    : folder_(scene_file.parent_path()), outside_(outside) {
  std::error_code error;
  const auto here = std::filesystem::weakly_canonical(folder_.empty() ? "." : folder_, error);
  root_ = root_of(error ? folder_ : std::filesystem::absolute(here, error));
}

bool SceneFiles::may_name(const std::filesystem::path& name) const {
  if (outside_) return true;
  std::error_code error;
  const auto file =
      std::filesystem::weakly_canonical(std::filesystem::absolute(full_name(name), error), error);
  if (error) return false;
  return std::mismatch(root_.begin(), root_.end(), file.begin(), file.end()).first == root_.end();
}

}  // namespace mallow::scene_file
