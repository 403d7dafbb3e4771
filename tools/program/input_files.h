#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "mallow/scene.h"

namespace mallow::program {

/// The files that a command reads, so that it never writes over one of them. Two names are the same file
/// where the disk says so: through `..`, symbolic and hard links, and other case on a disk without it.
class InputFiles {
 public:
  InputFiles() = default;
  /// The file of a scene, and the meshes and points that it names.
  explicit InputFiles(const Scene& scene);

  void add(const std::filesystem::path& file);
  /// Throws IoError that names `option` where `output` is an input. One that does not exist yet is none.
  void refuse(const std::filesystem::path& output, const std::string& option) const;

 private:
  using FileId = std::pair<std::uintmax_t, std::uintmax_t>;  ///< device and inode

  std::map<FileId, std::filesystem::path> names_;
};

}  // namespace mallow::program
