#include "program/output_files.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "mallow/errors.h"
#include "mallow/files.h"

namespace mallow::program {

void check_writable(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file))
    throw IoError({file.string(), 0, 0, "", "is a folder, not a file"});
  if (is_written_in_place(file)) return;
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  // Only creating a file tells: root passes every check of permission bits, also where nothing can be
  // created.
  std::string probe = (folder / ".mallow-XXXXXX").string();
  const int descriptor = ::mkstemp(probe.data());
  if (descriptor < 0)
    throw IoError({file.string(), 0, 0, "", std::string("cannot be written: ") + std::strerror(errno)});
  ::close(descriptor);
  ::unlink(probe.c_str());
}

}  // namespace mallow::program
