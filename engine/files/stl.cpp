#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <vector>

#include "files/byte_reader.h"
#include "files/mesh_readers.h"
#include "files/read_origin.h"
#include "files/text_reader.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

constexpr std::uint64_t k_header_bytes = 80;
constexpr std::uint64_t k_preamble_bytes = k_header_bytes + 4;
constexpr std::uint64_t k_triangle_bytes = 50;

/// Corners of triangles, three each, that become vertices of a mesh.
class Corners {
 public:
  explicit Corners(Eigen::Vector3d* origin) : near_(origin) {}
  void reserve(std::size_t triangles) {
    mesh_.vertices.reserve(3 * triangles);
    mesh_.triangles.reserve(triangles);
  }
  void add(const Eigen::Vector3d& corner) {
    mesh_.vertices.push_back(near_.relative(corner));
    const auto count = static_cast<std::uint32_t>(mesh_.vertices.size());
    if (count % 3 == 0) mesh_.triangles.push_back({count - 3, count - 2, count - 1});
  }
  Mesh join() const { return welded(mesh_); }

 private:
  ReadOrigin near_;
  Mesh mesh_;
};

std::string triangle_and_corner(std::size_t triangle, std::size_t corner) {
  return "triangle " + std::to_string(triangle) + ", corner " + std::to_string(corner);
}

Mesh read_binary(const std::filesystem::path& file, ByteReader bytes, std::size_t triangles,
                 Eigen::Vector3d* origin) {
  Corners corners(origin);
  corners.reserve(triangles);
  constexpr std::uint64_t k_normal_bytes = 12, k_attribute_bytes = 2;
  for (std::size_t t = 0; t < triangles; ++t) {
    bytes.skip(k_normal_bytes);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 corner;
      for (float& coordinate : corner) coordinate = bytes.read<float>().value();
      if (!corner.allFinite()) {
        throw IoError(Problem{.file = file.string(),
                              .line = 0,
                              .column = 0,
                              .field = triangle_and_corner(t, k),
                              .message = "its coordinates are not finite numbers"});
      }
      corners.add(corner.cast<double>());
    }
    bytes.skip(k_attribute_bytes);
  }
  return corners.join();
}

bool same_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

void require_line(TextReader& text, const char* keyword) {
  if (!text.next_filled_line())
    text.fail("", "the file ends where '" + std::string(keyword) + "' must follow");
  const std::string_view word = text.word();
  if (!same_word(word, keyword)) text.fail("", in_quotes(word) + " is not allowed here: " + keyword);
}

void read_facet(TextReader& text, Corners& corners) {
  require_line(text, "outer");
  for (int k = 0; k < 3; ++k) {
    require_line(text, "vertex");
    corners.add(text.point());
  }
  require_line(text, "endloop");
  require_line(text, "endfacet");
}

Mesh read_ascii(const std::filesystem::path& file, std::string_view content, Eigen::Vector3d* origin) {
  TextReader text(file, content);
  Corners corners(origin);
  bool inside = false;
  while (text.next_filled_line()) {
    const std::string_view word = text.word();
    if (same_word(word, inside ? "endsolid" : "solid")) {
      inside = !inside;
    } else if (inside && same_word(word, "facet")) {
      read_facet(text, corners);
    } else {
      text.fail("", in_quotes(word) + " is not allowed here: " + (inside ? "facet or endsolid" : "solid"));
    }
  }
  if (inside) text.fail("", "the file ends before endsolid");
  return corners.join();
}

}  // namespace

Mesh read_stl(const std::filesystem::path& file, Eigen::Vector3d* origin) {
  const std::string content = read_whole_file(file);
  // Binary files may begin with "solid" as well, so their length decides.
  ByteReader bytes(content, std::endian::little);
  std::uint64_t triangles = 0;
  if (bytes.skip(k_header_bytes)) triangles = bytes.read<std::uint32_t>().value_or(0);
  const std::uint64_t promised = k_preamble_bytes + k_triangle_bytes * triangles;
  if (content.size() == promised) return read_binary(file, bytes, triangles, origin);

  const bool text = content.find('\0') >= std::min<std::size_t>(content.size(), k_preamble_bytes);
  const std::size_t begin = std::min(content.find_first_not_of(" \t\r\n"), content.size());
  if (text && same_word(std::string_view(content).substr(begin, 5), "solid"))
    return read_ascii(file, content, origin);
  if (content.size() < k_preamble_bytes) {
    fail_file(
        file,
        "this is not an STL file: it neither begins with 'solid' nor has the 84 bytes before the triangles");
  }
  fail_file(file, counted(triangles, "triangle") + " in the header take " + counted(promised, "byte") +
                      ", but the file has " + std::to_string(content.size()));
}

}  // namespace mallow
