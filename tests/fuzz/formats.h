#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

/// The formats that are read from strangers: what the fuzz targets and the replay of their files have in
/// common.
namespace mallow::fuzz {

struct Format {
  const char* name;       ///< of the folders seeds/<name> and regressions/<name>
  const char* file_name;  ///< by whose ending the reader knows the format
  /// Reads a file through the public readers. Throws mallow::Error where it is refused, std::logic_error
  /// where it was read as something that no file may be read as.
  void (*read)(const std::filesystem::path& file);
  /// What every message names where that is not the file.
  const char* place = nullptr;
};

std::span<const Format> formats();
/// Throws std::out_of_range.
const Format& format(std::string_view name);

enum class Verdict { read, refused };

/// One file in a folder of its own, written anew for every input: readers take paths. It is kept open, as
/// some file systems flush a file that is cut to nothing and closed.
class Input {
 public:
  explicit Input(const Format& format);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// Writes the file and reads it as its format. Throws what the reader throws that is no mallow::Error, and
  /// std::logic_error where the message of one does not name the file.
  Verdict read(std::string_view content);
  /// The message of the last file that was refused.
  const std::string& message() const { return message_; }

 private:
  const Format& format_;
  std::filesystem::path folder_;
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::string message_;
};

}  // namespace mallow::fuzz
