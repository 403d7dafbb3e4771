#include <algorithm>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/tiny_gltf.h"
#include "files/valid_columns.h"
#include "mallow/files.h"

namespace mallow {
namespace {

namespace gltf = mallow_tinygltf;

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

/// Those vertices of a mesh that some of its triangles have, and the triangles' corners among them.
struct Part {
  std::vector<std::uint32_t> vertices;  ///< ascending
  std::vector<std::uint32_t> corners;
};

Part part_of(const Mesh& mesh, const std::vector<std::size_t>& triangles) {
  Part part;
  for (const std::size_t t : triangles)
    part.corners.insert(part.corners.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  part.vertices = part.corners;
  std::sort(part.vertices.begin(), part.vertices.end());
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  for (std::uint32_t& corner : part.corners) {
    const auto at = std::lower_bound(part.vertices.begin(), part.vertices.end(), corner);
    corner = static_cast<std::uint32_t>(at - part.vertices.begin());
  }
  return part;
}

std::vector<Vec3> picked(const std::vector<Vec3>& vectors, const std::vector<std::uint32_t>& rows) {
  std::vector<Vec3> result;
  if (vectors.empty()) return result;
  for (const std::uint32_t row : rows) result.push_back(vectors[row]);
  return result;
}

gltf::Material material_of(const NamedMaterial& named) {
  const Appearance& appearance = named.appearance;
  gltf::Material material;
  material.name = named.name;
  const Vec3& color = appearance.color;
  material.pbrMetallicRoughness.baseColorFactor = {color.x(), color.y(), color.z(), 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = roughness(appearance.finish);
  return material;
}

gltf::Primitive primitive_of(const Mesh& mesh, const Part& part, GltfColumns& columns, gltf::Model& model) {
  gltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  Mesh points;
  points.vertices = picked(mesh.vertices, part.vertices);
  const int positions = primitive.attributes["POSITION"] = columns.add_vectors(points.vertices);
  const Aabb box = bounds(points);
  gltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(positions)];
  accessor.minValues.assign(box.min.begin(), box.min.end());
  accessor.maxValues.assign(box.max.begin(), box.max.end());
  if (!mesh.normals.empty())
    primitive.attributes["NORMAL"] = columns.add_vectors(picked(mesh.normals, part.vertices));
  // glTF knows no velocities; names of an application's own begin with an underscore.
  if (!mesh.velocities.empty())
    primitive.attributes["_VELOCITY"] = columns.add_vectors(picked(mesh.velocities, part.vertices));
  primitive.indices = columns.add_corners(part.corners);
  return primitive;
}

/// A node and a mesh for each body, as programs show names of those and not of primitives.
void add_bodies(const Mesh& mesh, std::span<const MeshBody> bodies, gltf::Model& model) {
  const NamedBodies named = name_bodies(bodies, [](const std::string& name) { return name; });
  std::vector<int> material_index(named.materials.size(), -1);
  GltfColumns columns(model);
  for (const auto& [id, triangles] : triangles_by_material(mesh)) {
    const std::size_t material = named.material_of[id];
    if (material_index[material] < 0) {
      material_index[material] = static_cast<int>(model.materials.size());
      model.materials.push_back(material_of(named.materials[material]));
    }
    gltf::Mesh part;
    part.name = named.names[id];
    part.primitives.push_back(primitive_of(mesh, part_of(mesh, triangles), columns, model));
    part.primitives.back().material = material_index[material];
    gltf::Node node;
    node.name = part.name;
    node.mesh = static_cast<int>(model.meshes.size());
    model.meshes.push_back(std::move(part));
    model.nodes[0].children.push_back(static_cast<int>(model.nodes.size()));
    model.nodes.push_back(std::move(node));
  }
  columns.finish();
}

}  // namespace

void write_mesh_glb(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshBody> bodies) {
  require_valid(mesh);
  require_finite(mesh);
  require_bodies(mesh, bodies);

  gltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "mallow";
  gltf::Node& node = model.nodes.emplace_back();
  node.name = "surface";
  constexpr double k_half = 0.5 * std::numbers::sqrt2;
  node.rotation = {-k_half, 0, 0, k_half};  // a quarter turn about x, as x y z w
  if (!mesh.triangles.empty()) add_bodies(mesh, bodies, model);
  model.scenes.emplace_back().nodes.push_back(0);
  model.defaultScene = 0;

  std::ostringstream bytes;
  gltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, bytes, false, true)) fail_file(file, "cannot be made into glTF");
  require_readable_size(file, bytes.view().size());
  write_whole(file, bytes.view());
}

}  // namespace mallow
