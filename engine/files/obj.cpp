#include <charconv>
#include <cstdint>
#include <system_error>
#include <vector>

#include "files/byte_reader.h"
#include "files/mesh_readers.h"
#include "files/read_origin.h"
#include "files/text_reader.h"

namespace mallow {
namespace {

/// The largest index met so far and where, so that a face may stand before its vertices, as the format
/// allows.
struct LargestIndex {
  std::int64_t index = 0;
  TextReader place;
};

/// Whether a text is `/vt`, `//vn` or `/vt/vn` with whole numbers.
bool is_texture_and_normal(std::string_view text) {
  int parts = 0;
  while (!text.empty() && text[0] == '/' && ++parts <= 2) {
    text.remove_prefix(1);
    std::int64_t ignored = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, ignored);
    if (error == std::errc{}) {
      text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    } else if (parts == 2 || text.empty() || text[0] != '/') {
      return false;
    }
  }
  return text.empty();
}

/// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, from 0; larger than there are vertices yet if it
/// is ahead.
std::uint32_t read_corner(const TextReader& text, std::string_view word, std::size_t vertices,
                          LargestIndex& largest) {
  std::int64_t index = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, index);
  if (error != std::errc{} || !is_texture_and_normal({stop, static_cast<std::size_t>(end - stop)})) {
    text.fail("f", in_quotes(word) + " is not allowed: v, v/vt, v//vn or v/vt/vn in whole numbers");
  }
  const auto count = static_cast<std::int64_t>(vertices);
  if (index == 0)
    text.fail("f", in_quotes(word) + " is not allowed: indices begin at 1, or at -1 from the end");
  if (index < -count) {
    text.fail("f", in_quotes(word) + " is not allowed: only " + counted(vertices, "vertex line") +
                       " come before it");
  }
  if (index < 0) return static_cast<std::uint32_t>(count + index);
  if (index > largest.index) largest = {index, text};
  return static_cast<std::uint32_t>(index - 1);
}

/// The next word of a face, which goes on over lines that end with a backslash.
std::string_view next_corner(TextReader& text) {
  std::string_view word = text.word();
  while (word == "\\" && text.next_line()) word = text.word();
  return word;
}

void read_face(TextReader& text, Mesh& mesh, LargestIndex& largest) {
  std::array<std::uint32_t, 3> triangle{};
  std::uint64_t corners = 0;
  for (std::string_view word = next_corner(text); !word.empty(); word = next_corner(text)) {
    if (word[0] == '#') break;
    triangle[corners < 2 ? corners : 2] = read_corner(text, word, mesh.vertices.size(), largest);
    if (++corners < 3) continue;
    if (corners > k_max_polygon_corners) {
      text.fail("f", "at most " + std::to_string(k_max_polygon_corners) + " corners are allowed");
    }
    require_room(text, mesh.triangles.size() + 1, "triangles");
    mesh.triangles.push_back(triangle);
    triangle[1] = triangle[2];
  }
  if (corners < 3) text.fail("f", counted(corners, "corner") + " are not allowed: at least 3");
}

}  // namespace

Mesh read_obj(const std::filesystem::path& file, Eigen::Vector3d* origin) {
  const std::string content = read_whole_file(file);
  TextReader text(file, content);
  Mesh mesh;
  ReadOrigin near(origin);
  LargestIndex largest{0, text};
  while (text.next_line()) {
    const std::string_view keyword = text.word();
    if (keyword == "v") {
      require_room(text, mesh.vertices.size() + 1, "vertices");
      mesh.vertices.push_back(near.relative(text.point()));
    } else if (keyword == "f") {
      read_face(text, mesh, largest);
    }
  }
  if (mesh.vertices.empty())
    fail_file(file, "this is not an OBJ file with a mesh: there is no vertex line 'v x y z'");
  if (largest.index > static_cast<std::int64_t>(mesh.vertices.size())) {
    largest.place.fail("f", "index " + std::to_string(largest.index) + " is not allowed: there are " +
                                counted(mesh.vertices.size(), "vertex line"));
  }
  return mesh;
}

}  // namespace mallow
