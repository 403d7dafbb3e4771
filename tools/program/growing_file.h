#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace mallow::program {

/// A CSV that grows by whole lines, so that whatever ends the program leaves the lines that were there.
class GrowingFile {
 public:
  /// Empty. Throws IoError where it cannot be written.
  explicit GrowingFile(std::filesystem::path file);
  /// Goes on behind its first `size` bytes, and drops what follows. Throws IoError where they are not those
  /// that were written: they must have the hash `hash`.
  GrowingFile(std::filesystem::path file, std::uint64_t size, std::uint64_t hash);
  ~GrowingFile();
  GrowingFile(GrowingFile&& other) noexcept;
  GrowingFile& operator=(GrowingFile&&) = delete;

  /// Throws IoError, as on a full disk.
  void add(const std::string& line);
  /// Waits until all lines are on the disk.
  void sync() const;

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t size() const { return size_; }  ///< bytes
  std::uint64_t hash() const { return hash_; }  ///< of all bytes

 private:
  std::filesystem::path file_;
  int descriptor_;
  std::uint64_t size_ = 0;
  std::uint64_t hash_;
};

}  // namespace mallow::program
