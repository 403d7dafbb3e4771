#include <cstring>
#include <limits>

#include "files/file_fixture.h"
#include "files/other_reader.h"
#include "files/tiny_gltf.h"

namespace mallow {
namespace glb_test {

namespace gltf = mallow_tinygltf;

const std::vector<MeshBody> k_bodies = {{{{0.8f, 0.24f, 0.09f}}, "left cube", "paste"},
                                        {{{0, 1, 0.5f}}},
                                        {{{0.1f, 0.2f, 0.3f}, Finish::clay}, "Würfel \"2\"", "clay"}};

gltf::Model read_glb(const std::filesystem::path& file) {
  gltf::Model model;
  std::string errors;
  std::string warnings;
  gltf::TinyGLTF reader;
  EXPECT_TRUE(reader.LoadBinaryFromFile(&model, &errors, &warnings, file.string()));
  EXPECT_EQ(errors, "");
  EXPECT_EQ(warnings, "");
  return model;
}

const gltf::Accessor& accessor_of(const gltf::Model& model, int index) {
  return model.accessors.at(static_cast<std::size_t>(index));
}

/// The numbers of an accessor, which lie without gaps.
template <class T>
std::vector<T> numbers(const gltf::Model& model, int index) {
  const gltf::Accessor& accessor = accessor_of(model, index);
  const gltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  std::vector<T> values(accessor.count);
  EXPECT_EQ(view.byteLength, values.size() * sizeof(T));
  EXPECT_LE(view.byteOffset + view.byteLength, model.buffers.at(0).data.size());
  std::memcpy(static_cast<void*>(values.data()), model.buffers.at(0).data.data() + view.byteOffset,
              view.byteLength);
  return values;
}

Mesh two_tetrahedra() {
  Mesh mesh = tetrahedron();
  for (std::size_t v = 0; v < 4; ++v) mesh.vertices.push_back(mesh.vertices[v] + Vec3(0, 0, 5));
  for (std::size_t t = 0; t < 4; ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({a + 4, b + 4, c + 4});
  }
  mesh.normals.assign(8, Vec3(0.6f, 0, -0.8f));
  mesh.velocities.assign(8, Vec3(0, 1e-20f, -9.8f));
  mesh.material_ids = {0, 0, 0, 0, 2, 2, 2, 2};
  return mesh;
}

TEST(glb, gives_back_vertices_normals_velocities_and_a_named_mesh_per_body) {
  const TemporaryFolder folder;
  const Mesh mesh = two_tetrahedra();
  write_mesh_glb(folder / "a.glb", mesh, k_bodies);
  const gltf::Model model = read_glb(folder / "a.glb");
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_EQ(model.nodes.at(0).name, "surface");
  EXPECT_EQ(model.nodes[0].children, (std::vector<int>{1, 2}));
  for (std::size_t part = 0; part < 2; ++part) {
    const MeshBody& body = k_bodies[2 * part];
    EXPECT_EQ(model.nodes.at(part + 1).mesh, static_cast<int>(part));
    EXPECT_EQ(model.nodes[part + 1].name, body.name);
    EXPECT_EQ(model.meshes[part].name, body.name);
    ASSERT_EQ(model.meshes[part].primitives.size(), 1u);
    const gltf::Primitive& primitive = model.meshes[part].primitives[0];
    EXPECT_EQ(primitive.mode, TINYGLTF_MODE_TRIANGLES);
    const auto half = [&](const std::vector<Vec3>& vectors) {
      const auto first = vectors.begin() + static_cast<std::ptrdiff_t>(4 * part);
      return std::vector<Vec3>(first, first + 4);
    };
    const std::vector<Vec3> vertices = half(mesh.vertices);
    EXPECT_EQ(numbers<Vec3>(model, primitive.attributes.at("POSITION")), vertices);
    EXPECT_EQ(numbers<Vec3>(model, primitive.attributes.at("NORMAL")), half(mesh.normals));
    EXPECT_EQ(numbers<Vec3>(model, primitive.attributes.at("_VELOCITY")), half(mesh.velocities));
    const auto corners = numbers<std::uint32_t>(model, primitive.indices);
    ASSERT_EQ(corners.size(), 12u);
    for (std::size_t k = 0; k < 12; ++k)
      EXPECT_EQ(corners[k] + 4 * part, mesh.triangles[4 * part + k / 3][k % 3]);
    const gltf::Material& material = model.materials.at(static_cast<std::size_t>(primitive.material));
    EXPECT_EQ(material.name, body.material);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(
          static_cast<float>(material.pbrMetallicRoughness.baseColorFactor.at(static_cast<std::size_t>(k))),
          body.appearance.color[k]);
    const gltf::Accessor& positions = accessor_of(model, primitive.attributes.at("POSITION"));
    Mesh points;
    points.vertices = vertices;
    const Aabb box = bounds(points);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(static_cast<float>(positions.minValues.at(static_cast<std::size_t>(k))), box.min[k]);
      EXPECT_EQ(static_cast<float>(positions.maxValues.at(static_cast<std::size_t>(k))), box.max[k]);
    }
  }
}

TEST(glb, bodies_share_a_material_of_one_name_and_look) {
  const TemporaryFolder folder;
  const Appearance red{{1, 0, 0}}, blue{{0, 0, 1}};
  const auto names = [&](const MeshBody& first, const MeshBody& last) {
    write_mesh_glb(folder / "a.glb", two_tetrahedra(), std::array{first, MeshBody{}, last});
    std::vector<std::string> found;
    for (const gltf::Material& material : read_glb(folder / "a.glb").materials)
      found.push_back(material.name);
    return found;
  };
  EXPECT_EQ(names({red, "a", "jelly"}, {red, "b", "jelly"}), (std::vector<std::string>{"jelly"}));
  EXPECT_EQ(names({red, "a", "jelly"}, {blue, "b", "jelly"}), (std::vector<std::string>{"jelly", "jelly_1"}));
  EXPECT_EQ(names({red}, {red}), (std::vector<std::string>{"material 0", "material 2"}));
}

TEST(glb, clay_is_rougher_than_jelly) {
  const TemporaryFolder folder;
  write_mesh_glb(folder / "a.glb", two_tetrahedra(), k_bodies);
  const gltf::Model model = read_glb(folder / "a.glb");
  ASSERT_EQ(model.materials.size(), 2u);
  EXPECT_EQ(model.materials[0].pbrMetallicRoughness.roughnessFactor, 0.5);
  EXPECT_GE(model.materials[1].pbrMetallicRoughness.roughnessFactor, 0.9);
  for (const gltf::Material& material : model.materials)
    EXPECT_EQ(material.pbrMetallicRoughness.metallicFactor, 0);
}

TEST(glb, a_triangle_is_of_the_body_of_most_of_its_corners) {
  const TemporaryFolder folder;
  struct Case {
    std::array<std::uint32_t, 3> corners;
    const char* body;
  };
  for (const Case& one :
       {Case{{0, 0, 2}, "left cube"}, Case{{0, 2, 0}, "left cube"}, Case{{0, 2, 2}, "Würfel \"2\""},
        Case{{2, 0, 2}, "Würfel \"2\""}, Case{{2, 1, 0}, "left cube"}, Case{{1, 2, 0}, "left cube"}}) {
    const Mesh triangle{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                        .triangles = {{0, 1, 2}},
                        .normals = {},
                        .velocities = {},
                        .material_ids = {one.corners.begin(), one.corners.end()}};
    write_mesh_glb(folder / "a.glb", triangle, k_bodies);
    const gltf::Model model = read_glb(folder / "a.glb");
    ASSERT_EQ(model.materials.size(), 1u);
    EXPECT_EQ(model.meshes.at(0).name, one.body);
  }
}

TEST(glb, a_bare_mesh_has_positions_only) {
  const TemporaryFolder folder;
  write_mesh_glb(folder / "a.glb", tetrahedron(), k_bodies);
  const gltf::Model model = read_glb(folder / "a.glb");
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 1u);
  EXPECT_EQ(model.meshes[0].primitives[0].attributes.size(), 1u);
}

TEST(glb, a_mesh_without_triangles_is_a_scene_without_a_mesh) {
  const TemporaryFolder folder;
  Mesh points = tetrahedron();
  points.triangles.clear();
  for (const Mesh& mesh : {Mesh{}, points}) {
    write_mesh_glb(folder / "a.glb", mesh, {});
    const gltf::Model model = read_glb(folder / "a.glb");
    EXPECT_TRUE(model.meshes.empty());
    EXPECT_TRUE(model.buffers.empty());
    EXPECT_EQ(model.scenes.size(), 1u);
  }
}

TEST(glb, what_gltf_cannot_say_is_refused_by_name) {
  const TemporaryFolder folder;
  const auto field = [&](const Mesh& mesh, std::span<const MeshBody> bodies) {
    try {
      write_mesh_glb(folder / "a.glb", mesh, bodies);
    } catch (const ConfigError& error) {
      return error.problems().at(0).field;
    }
    return std::string("nothing");
  };
  const Mesh mesh = two_tetrahedra();
  EXPECT_EQ(field(mesh, std::span(k_bodies).first(2)), "bodies");
  EXPECT_EQ(field(mesh, std::array{MeshBody{}, MeshBody{{{0, 2, 0}}}, MeshBody{}}),
            "bodies[1].appearance.color");
  // A byte of its own, a cut character, one longer than need be, a half of a pair, and one beyond the last.
  for (const char* name : {"\x80", "caf\xC3", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80"})
    EXPECT_EQ(field(mesh, std::array{MeshBody{}, MeshBody{}, MeshBody{{}, name}}), "bodies[2].name") << name;
  Mesh wrong = mesh;
  wrong.velocities.pop_back();
  EXPECT_EQ(field(wrong, k_bodies), "mesh.velocities");
  wrong = mesh;
  wrong.vertices[3].y() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(field(wrong, k_bodies), "mesh.vertices[3]");
  wrong = mesh;
  wrong.triangles[5][2] = 8;
  EXPECT_EQ(field(wrong, k_bodies), "mesh.triangles[5]");
  EXPECT_EQ(folder.entries(), 0u);
}

/// Three poses, half a second apart.
std::vector<MeshPose> poses_of(const Mesh& mesh) {
  std::vector<MeshPose> poses;
  for (int p = 0; p < 3; ++p) {
    MeshPose& pose = poses.emplace_back(MeshPose{0.5 * p, mesh.vertices, mesh.normals});
    for (std::size_t v = 0; v < pose.vertices.size(); ++v) {
      pose.vertices[v] += static_cast<float>(p) * Vec3(0.5f, static_cast<float>(v), -2);
      pose.normals[v] = p == 1 ? Vec3(0, 1, 0) : pose.normals[v];
    }
  }
  return poses;
}

TEST(glb, an_animation_shows_each_pose_at_its_time) {
  const TemporaryFolder folder;
  const Mesh mesh = two_tetrahedra();
  const std::vector<MeshPose> poses = poses_of(mesh);
  write_animation_glb(folder / "a.glb", mesh, poses, k_bodies);
  const gltf::Model model = read_glb(folder / "a.glb");
  ASSERT_EQ(model.animations.size(), 1u);
  const gltf::Animation& animation = model.animations[0];
  ASSERT_EQ(animation.samplers.size(), 1u);
  EXPECT_EQ(animation.samplers[0].interpolation, "LINEAR");
  const int input = animation.samplers[0].input, output = animation.samplers[0].output;
  EXPECT_EQ(numbers<float>(model, input), (std::vector<float>{0, 0.5f, 1}));
  EXPECT_EQ(accessor_of(model, input).minValues, std::vector<double>{0});
  EXPECT_EQ(accessor_of(model, input).maxValues, std::vector<double>{1});
  EXPECT_EQ(accessor_of(model, input).type, TINYGLTF_TYPE_SCALAR);
  const auto weights = numbers<float>(model, output);
  ASSERT_EQ(weights.size(), 6u) << "a weight for each target at each time";

  ASSERT_EQ(animation.channels.size(), 2u);
  ASSERT_EQ(model.meshes.size(), 2u);
  for (std::size_t part = 0; part < 2; ++part) {
    const gltf::AnimationChannel& channel = animation.channels[part];
    EXPECT_EQ(channel.target_path, "weights");
    EXPECT_EQ(channel.sampler, 0);
    const gltf::Node& node = model.nodes.at(static_cast<std::size_t>(channel.target_node));
    EXPECT_EQ(node.mesh, static_cast<int>(part));
    EXPECT_EQ(model.meshes[part].weights, std::vector<double>(2, 0.0));
    const gltf::Primitive& primitive = model.meshes[part].primitives.at(0);
    ASSERT_EQ(primitive.targets.size(), 2u);
    for (const auto& [attribute, column] :
         {std::pair{"POSITION", &MeshPose::vertices}, {"NORMAL", &MeshPose::normals}}) {
      const auto base = numbers<Vec3>(model, primitive.attributes.at(attribute));
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t v = 0; v < 4; ++v) {
          Vec3 shown = base.at(v);
          for (std::size_t t = 0; t < 2; ++t)
            shown += weights[2 * p + t] * numbers<Vec3>(model, primitive.targets[t].at(attribute)).at(v);
          EXPECT_LT((shown - (poses[p].*column)[4 * part + v]).norm(), 1e-5f) << attribute << ' ' << p;
        }
      }
    }
    for (const auto& target : primitive.targets) {
      const gltf::Accessor& positions = accessor_of(model, target.at("POSITION"));
      EXPECT_EQ(positions.count, 4u);
      EXPECT_EQ(positions.minValues.size(), 3u) << "readers need the box of every POSITION";
      EXPECT_EQ(positions.maxValues.size(), 3u);
    }
  }
}

TEST(glb, an_animation_of_one_pose_stands_still) {
  const TemporaryFolder folder;
  const Mesh mesh = two_tetrahedra();
  std::vector<MeshPose> poses = poses_of(mesh);
  poses.resize(1);
  write_animation_glb(folder / "a.glb", mesh, poses, k_bodies);
  EXPECT_TRUE(read_glb(folder / "a.glb").animations.empty());
}

TEST(glb, an_animation_needs_poses_of_the_mesh_in_the_order_of_time) {
  const TemporaryFolder folder;
  const Mesh mesh = two_tetrahedra();
  const auto refused = [&](std::vector<MeshPose> poses, const auto& change, const std::string& part) {
    change(poses);
    try {
      write_animation_glb(folder / "a.glb", mesh, poses, k_bodies);
      ADD_FAILURE() << part;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  const std::vector<MeshPose> poses = poses_of(mesh);
  refused(
      poses, [](auto& all) { all.clear(); }, "poses: there is none");
  refused(
      poses, [](auto& all) { all[2].time = 0.5; }, "poses[2].time");
  refused(
      poses, [](auto& all) { all[0].time = -1; }, "poses[0].time");
  refused(
      poses, [](auto& all) { all[1].vertices.pop_back(); }, "poses[1]: has 7 vertices");
  refused(
      poses, [](auto& all) { all[1].normals.clear(); }, "poses[1]: has 8 vertices and 0 normals");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.glb"));
}

TEST(glb, khronos_validator_finds_nothing_wrong) {
  const TemporaryFolder folder;
  const Mesh mesh = two_tetrahedra();
  write_mesh_glb(folder / "a.glb", mesh, k_bodies);
  write_animation_glb(folder / "b.glb", mesh, poses_of(mesh), k_bodies);
  for (const char* file : {"a.glb", "b.glb"}) {
    READ_WITH_GLTF_VALIDATOR(read, folder / file);
    EXPECT_EQ(read.at("errors"), 0) << file << read.at("messages");
    EXPECT_EQ(read.at("warnings"), 0) << file << read.at("messages");
  }
}

}  // namespace glb_test
}  // namespace mallow
