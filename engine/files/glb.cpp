#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/tiny_gltf.h"
#include "files/valid_columns.h"
#include "mallow/files.h"

namespace mallow {
namespace {

namespace gltf = mallow_tinygltf;

/// glTF's core has no translucency; jelly is told from clay by what it mirrors.
double roughness(Finish finish) {
  return finish == Finish::clay ? 0.9 : 0.5;
}

/// Numbers of a glTF: one buffer, a view of it and an accessor for each column.
class GltfColumns {
 public:
  explicit GltfColumns(gltf::Model& model) : model_(model) {}

  /// Gives the accessor's index.
  int add_vectors(const std::vector<Vec3>& vectors) {
    const std::size_t begin = bytes_.size();
    for (const Vec3& vector : vectors) append_little_endian(bytes_, vector);
    return add_accessor(begin, vectors.size(), TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                        TINYGLTF_TARGET_ARRAY_BUFFER);
  }
  int add_corners(const std::vector<std::uint32_t>& corners) {
    const std::size_t begin = bytes_.size();
    for (const std::uint32_t corner : corners) append_little_endian(bytes_, corner);
    return add_accessor(begin, corners.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }
  /// Puts the buffer into the model; nothing is added after it.
  void finish() { model_.buffers.emplace_back().data.assign(bytes_.begin(), bytes_.end()); }

 private:
  int add_accessor(std::size_t begin, std::size_t count, int type, int component, int target) {
    gltf::BufferView& view = model_.bufferViews.emplace_back();
    view.buffer = 0;
    view.byteOffset = begin;
    view.byteLength = bytes_.size() - begin;
    view.target = target;
    gltf::Accessor& accessor = model_.accessors.emplace_back();
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.count = count;
    accessor.type = type;
    accessor.componentType = component;
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  gltf::Model& model_;
  std::string bytes_;
};

/// Corners of the triangles of each material id.
std::map<std::uint8_t, std::vector<std::uint32_t>> corners_by_material(const Mesh& mesh) {
  std::map<std::uint8_t, std::vector<std::uint32_t>> corners;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::vector<std::uint32_t>& of_material = corners[triangle_material(mesh, t)];
    of_material.insert(of_material.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  return corners;
}

gltf::Material material_of(const Appearance& appearance) {
  gltf::Material material;
  const Vec3& color = appearance.color;
  material.pbrMetallicRoughness.baseColorFactor = {color.x(), color.y(), color.z(), 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = roughness(appearance.finish);
  return material;
}

gltf::Mesh shared_vertices(const Mesh& mesh, std::span<const Appearance> palette, gltf::Model& model) {
  GltfColumns columns(model);
  gltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  const int positions = primitive.attributes["POSITION"] = columns.add_vectors(mesh.vertices);
  const Aabb box = bounds(mesh);
  gltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(positions)];
  accessor.minValues.assign(box.min.begin(), box.min.end());
  accessor.maxValues.assign(box.max.begin(), box.max.end());
  if (!mesh.normals.empty()) primitive.attributes["NORMAL"] = columns.add_vectors(mesh.normals);
  // glTF knows no velocities; names of an application's own begin with an underscore.
  if (!mesh.velocities.empty()) primitive.attributes["_VELOCITY"] = columns.add_vectors(mesh.velocities);

  gltf::Mesh parts;
  for (const auto& [id, corners] : corners_by_material(mesh)) {
    primitive.indices = columns.add_corners(corners);
    primitive.material = static_cast<int>(model.materials.size());
    model.materials.push_back(material_of(palette[id]));
    model.materials.back().name = "material " + std::to_string(id);
    parts.primitives.push_back(primitive);
  }
  columns.finish();
  return parts;
}

}  // namespace

void write_mesh_glb(const std::filesystem::path& file, const Mesh& mesh,
                    std::span<const Appearance> palette) {
  require_valid(mesh);
  require_finite(mesh);
  require_appearances(mesh, palette);

  gltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "mallow";
  gltf::Node& node = model.nodes.emplace_back();
  node.name = "surface";
  constexpr double k_half = 0.5 * std::numbers::sqrt2;
  node.rotation = {-k_half, 0, 0, k_half};  // a quarter turn about x, as x y z w
  if (!mesh.triangles.empty()) {
    node.mesh = 0;
    model.meshes.push_back(shared_vertices(mesh, palette, model));
  }
  model.scenes.emplace_back().nodes.push_back(0);
  model.defaultScene = 0;

  std::ostringstream bytes;
  gltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, bytes, false, true)) fail_file(file, "cannot be made into glTF");
  require_readable_size(file, bytes.view().size());
  write_whole(file, bytes.view());
}

}  // namespace mallow
