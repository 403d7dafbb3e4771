#include "program/input_files.h"

#include <sys/stat.h>

#include <optional>
#include <variant>

#include "mallow/errors.h"

namespace mallow::program {
namespace {

/// Of a regular file, once links are followed: a terminal may be read and written.
std::optional<std::pair<std::uintmax_t, std::uintmax_t>> id_of(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return std::pair<std::uintmax_t, std::uintmax_t>{status.st_dev, status.st_ino};
}

}  // namespace

InputFiles::InputFiles(const Scene& scene) {
  add(scene.file);
  const std::filesystem::path folder = scene.file.parent_path();
  for (const SceneBody& body : scene.bodies) {
    if (const auto* mesh = std::get_if<MeshSource>(&body.source)) add(folder / mesh->file);
    if (const auto* points = std::get_if<PointsSource>(&body.source)) add(folder / points->file);
    if (!body.skin.empty()) add(folder / body.skin);
  }
}

void InputFiles::add(const std::filesystem::path& file) {
  if (const auto id = id_of(file)) names_.emplace(*id, file);
}

void InputFiles::refuse(const std::filesystem::path& output, const std::string& option) const {
  const auto id = id_of(output);
  const auto input = id ? names_.find(*id) : names_.end();
  if (input == names_.end()) return;
  std::string message = "would be written over, but is read";
  if (input->second != output) message += " as " + input->second.string();
  throw IoError({output.string(), 0, 0, option, message + "; give another name"});
}

}  // namespace mallow::program
