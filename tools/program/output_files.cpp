#include "program/output_files.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
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

void refuse_to_replace(const std::filesystem::path& file, const std::string& option, Replace replace,
                       const IsOwn& is_own) {
  constexpr std::size_t k_beginning = std::size_t{1} << 20;  // holds what ffmpeg says of a film
  std::error_code unknown;
  if (replace == Replace::overwrite || !std::filesystem::is_regular_file(file, unknown)) return;
  std::string beginning(k_beginning, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(beginning.data(), static_cast<std::streamsize>(k_beginning));
  beginning.resize(static_cast<std::size_t>(stream.gcount()));
  const bool is_empty = std::filesystem::file_size(file, unknown) == 0;
  if (is_empty || (is_own && is_own(beginning))) return;
  throw IoError({file.string(), 0, 0, option,
                 "is there already, and was not written by " + option + "; give another name" +
                     (replace == Replace::no ? ", or --overwrite to replace it" : "")});
}

}  // namespace mallow::program
