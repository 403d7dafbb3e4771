#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace mallow::program {

/// Throws IoError where `file` cannot be written, now and not after hours of work. Leaves nothing behind.
void check_writable(const std::filesystem::path& file);

/// Whether a file that begins so is one that an option writes.
using IsOwn = std::function<bool(std::string_view beginning)>;

/// What replaces a file that is there and is not the option's own.
enum class Replace {
  no,           ///< nothing; --overwrite would
  overwrite,    ///< this call: --overwrite is given
  has_no_word,  ///< nothing: the command takes no --overwrite
};

/// Throws IoError where `file`, which `option` names, holds what somebody may miss: bytes that are not the
/// option's own. For every output file that a command line names, before any work.
void refuse_to_replace(const std::filesystem::path& file, const std::string& option, Replace replace,
                       const IsOwn& is_own = {});

}  // namespace mallow::program
