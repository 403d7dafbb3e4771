#include <bit>
#include <cctype>
#include <cmath>
#include <unordered_map>

#include "files/byte_reader.h"
#include "files/mesh_readers.h"
#include "files/text_reader.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

constexpr std::uint64_t k_header_bytes = 80;
constexpr std::uint64_t k_preamble_bytes = k_header_bytes + 4;
constexpr std::uint64_t k_triangle_bytes = 50;

/// Gives corners with the same coordinates, to the bit, the same vertex.
class CornerJoin {
 public:
  explicit CornerJoin(Mesh& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(const Vec3& corner) {
    const Vec3 place = corner + Vec3::Zero();  // -0 becomes 0
    const Bits bits{std::bit_cast<std::uint32_t>(place.x()), std::bit_cast<std::uint32_t>(place.y()),
                    std::bit_cast<std::uint32_t>(place.z())};
    const auto [known, is_new] =
        vertices_.try_emplace(bits, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(place);
    return known->second;
  }

 private:
  using Bits = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Bits& bits) const {
      std::uint64_t hash = 0;
      // Multiply by 2^64 over the golden ratio and fold, so that all bits count.
      for (const std::uint32_t word : bits) {
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };

  Mesh& mesh_;
  std::unordered_map<Bits, std::uint32_t, Hash> vertices_;
};

std::string triangle_and_corner(std::size_t triangle, std::size_t corner) {
  return "triangle " + std::to_string(triangle) + ", corner " + std::to_string(corner);
}

Mesh read_binary(const std::filesystem::path& file, ByteReader bytes, std::size_t triangles) {
  Mesh mesh;
  CornerJoin join(mesh);
  mesh.triangles.resize(triangles);
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
      mesh.triangles[t][k] = join.vertex(corner);
    }
    bytes.skip(k_attribute_bytes);
  }
  return mesh;
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

void read_facet(TextReader& text, Mesh& mesh, CornerJoin& join) {
  require_line(text, "outer");
  std::array<std::uint32_t, 3> triangle{};
  for (std::uint32_t& corner : triangle) {
    require_line(text, "vertex");
    corner = join.vertex(text.point());
  }
  require_line(text, "endloop");
  require_line(text, "endfacet");
  mesh.triangles.push_back(triangle);
}

Mesh read_ascii(const std::filesystem::path& file, std::string_view content) {
  TextReader text(file, content);
  Mesh mesh;
  CornerJoin join(mesh);
  bool inside = false;
  while (text.next_filled_line()) {
    const std::string_view word = text.word();
    if (same_word(word, inside ? "endsolid" : "solid")) {
      inside = !inside;
    } else if (inside && same_word(word, "facet")) {
      read_facet(text, mesh, join);
    } else {
      text.fail("", in_quotes(word) + " is not allowed here: " + (inside ? "facet or endsolid" : "solid"));
    }
  }
  if (inside) text.fail("", "the file ends before endsolid");
  return mesh;
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
