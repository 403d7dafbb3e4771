#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "files/byte_reader.h"
#include "files/mesh_readers.h"
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
  void reserve(std::size_t triangles) { places_.reserve(3 * triangles); }
  void add(const Vec3& corner) { places_.emplace_back(corner + Vec3::Zero()); }  // -0 becomes 0

  /// Corners with the same coordinates are one vertex; vertices stand in the order in which they first
  /// appear. They meet by sorting: whoever writes a file can choose corners that collide in a hash table.
  Mesh join() const {
    std::vector<std::uint32_t> sorted(places_.size());
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::sort(sorted.begin(), sorted.end(), [this](std::uint32_t a, std::uint32_t b) {
      const Vec3 &p = places_[a], &q = places_[b];
      return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
    });
    std::vector<std::uint32_t> first(places_.size());  // by corner: the first one at its place
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      const bool same = k > 0 && places_[sorted[k]] == places_[sorted[k - 1]];
      first[sorted[k]] = same ? first[sorted[k - 1]] : sorted[k];
    }
    Mesh mesh;
    mesh.triangles.resize(places_.size() / 3);
    std::vector<std::uint32_t>& vertex = sorted;  // by corner, from here on
    for (std::uint32_t c = 0; c < vertex.size(); ++c) {
      const bool is_new = first[c] == c;
      vertex[c] = is_new ? static_cast<std::uint32_t>(mesh.vertices.size()) : vertex[first[c]];
      if (is_new) mesh.vertices.push_back(places_[c]);
      mesh.triangles[c / 3][c % 3] = vertex[c];
    }
    return mesh;
  }

 private:
  std::vector<Vec3> places_;
};

std::string triangle_and_corner(std::size_t triangle, std::size_t corner) {
  return "triangle " + std::to_string(triangle) + ", corner " + std::to_string(corner);
}

Mesh read_binary(const std::filesystem::path& file, ByteReader bytes, std::size_t triangles) {
  Corners corners;
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
      corners.add(corner);
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

Mesh read_ascii(const std::filesystem::path& file, std::string_view content) {
  TextReader text(file, content);
  Corners corners;
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

Mesh read_stl(const std::filesystem::path& file) {
  const std::string content = read_whole_file(file);
  // Binary files may begin with "solid" as well, so their length decides.
  ByteReader bytes(content, std::endian::little);
  std::uint64_t triangles = 0;
  if (bytes.skip(k_header_bytes)) triangles = bytes.read<std::uint32_t>().value_or(0);
  const std::uint64_t promised = k_preamble_bytes + k_triangle_bytes * triangles;
  if (content.size() == promised) return read_binary(file, bytes, triangles);

  const bool text = content.find('\0') >= std::min<std::size_t>(content.size(), k_preamble_bytes);
  const std::size_t begin = std::min(content.find_first_not_of(" \t\r\n"), content.size());
  if (text && same_word(std::string_view(content).substr(begin, 5), "solid"))
    return read_ascii(file, content);
  if (content.size() < k_preamble_bytes) {
    fail_file(
        file,
        "this is not an STL file: it neither begins with 'solid' nor has the 84 bytes before the triangles");
  }
  fail_file(file, counted(triangles, "triangle") + " in the header take " + counted(promised, "byte") +
                      ", but the file has " + std::to_string(content.size()));
}

}  // namespace mallow
