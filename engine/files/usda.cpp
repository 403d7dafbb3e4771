#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "files/byte_reader.h"
#include "files/mesh_materials.h"
#include "files/usda_text.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// A mesh in USD's text: openusd.org, "USDA File Format Specification" and the schemas UsdGeomMesh,
/// UsdGeomSubset, UsdGeomPrimvar and UsdPreviewSurface.
namespace mallow {
namespace {

void append_value(std::string& text, const Vec3& vector) {
  append_shortest(text += '(', vector.x());
  append_shortest(text += ", ", vector.y());
  append_shortest(text += ", ", vector.z());
  text += ')';
}

void append_value(std::string& text, std::uint32_t number) {
  append_shortest(text, number);
}

/// Writes `[...]` of values 0 to count - 1.
template <class Value>
void append_list(std::string& text, std::size_t count, const Value& value) {
  text += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    append_value(text, value(i));
  }
  text += ']';
}

/// Attributes whose values belong to a frame, or always hold.
class Attributes {
 public:
  Attributes(std::string& text, std::optional<int> frame) : text_(text), frame_(frame) {}

  /// values 0 to count - 1
  template <class Value>
  void add(const UsdAttribute& attribute, std::size_t count, const Value& value) {
    const std::string indent(attribute.depth * 4, ' ');
    if (frame_) {
      // Metadata stands with a declaration of its own.
      if (*attribute.interpolation != '\0') {
        text_ += indent + attribute.declaration;
        append_interpolation(text_, attribute);
        text_ += '\n';
      }
      text_ += indent + attribute.declaration + ".timeSamples = {\n" + indent + "    " +
               std::to_string(*frame_) + ": ";
      append_list(text_, count, value);
      text_ += ",\n" + indent + "}\n";
      return;
    }
    text_ += indent + attribute.declaration;
    append_list(text_ += " = ", count, value);
    append_interpolation(text_, attribute);
    text_ += '\n';
  }

 private:
  std::string& text_;
  std::optional<int> frame_;
};

void append_columns(const Mesh& mesh, const UsdOptions& options, bool in_a_series, Attributes& attributes) {
  const auto turned = [&](const Vec3& v) { return options.up == UpAxis::y ? with_y_up(v) : v; };
  const auto speed = static_cast<float>(options.speed);
  if (!mesh.vertices.empty()) {
    const Aabb box = bounds(mesh);
    const Vec3 a = turned(box.min), b = turned(box.max);
    const std::array<Vec3, 2> corners = {a.cwiseMin(b), a.cwiseMax(b)};
    attributes.add(k_usd_extent, 2, [&](std::size_t i) { return corners[i]; });
  } else if (in_a_series) {
    // USD's box around nothing.
    constexpr float k_most = std::numeric_limits<float>::max();
    attributes.add(k_usd_extent, 2,
                   [&](std::size_t i) -> Vec3 { return Vec3::Constant(i == 0 ? k_most : -k_most); });
  }
  attributes.add(k_usd_counts, mesh.triangles.size(), [](std::size_t) { return 3u; });
  attributes.add(k_usd_corners, 3 * mesh.triangles.size(),
                 [&](std::size_t i) { return mesh.triangles[i / 3][i % 3]; });
  attributes.add(k_usd_points, mesh.vertices.size(), [&](std::size_t i) { return turned(mesh.vertices[i]); });
  // An attribute of a series that lacks a sample in a frame has no value there, not an empty one.
  const bool all = in_a_series && mesh.vertices.empty();
  if (!mesh.normals.empty() || all)
    attributes.add(k_usd_normals, mesh.normals.size(),
                   [&](std::size_t i) { return turned(mesh.normals[i]); });
  if (!mesh.velocities.empty() || all) {
    attributes.add(k_usd_velocities, mesh.velocities.size(),
                   [&](std::size_t i) -> Vec3 { return speed * turned(mesh.velocities[i]); });
  }
}

/// Colours as an array that programs show without a material. Faces, not vertices, have them: a colour
/// between two bodies is that of neither. There are no indices into a few colours: TinyUSDZ takes none that
/// change.
void append_primvars(std::string& text, const Mesh& mesh, std::span<const MeshBody> bodies,
                     Attributes& attributes) {
  if (bodies.size() == 1) {
    append_value(text += "        color3f[] primvars:displayColor = [", bodies[0].appearance.color);
    append_interpolation(text += ']', {2, "", "constant"});
    text += '\n';
  }
  if (bodies.size() < 2) return;
  attributes.add(k_usd_color, mesh.triangles.size(),
                 [&](std::size_t t) { return bodies[triangle_material(mesh, t)].appearance.color; });
  attributes.add(k_usd_group, mesh.triangles.size(),
                 [&](std::size_t t) { return triangle_material(mesh, t); });
}

void append_binding(std::string& text, const std::string& indent, const std::string& material) {
  text += indent + "rel material:binding = </surface/materials/" + material + ">\n";
}

/// The faces of each body, and its material. Bodies without a face are there too, so that all frames have
/// the same prims.
void append_subsets(std::string& text, const Mesh& mesh, const NamedBodies& named, Attributes& attributes) {
  const auto triangles = triangles_by_material(mesh);
  text += "        uniform token subsetFamily:materialBind:familyType = \"partition\"\n";
  for (std::size_t b = 0; b < named.names.size(); ++b) {
    text += "\n        def GeomSubset \"" + named.names[b] +
            "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n";
    append_display_name(text, 3, named.names[b], named.titles[b]);
    text += "        )\n        {\n";
    text += "            uniform token elementType = \"face\"\n";
    text += "            uniform token familyName = \"materialBind\"\n";
    static const std::vector<std::size_t> k_none;
    const auto found = triangles.find(static_cast<std::uint32_t>(b));
    const std::vector<std::size_t>& faces = found == triangles.end() ? k_none : found->second;
    attributes.add(k_usd_subset_indices, faces.size(),
                   [&](std::size_t i) { return static_cast<std::uint32_t>(faces[i]); });
    append_binding(text, "            ", named.materials[named.material_of[b]].name);
    text += "        }\n";
  }
}

void append_materials(std::string& text, const NamedBodies& named) {
  if (named.materials.empty()) return;
  text += "\n    def Scope \"materials\"\n    {\n";
  for (std::size_t m = 0; m < named.materials.size(); ++m) {
    const NamedMaterial& material = named.materials[m];
    if (m > 0) text += '\n';
    text += "        def Material \"" + material.name + '"';
    if (material.name != material.title) {
      append_display_name(text += " (\n", 3, material.name, material.title);
      text += "        )";
    }
    text += "\n        {\n            token outputs:surface.connect = </surface/materials/" + material.name +
            "/preview.outputs:surface>\n\n            def Shader \"preview\"\n            {\n"
            "                uniform token info:id = \"UsdPreviewSurface\"\n"
            "                color3f inputs:diffuseColor = ";
    append_value(text, material.appearance.color);
    append_shortest(text += "\n                float inputs:roughness = ",
                    roughness(material.appearance.finish));
    text += "\n                token outputs:surface\n            }\n        }\n";
  }
  text += "    }\n";
}

}  // namespace

void write_mesh_usda(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshBody> bodies,
                     const UsdOptions& options, std::optional<int> frame) {
  require_valid(mesh);
  require_finite(mesh);
  require_bodies(mesh, bodies);
  require_valid(options);
  if (frame && *frame < 0) throw ConfigError("frame", std::to_string(*frame) + " is not allowed: from 0 on");

  const NamedBodies named = name_bodies(bodies, usd_name);
  std::string text = usd_header(options, frame, frame) + "def Xform \"surface\"\n{\n    def Mesh \"mesh\"";
  if (bodies.size() == 1) text += " (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )";
  text +=
      "\n    {\n"
      "        uniform bool doubleSided = 0\n"  // surfaces are closed
      "        uniform token orientation = \"rightHanded\"\n"
      "        uniform token subdivisionScheme = \"none\"\n";
  Attributes attributes(text, frame);
  append_columns(mesh, options, frame.has_value(), attributes);
  append_primvars(text, mesh, bodies, attributes);
  if (bodies.size() == 1) append_binding(text, "        ", named.materials[0].name);
  if (bodies.size() > 1) append_subsets(text, mesh, named, attributes);
  text += "    }\n";
  append_materials(text, named);
  text += "}\n";
  require_readable_size(file, text.size());
  write_whole(file, text);
}

}  // namespace mallow
