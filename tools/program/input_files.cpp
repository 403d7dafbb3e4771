#include "program/input_files.h"

#include <sys/stat.h>

#include <optional>

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
  Scene copy = scene;
  for (const std::filesystem::path* file : named_files(copy)) add(folder / *file);
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
