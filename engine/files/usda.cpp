#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// USD's text files: openusd.org, "USDA File Format Specification" and the schemas UsdGeomMesh,
/// UsdGeomPrimvar and UsdGeomImageable.
namespace mallow {
namespace {

/// Says of an array that it has a value for each vertex, or for each face.
constexpr const char* k_per_vertex = " (\n        interpolation = \"vertex\"\n    )\n";
constexpr const char* k_per_face = " (\n        interpolation = \"uniform\"\n    )\n";

void append_value(std::string& text, const Vec3& vector) {
  append_shortest(text += '(', vector.x());
  append_shortest(text += ", ", vector.y());
  append_shortest(text += ", ", vector.z());
  text += ')';
}

void append_value(std::string& text, std::uint32_t number) {
  append_shortest(text, number);
}

/// `declaration = [...]` of values 0 to count - 1.
template <class Value>
void append_array(std::string& text, const char* declaration, std::size_t count, const Value& value) {
  text += "    ";
  text += declaration;
  text += " = [";
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    append_value(text, value(i));
  }
  text += ']';
}

void append_vectors(std::string& text, const char* declaration, std::span<const Vec3> vectors) {
  append_array(text, declaration, vectors.size(), [&](std::size_t i) -> const Vec3& { return vectors[i]; });
}

/// Groups and their colours, as arrays that programs show without a material.
void append_primvars(std::string& text, const Mesh& mesh, std::span<const Appearance> palette) {
  if (mesh.triangles.empty()) return;
  const auto append_colors = [&](std::size_t count) {
    append_array(text, "color3f[] primvars:displayColor", count,
                 [&](std::size_t i) -> const Vec3& { return palette[i].color; });
  };
  if (mesh.material_ids.empty()) {
    append_colors(1);
    text += " (\n        interpolation = \"constant\"\n    )\n";
    return;
  }
  // Faces, not vertices, have them: a colour between two groups is that of neither.
  const auto group = [&](std::size_t t) { return std::uint32_t{triangle_material(mesh, t)}; };
  append_colors(palette.size());
  text += k_per_face;
  append_array(text, "int[] primvars:displayColor:indices", mesh.triangles.size(), group);
  text += '\n';
  append_array(text, "int[] primvars:group", mesh.triangles.size(), group);
  text += k_per_face;
}

/// The reference of a file beside or below: without "./" USD would look for it along a search path.
std::string asset_path(const std::filesystem::path& file) {
  const std::string path = (file.is_absolute() ? "" : "./") + file.generic_string();
  if (path.find('@') == std::string::npos) return '@' + path + '@';
  if (path.find("@@@") != std::string::npos) fail_file(file, "cannot be named in USD: @@@ ends a path there");
  return "@@@" + path + "@@@";
}

std::string prim_name(int frame) {
  const std::string digits = std::to_string(frame);
  return "frame_" + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

void append_time_sample(std::string& text, int frame, const char* value) {
  text += "            " + std::to_string(frame) + ": \"" + value + "\",\n";
}

/// A frame is there from its time to that of the next. A sample holds until the next one, the first also
/// before it: that is why all but the first frame begin with one at the time of the first.
void append_visibility(std::string& text, std::span<const UsdFrame> frames, std::size_t f) {
  if (frames.size() == 1) return;
  // For programs that pay no heed to time: the first frame alone.
  if (f > 0) text += "        token visibility = \"invisible\"\n";
  text += "        token visibility.timeSamples = {\n";
  if (f > 0) append_time_sample(text, frames[0].number, "invisible");
  append_time_sample(text, frames[f].number, "inherited");
  if (f + 1 < frames.size()) append_time_sample(text, frames[f + 1].number, "invisible");
  text += "        }\n";
}

void require_ascending(std::span<const UsdFrame> frames) {
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].number >= 0 && (f == 0 || frames[f].number > frames[f - 1].number)) continue;
    throw ConfigError("frames[" + std::to_string(f) + "].number",
                      std::to_string(frames[f].number) + " is not allowed: from 0 on, ascending");
  }
}

void require_positive(const char* field, double rate) {
  if (std::isfinite(rate) && rate > 0) return;
  throw ConfigError(field, std::to_string(rate) + " is not allowed: > 0");
}

}  // namespace

void write_mesh_usda(const std::filesystem::path& file, const Mesh& mesh,
                     std::span<const Appearance> palette) {
  require_valid(mesh);
  require_finite(mesh);
  require_appearances(mesh, palette);

  std::string text =
      "#usda 1.0\n(\n    defaultPrim = \"surface\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n"
      "def Mesh \"surface\"\n{\n"
      "    uniform bool doubleSided = 0\n"  // surfaces are closed
      "    uniform token orientation = \"rightHanded\"\n"
      "    uniform token subdivisionScheme = \"none\"\n";
  if (!mesh.vertices.empty()) {
    const Aabb box = bounds(mesh);
    append_vectors(text, "float3[] extent", std::array{box.min, box.max});
    text += '\n';
  }
  append_array(text, "int[] faceVertexCounts", mesh.triangles.size(), [](std::size_t) { return 3u; });
  text += '\n';
  append_array(text, "int[] faceVertexIndices", 3 * mesh.triangles.size(),
               [&](std::size_t i) { return mesh.triangles[i / 3][i % 3]; });
  text += '\n';
  append_vectors(text, "point3f[] points", mesh.vertices);
  text += '\n';
  if (!mesh.normals.empty()) {
    append_vectors(text, "normal3f[] normals", mesh.normals);
    text += k_per_vertex;
  }
  if (!mesh.velocities.empty()) {
    append_vectors(text, "vector3f[] velocities", mesh.velocities);
    text += '\n';
  }
  append_primvars(text, mesh, palette);
  text += "}\n";
  require_readable_size(file, text.size());
  write_whole(file, text);
}

void write_usda_series(const std::filesystem::path& file, std::span<const UsdFrame> frames,
                       const UsdTimeline& timeline) {
  require_ascending(frames);
  require_positive("timeline.time_codes_per_second", timeline.time_codes_per_second);
  require_positive("timeline.frames_per_second", timeline.frames_per_second);

  std::string text = "#usda 1.0\n(\n    defaultPrim = \"surface\"\n";
  if (!frames.empty()) {
    text += "    endTimeCode = " + std::to_string(frames.back().number) + '\n';
    text += "    startTimeCode = " + std::to_string(frames.front().number) + '\n';
  }
  append_shortest(text += "    framesPerSecond = ", timeline.frames_per_second);
  append_shortest(text += "\n    timeCodesPerSecond = ", timeline.time_codes_per_second);
  text += "\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\ndef Xform \"surface\"\n{\n";
  for (std::size_t f = 0; f < frames.size(); ++f) {
    text += "    def \"" + prim_name(frames[f].number) +
            "\" (\n        prepend references = " + asset_path(frames[f].file) + "\n    )\n    {\n";
    append_visibility(text, frames, f);
    text += "    }\n";
  }
  write_whole(file, text + "}\n");
}

}  // namespace mallow
