#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/mesh_part.h"
#include "files/tiny_gltf.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
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
  /// Numbers that no vertex has.
  int add_numbers(const std::vector<float>& numbers) {
    const std::size_t begin = bytes_.size();
    for (const float number : numbers) append_little_endian(bytes_, number);
    return add_accessor(begin, numbers.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, 0);
  }
  /// Vectors whose box programs ask for.
  int add_places(const std::vector<Vec3>& vectors) {
    const int index = add_vectors(vectors);
    Mesh points;
    points.vertices = vectors;
    const Aabb box = bounds(points);
    gltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    accessor.minValues.assign(box.min.begin(), box.min.end());
    accessor.maxValues.assign(box.max.begin(), box.max.end());
    return index;
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

gltf::Primitive primitive_of(const Mesh& mesh, const MeshPart& part, GltfColumns& columns) {
  gltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = columns.add_places(picked(mesh.vertices, part.vertices));
  if (!mesh.normals.empty())
    primitive.attributes["NORMAL"] = columns.add_vectors(picked(mesh.normals, part.vertices));
  // glTF knows no velocities; names of an application's own begin with an underscore.
  if (!mesh.velocities.empty())
    primitive.attributes["_VELOCITY"] = columns.add_vectors(picked(mesh.velocities, part.vertices));
  primitive.indices = columns.add_corners(part.corners);
  return primitive;
}

/// Morph targets say how far vertices and normals go.
std::vector<Vec3> differences(const std::vector<Vec3>& to, const std::vector<Vec3>& from,
                              const std::vector<std::uint32_t>& rows) {
  std::vector<Vec3> result;
  for (const std::uint32_t row : rows) result.emplace_back(to[row] - from[row]);
  return result;
}

/// mesh: at the first of the poses.
void add_targets(const Mesh& mesh, std::span<const MeshPose> poses, const MeshPart& part,
                 GltfColumns& columns, gltf::Primitive& primitive) {
  for (std::size_t p = 1; p < poses.size(); ++p)
    primitive.targets.push_back(
        {{"POSITION", columns.add_places(differences(poses[p].vertices, mesh.vertices, part.vertices))},
         {"NORMAL", columns.add_vectors(differences(poses[p].normals, mesh.normals, part.vertices))}});
}

/// Target p − 1 alone at the time of pose p, of all meshes.
void add_motion(std::span<const MeshPose> poses, GltfColumns& columns, gltf::Model& model) {
  if (poses.size() < 2) return;
  const std::size_t targets = poses.size() - 1;
  std::vector<float> times, weights(poses.size() * targets, 0.0f);
  for (std::size_t p = 0; p < poses.size(); ++p) {
    times.push_back(static_cast<float>(poses[p].time));
    if (p > 0) weights[p * targets + p - 1] = 1;
  }
  gltf::Animation& animation = model.animations.emplace_back();
  animation.name = "motion";
  gltf::AnimationSampler& sampler = animation.samplers.emplace_back();
  sampler.input = columns.add_numbers(times);
  sampler.output = columns.add_numbers(weights);
  gltf::Accessor& input = model.accessors[static_cast<std::size_t>(sampler.input)];
  input.minValues = {static_cast<double>(times.front())};
  input.maxValues = {static_cast<double>(times.back())};
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    if (model.nodes[n].mesh < 0) continue;
    gltf::AnimationChannel& channel = animation.channels.emplace_back();
    channel.sampler = 0;
    channel.target_node = static_cast<int>(n);
    channel.target_path = "weights";
  }
}

/// A node and a mesh for each body, as programs show names of those and not of primitives. poses: empty, or
/// those that the mesh takes, of which it is in the first.
void add_bodies(const Mesh& mesh, std::span<const MeshPose> poses, std::span<const MeshBody> bodies,
                gltf::Model& model) {
  const NamedBodies named = name_bodies(bodies, [](const std::string& name) { return name; });
  std::vector<int> material_index(named.materials.size(), -1);
  GltfColumns columns(model);
  for (const auto& [id, triangles] : triangles_by_material(mesh)) {
    const std::size_t material = named.material_of[id];
    if (material_index[material] < 0) {
      material_index[material] = static_cast<int>(model.materials.size());
      model.materials.push_back(material_of(named.materials[material]));
    }
    gltf::Mesh body;
    body.name = named.names[id];
    const MeshPart part = part_of(mesh, triangles);
    gltf::Primitive& primitive = body.primitives.emplace_back(primitive_of(mesh, part, columns));
    primitive.material = material_index[material];
    add_targets(mesh, poses, part, columns, primitive);
    body.weights.assign(primitive.targets.size(), 0.0);
    gltf::Node node;
    node.name = body.name;
    node.mesh = static_cast<int>(model.meshes.size());
    model.meshes.push_back(std::move(body));
    model.nodes[0].children.push_back(static_cast<int>(model.nodes.size()));
    model.nodes.push_back(std::move(node));
  }
  add_motion(poses, columns, model);
  columns.finish();
}

void write_glb(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshPose> poses,
               std::span<const MeshBody> bodies) {
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
  if (!mesh.triangles.empty()) add_bodies(mesh, poses, bodies, model);
  model.scenes.emplace_back().nodes.push_back(0);
  model.defaultScene = 0;

  std::ostringstream bytes;
  gltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, bytes, false, true)) fail_file(file, "cannot be made into glTF");
  require_readable_size(file, bytes.view().size());
  write_whole(file, bytes.view());
}

void require_poses(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshPose> poses) {
  if (poses.empty()) throw ConfigError("poses", "there is none: at least one is needed");
  const std::size_t n = mesh.vertices.size();
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const MeshPose& pose = poses[p];
    const std::string name = "poses[" + std::to_string(p) + ']';
    const double after = p > 0 ? poses[p - 1].time : -1;
    if (!std::isfinite(pose.time) || pose.time < 0 || pose.time <= after)
      throw ConfigError(name + ".time", std::to_string(pose.time) +
                                            " is not allowed: a number >= 0, above that of the pose before");
    if (pose.vertices.size() != n || pose.normals.size() != n)
      throw ConfigError(name, "has " + std::to_string(pose.vertices.size()) + " vertices and " +
                                  std::to_string(pose.normals.size()) + " normals; the mesh has " +
                                  std::to_string(n) + " vertices");
    Mesh at;
    at.vertices = pose.vertices;
    at.normals = pose.normals;
    require_finite(at);
  }
  // Before memory is taken for it.
  require_readable_size(file, std::uint64_t{poses.size()} * n * 2 * sizeof(Vec3) +
                                  std::uint64_t{poses.size()} * poses.size() * sizeof(float));
}

}  // namespace

void write_mesh_glb(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshBody> bodies) {
  write_glb(file, mesh, {}, bodies);
}

void write_animation_glb(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshPose> poses,
                         std::span<const MeshBody> bodies) {
  require_poses(file, mesh, poses);
  Mesh first;
  first.vertices = poses.front().vertices;
  first.normals = poses.front().normals;
  first.triangles = mesh.triangles;
  first.material_ids = mesh.material_ids;
  write_glb(file, first, poses, bodies);
}

}  // namespace mallow
