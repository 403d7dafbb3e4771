#include <algorithm>
#include <cmath>
#include <string>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// Wavefront's OBJ and MTL: "Object Files", appendix B1 of the Advanced Visualizer Manual.
namespace mallow {
namespace {

/// Names end at a blank, comments begin with #, and \ at the end of a line joins the next to it.
std::string obj_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\' || c == 0x7f; }, '_');
  return name;
}

void append_vectors(std::string& text, const char* keyword, const std::vector<Vec3>& vectors, UpAxis up) {
  for (const Vec3& vector : vectors) {
    text += keyword;
    for (const float value : up == UpAxis::y ? with_y_up(vector) : vector)
      append_number(text += ' ', value, k_float_digits);
    text += '\n';
  }
}

void append_face(std::string& text, const Mesh& mesh, std::size_t triangle) {
  text += 'f';
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    const std::string index = std::to_string(std::uint64_t{vertex} + 1);
    text += ' ' + index;
    if (!mesh.normals.empty()) text += "//" + index;
  }
  text += '\n';
}

void append_bodies(std::string& text, const Mesh& mesh, const ObjOptions& options) {
  const NamedBodies named = name_bodies(options.bodies, obj_name);
  for (const auto& [id, triangles] : triangles_by_material(mesh)) {
    text += "g " + named.names[id] + '\n';
    if (!options.material_library.empty())
      text += "usemtl " + named.materials[named.material_of[id]].name + '\n';
    for (const std::size_t triangle : triangles) append_face(text, mesh, triangle);
  }
}

/// Of a value of linear light in [0, 1], as IEC 61966-2-1 has it.
double srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

void append_color(std::string& text, const char* keyword, double red, double green, double blue) {
  text += keyword;
  for (const double value : {red, green, blue}) append_number(text += ' ', value, 6);
  text += '\n';
}

}  // namespace

void write_mesh_obj(const std::filesystem::path& file, const Mesh& mesh, const ObjOptions& options) {
  require_valid(mesh);
  if (!options.bodies.empty()) require_bodies(mesh, options.bodies);
  const std::string library = options.material_library.generic_string();
  if (std::any_of(library.begin(), library.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }))
    throw ConfigError("options.material_library", "is not allowed: a name on one line");

  std::string text = "# mallow mesh\n";
  text += options.up == UpAxis::y ? "# y is up\n" : "# z is up\n";
  if (!library.empty()) text += "mtllib " + library + '\n';
  append_vectors(text, "v", mesh.vertices, options.up);
  append_vectors(text, "vn", mesh.normals, options.up);
  if (options.bodies.empty()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) append_face(text, mesh, t);
  } else {
    append_bodies(text, mesh, options);
  }
  require_readable_size(file, text.size());
  write_whole(file, text);
}

void write_mtl(const std::filesystem::path& file, std::span<const MeshBody> bodies) {
  require_bodies(bodies);
  std::string text = "# mallow materials\n# Kd is sRGB\n";
  for (const NamedMaterial& material : name_bodies(bodies, obj_name).materials) {
    const auto& [color, finish] = material.appearance;
    text += "\nnewmtl " + material.name + '\n';
    append_color(text, "Kd", srgb(double{color.x()}), srgb(double{color.y()}), srgb(double{color.z()}));
    // Blender's shader takes Ks 0.5 as what a dielectric reflects, and Ns as 1000 (1 - roughness)^2. Programs
    // with Phong's model do not weaken wide highlights, which would make clay shine.
    const double specular = finish == Finish::clay ? 0.1 : 0.5;
    append_color(text, "Ks", specular, specular, specular);
    const double gloss = 1 - roughness(finish);
    append_number(text += "Ns ", 1000 * gloss * gloss, 6);
    append_number(text += "\nPr ", roughness(finish), 6);
    text += "\nPm 0\nd 1\nillum 2\n";
  }
  write_whole(file, text);
}

}  // namespace mallow
