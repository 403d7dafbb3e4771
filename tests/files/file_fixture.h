#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mallow/errors.h"
#include "mallow/files.h"

namespace mallow {

/// A folder of the test's own, gone when it ends.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mallow_files_XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// A file with this content.
  std::filesystem::path file(const std::string& name, std::string_view content) const {
    // A new file: some file systems flush one that is cut to nothing and written again, which is slow.
    std::filesystem::remove(path_ / name);
    std::ofstream out(path_ / name, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    return path_ / name;
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The problem that `read` throws; fails the test where it throws nothing.
template <class Read>
Problem io_problem(Read&& read) {
  try {
    read();
  } catch (const IoError& error) {
    return error.problem();
  }
  ADD_FAILURE() << "no IoError was thrown";
  return {};
}

template <class T>
void append_raw(std::string& bytes, T value, std::endian order = std::endian::little) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// A tetrahedron whose coordinates need all of their digits.
inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {
      {0.1f, -0.2f, 1.0f / 3.0f}, {1.1f, 0, 1e-20f}, {0, 1e10f, 0.7f}, {-0.3f, 0.25f, 3.14159274f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

inline ParticleFrame three_particles() {
  ParticleFrame frame;
  frame.positions = {{0.1f, -2.5e-7f, 3.0f}, {1.0f / 3.0f, 1e9f, -0.0f}, {7, 8, 9}};
  frame.velocities = {{0, 0, -0.3f}, {16777217.0f, 1e-40f, 2.0f / 7.0f}, {-1, 0.15f, 1e30f}};
  frame.bodies = {0, 255, 3};
  frame.time = 0.1 + 0.2;
  frame.step = 123456789012;
  return frame;
}

}  // namespace mallow
