#include <algorithm>
#include <string_view>

#include "files/byte_reader.h"
#include "files/mesh_readers.h"
#include "files/read_origin.h"
#include "files/text_reader.h"

namespace mallow {
namespace {

struct OffCounts {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

void require_line(TextReader& text, const char* what) {
  if (!text.next_filled_line()) text.fail(what, "the file ends here");
}

/// `[ST][C][N]OFF`, then the counts on the same line or the next.
OffCounts read_header(TextReader& text) {
  require_line(text, "header");
  std::string_view keyword = text.word();
  const std::string_view written = keyword;
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  }
  if (keyword != "OFF") {
    text.fail("header",
              in_quotes(written) + " is not allowed: OFF, COFF, NOFF, CNOFF or STOFF in three dimensions");
  }
  TextReader ahead = text;
  if (const std::string_view next = ahead.word(); next.empty()) {
    require_line(text, "counts");
  } else if (next == "BINARY") {
    ahead.fail("header", "binary OFF is not supported; save it as text, or as PLY");
  }
  // The shortest vertex is "0 0 0" and a line end, the shortest triangle "3 0 0 0" and one.
  constexpr std::uint64_t k_vertex_bytes = 6, k_face_bytes = 8;
  OffCounts counts;
  counts.vertices = static_cast<std::uint64_t>(text.integer("vertex count", 0, INT64_MAX));
  counts.faces = static_cast<std::uint64_t>(text.integer("face count", 0, INT64_MAX));
  const std::uint64_t left = text.rest().size() + 1;
  if (counts.vertices > left / k_vertex_bytes ||
      counts.faces > (left - counts.vertices * k_vertex_bytes) / k_face_bytes) {
    text.fail("counts", counted(counts.vertices, "vertex row") + " and " + counted(counts.faces, "face") +
                            " are promised, but only " + counted(text.rest().size(), "byte") + " follow");
  }
  require_room(text, counts.vertices, "vertices");
  require_room(text, counts.faces, "triangles");
  return counts;
}

}  // namespace

Mesh read_off(const std::filesystem::path& file, Eigen::Vector3d* origin) {
  const std::string content = read_whole_file(file);
  TextReader text(file, content);
  const OffCounts counts = read_header(text);

  Mesh mesh;
  ReadOrigin near(origin);
  mesh.vertices.reserve(counts.vertices);
  for (std::uint64_t v = 0; v < counts.vertices; ++v) {
    require_line(text, "vertices");
    mesh.vertices.push_back(near.relative(text.point()));
  }
  mesh.triangles.reserve(counts.faces);
  const std::int64_t last = static_cast<std::int64_t>(counts.vertices) - 1;
  const auto vertex = [&] {
    if (last < 0) text.fail("vertex index", "is not allowed: there are no vertices");
    return static_cast<std::uint32_t>(text.integer("vertex index", 0, last));
  };
  for (std::uint64_t f = 0; f < counts.faces; ++f) {
    require_line(text, "faces");
    const std::int64_t corners = text.integer("corners of the face", 3, k_max_polygon_corners);
    const std::uint32_t first = vertex();
    std::uint32_t second = vertex();
    for (std::int64_t k = 2; k < corners; ++k) {
      const std::uint32_t third = vertex();
      require_room(text, mesh.triangles.size() + 1, "triangles");
      mesh.triangles.push_back({first, second, third});
      second = third;
    }
  }
  return mesh;
}

}  // namespace mallow
