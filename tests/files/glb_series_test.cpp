#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "files/file_fixture.h"
#include "files/other_reader.h"
#include "files/tiny_gltf.h"
#ifdef MALLOW_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace mallow {
namespace glb_series_test {

using Json = nlohmann::json;

const std::vector<MeshBody> k_bodies = {{{{0.8f, 0.24f, 0.09f}}, "left", "paste"},
                                        {{{0.1f, 0.2f, 0.3f}, Finish::clay}, "right", "clay"}};

/// A sphere of rings around a place, with normals.
void append_ball(Mesh& mesh, const Vec3& center, float radius, int rings, std::uint32_t body) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto n = static_cast<std::uint32_t>(rings);
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j < 2 * n; ++j) {
      const float polar = 3.14159265f * static_cast<float>(i) / static_cast<float>(n);
      const float turn = 3.14159265f * static_cast<float>(j) / static_cast<float>(n);
      const Vec3 normal(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      mesh.vertices.emplace_back(center + radius * normal);
      mesh.normals.push_back(normal);
      mesh.material_ids.push_back(body);
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < 2 * n; ++j) {
      const std::uint32_t a = first + i * 2 * n + j, b = first + i * 2 * n + (j + 1) % (2 * n);
      mesh.triangles.push_back({a, a + 2 * n, b + 2 * n});
      mesh.triangles.push_back({a, b + 2 * n, b});
    }
}

/// Other vertices in each: a ball that stays, and from frame 1 on one that flies off.
std::vector<Mesh> three_frames() {
  std::vector<Mesh> frames(3);
  for (int f = 0; f < 3; ++f) {
    Mesh& mesh = frames[static_cast<std::size_t>(f)];
    append_ball(mesh, {1.0f / 3, 2, 1}, 1, 20, 0);
    if (f > 0) append_ball(mesh, {3.0f + static_cast<float>(f) / 7, 2, 1}, 0.5f, 5 + f, 1);
  }
  return frames;
}

void write_series(const std::filesystem::path& file, std::span<const Mesh> frames, GlbPacking packing) {
  GlbSeries series(k_bodies, packing);
  for (std::size_t f = 0; f < frames.size(); ++f) series.add(frames[f], 0.25 * static_cast<double>(f));
  EXPECT_EQ(series.frames(), frames.size());
  std::move(series).write(file);
}

/// A file, read with nothing of the writer's.
class Glb {
 public:
  explicit Glb(const std::filesystem::path& file) {
    const std::string whole = content_of(file);
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, whole.substr(at, 4).data(), 4);
      return value;
    };
    EXPECT_EQ(word(8), whole.size());
    const std::size_t length = word(12);
    json = Json::parse(whole.substr(20, length));
    if (whole.size() > 20 + length) bytes_ = whole.substr(28 + length, word(20 + length));
  }

  /// The numbers of an accessor, as they are in the file. width: of one row.
  template <class T>
  std::vector<T> numbers(std::size_t accessor, std::size_t width) const {
    const Json& found = json.at("accessors").at(accessor);
    const Json& view = json.at("bufferViews").at(found.at("bufferView").get<std::size_t>());
    const std::string column = column_of(view);
    const std::size_t stride = view.value("byteStride", width * sizeof(T)),
                      begin = found.value("byteOffset", 0u);
    std::vector<T> values(found.at("count").get<std::size_t>() * width);
    for (std::size_t row = 0; row < values.size() / width; ++row)
      std::memcpy(values.data() + row * width, column.substr(begin + row * stride, width * sizeof(T)).data(),
                  width * sizeof(T));
    return values;
  }

  /// The node of a frame's body, or null.
  Json body_node(const std::string& frame, const std::string& name) const {
    for (const Json& node : json.at("nodes")) {
      if (node.at("name") != frame) continue;
      for (const std::size_t child : node.at("children"))
        if (json["nodes"][child]["name"] == name) return json["nodes"][child];
    }
    return {};
  }

  /// What a node shows, with normals as in the file.
  Mesh mesh_of(const Json& node) const {
    const Json& primitive = json.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
    Mesh mesh;
    const auto places = numbers<std::int16_t>(primitive.at("attributes").at("POSITION"), 3);
    const auto normals = numbers<std::int8_t>(primitive.at("attributes").at("NORMAL"), 3);
    for (std::size_t v = 0; v < places.size() / 3; ++v) {
      Vec3 place, normal;
      for (std::size_t k = 0; k < 3; ++k) {
        place[static_cast<int>(k)] =
            node.at("translation")[k].get<float>() + node.at("scale")[k].get<float>() * places[3 * v + k];
        normal[static_cast<int>(k)] = static_cast<float>(normals[3 * v + k]) / 127;
      }
      mesh.vertices.push_back(place);
      mesh.normals.push_back(normal);
    }
    const std::size_t indices = primitive.at("indices");
    const auto add_corners = [&](const auto& corners) {
      for (std::size_t t = 0; t + 2 < corners.size(); t += 3)
        mesh.triangles.push_back({corners[t], corners[t + 1], corners[t + 2]});
    };
    if (json.at("accessors").at(indices).at("componentType") == 5123)
      add_corners(numbers<std::uint16_t>(indices, 1));
    else
      add_corners(numbers<std::uint32_t>(indices, 1));
    return mesh;
  }

  Json json;

 private:
  std::string column_of(const Json& view) const {
    const auto part = [&](const Json& where) {
      return bytes_.substr(where.value("byteOffset", 0u), where.at("byteLength"));
    };
    if (!view.contains("extensions")) return part(view);
#ifdef MALLOW_MESHOPTIMIZER
    const Json& packed = view.at("extensions").at("EXT_meshopt_compression");
    const std::string content = part(packed);
    const auto* source = reinterpret_cast<const unsigned char*>(content.data());
    const std::size_t count = packed.at("count"), stride = packed.at("byteStride");
    std::string column(count * stride, '\0');
    EXPECT_EQ(column.size(), view.at("byteLength"));
    if (packed.at("mode") == "TRIANGLES") {
      EXPECT_EQ(source[0], 0xe1) << "the extension's version";
      EXPECT_EQ(meshopt_decodeIndexBuffer(column.data(), count, stride, source, content.size()), 0);
    } else {
      EXPECT_EQ(source[0], 0xa0) << "the extension's version";
      EXPECT_EQ(meshopt_decodeVertexBuffer(column.data(), count, stride, source, content.size()), 0);
      if (packed.value("filter", "") == "OCTAHEDRAL") meshopt_decodeFilterOct(column.data(), count, stride);
    }
    return column;
#else
    ADD_FAILURE() << "no meshoptimizer";
    return {};
#endif
  }

  std::string bytes_;
};

/// Corners of triangles in an order that does not depend on that of vertices and triangles.
std::multiset<std::string> triangles_of(const Mesh& mesh, float scale) {
  std::multiset<std::string> all;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::string, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      for (const float x : mesh.vertices.at(triangle[k]))
        corners[k] += std::to_string(std::lround(x / scale)) + ' ';
    const auto& [a, b, c] = corners;
    all.insert(std::min({a + b + c, b + c + a, c + a + b}));
  }
  return all;
}

Mesh part_of_body(const Mesh& mesh, std::uint32_t body) {
  Mesh part = mesh;
  std::erase_if(part.triangles, [&](const auto& t) { return mesh.material_ids[t[0]] != body; });
  return part;
}

class glb_series : public testing::TestWithParam<GlbPacking> {
 protected:
  void SetUp() override {
    if (GetParam() == GlbPacking::meshopt && !can_compress_glb())
      GTEST_SKIP() << "SKIPPED: built without meshoptimizer; tools/setup installs it";
  }
};

TEST_P(glb_series, every_frame_has_its_bodies_triangles_on_a_fine_grid) {
  const TemporaryFolder folder;
  const std::vector<Mesh> frames = three_frames();
  write_series(folder / "a.glb", frames, GetParam());
  const Glb glb(folder / "a.glb");
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::uint32_t body = 0; body < (f == 0 ? 1 : 2); ++body) {
      const Json node = glb.body_node("frame " + std::to_string(f), k_bodies[body].name);
      ASSERT_TRUE(node.is_object()) << f << ' ' << body;
      const auto scale = node.at("scale")[0].get<float>();
      EXPECT_LT(scale, 1e-3f);
      const Mesh expected = part_of_body(frames[f], body), found = glb.mesh_of(node);
      EXPECT_TRUE(triangles_of(found, scale) == triangles_of(expected, scale)) << f << ' ' << body;
      for (std::size_t v = 0; v < found.vertices.size(); ++v) {
        // The ball's own normal at that place, as vertices stand in another order.
        const Vec3 center = body == 0 ? Vec3(1.0f / 3, 2, 1) : Vec3(3.0f + static_cast<float>(f) / 7, 2, 1);
        const Vec3 normal = (found.vertices[v] - center).normalized();
        EXPECT_GT(found.normals[v].normalized().dot(normal), std::cos(1.3f * 3.1416f / 180));
      }
      const Json& primitive = glb.json.at("meshes").at(node.at("mesh").get<std::size_t>())["primitives"][0];
      const Json& material = glb.json.at("materials").at(primitive.at("material").get<std::size_t>());
      EXPECT_EQ(material.at("name"), k_bodies[body].material);
      EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][1].get<float>(),
                k_bodies[body].appearance.color[1]);
    }
  }
  EXPECT_TRUE(glb.body_node("frame 0", "right").is_null());
}

TEST_P(glb_series, shows_one_frame_at_a_time_each_until_the_next) {
  const TemporaryFolder folder;
  write_series(folder / "a.glb", three_frames(), GetParam());
  const Glb glb(folder / "a.glb");
  const Json& animation = glb.json.at("animations").at(0);
  ASSERT_EQ(animation.at("channels").size(), 3u);
  for (const auto& [time, shown] : std::vector<std::pair<float, std::string>>{
           {0.0f, "frame 0"}, {0.2f, "frame 0"}, {0.25f, "frame 1"}, {0.5f, "frame 2"}, {0.75f, "frame 2"}}) {
    for (const Json& channel : animation["channels"]) {
      EXPECT_EQ(channel.at("target").at("path"), "scale");
      const Json& node = glb.json["nodes"].at(channel["target"]["node"].get<std::size_t>());
      const Json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
      EXPECT_EQ(sampler.at("interpolation"), "STEP");
      const auto keys = glb.numbers<float>(sampler.at("input"), 1);
      const auto scales = glb.numbers<float>(sampler.at("output"), 3);
      ASSERT_EQ(scales.size(), 3 * keys.size());
      EXPECT_EQ(keys.front(), 0);
      std::size_t key = 0;
      while (key + 1 < keys.size() && keys[key + 1] <= time) ++key;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(scales[3 * key + k], node.at("name") == shown ? 1 : 0) << time << ' ' << node["name"];
      // What programs show that play nothing.
      EXPECT_EQ(node.at("scale")[0], node["name"] == "frame 0" ? 1 : 0);
    }
  }
}

TEST_P(glb_series, what_rests_stays_at_the_same_place_while_the_frames_box_grows) {
  const TemporaryFolder folder;
  write_series(folder / "a.glb", three_frames(), GetParam());
  const Glb glb(folder / "a.glb");
  const Mesh before = glb.mesh_of(glb.body_node("frame 1", "left"));
  EXPECT_EQ(glb.mesh_of(glb.body_node("frame 2", "left")).vertices, before.vertices);
}

TEST_P(glb_series, frames_without_triangles_show_nothing) {
  const TemporaryFolder folder;
  std::vector<Mesh> frames = three_frames();
  frames[1] = {};
  write_series(folder / "a.glb", frames, GetParam());
  const Glb glb(folder / "a.glb");
  const Json& animation = glb.json.at("animations").at(0);
  ASSERT_EQ(animation.at("channels").size(), 2u);
  const auto keys = glb.numbers<float>(animation["samplers"][0].at("input"), 1);
  EXPECT_EQ(keys, (std::vector<float>{0, 0.25f}));
  write_series(folder / "b.glb", std::vector<Mesh>(2), GetParam());
  EXPECT_FALSE(Glb(folder / "b.glb").json.contains("meshes"));
}

TEST_P(glb_series, khronos_validator_finds_nothing_wrong) {
  const TemporaryFolder folder;
  write_series(folder / "a.glb", three_frames(), GetParam());
  READ_WITH_GLTF_VALIDATOR(read, folder / "a.glb");
  EXPECT_EQ(read.at("errors"), 0) << read.at("messages");
  EXPECT_EQ(read.at("warnings"), 0) << read.at("messages");
  EXPECT_EQ(read.at("info").at("animationCount"), 1);
}

TEST_P(glb_series, many_vertices_are_numbered_in_32_bits) {
  const TemporaryFolder folder;
  Mesh mesh;
  append_ball(mesh, {0, 0, 0}, 1, 190, 1);
  ASSERT_GT(mesh.vertices.size(), 65536u);
  write_series(folder / "a.glb", std::array{mesh}, GetParam());
  const Glb glb(folder / "a.glb");
  EXPECT_FALSE(glb.json.contains("animations"));
  const Json node = glb.body_node("frame 0", "right");
  const auto scale = node.at("scale")[0].get<float>();
  EXPECT_TRUE(triangles_of(glb.mesh_of(node), scale) == triangles_of(mesh, scale));
}

INSTANTIATE_TEST_SUITE_P(, glb_series, testing::Values(GlbPacking::quantized, GlbPacking::meshopt),
                         [](const auto& tested) {
                           return tested.param == GlbPacking::meshopt ? "meshopt" : "quantized";
                         });

TEST(glb_series_of_all_builds, tinygltf_reads_what_is_quantized) {
  const TemporaryFolder folder;
  write_series(folder / "a.glb", three_frames(), GlbPacking::quantized);
  mallow_tinygltf::Model model;
  std::string errors, warnings;
  mallow_tinygltf::TinyGLTF reader;
  EXPECT_TRUE(reader.LoadBinaryFromFile(&model, &errors, &warnings, (folder / "a.glb").string()));
  EXPECT_EQ(errors + warnings, "");
  EXPECT_EQ(model.meshes.size(), 5u);
  EXPECT_EQ(model.materials.size(), 2u);
}

TEST(glb_series_of_all_builds, meshopt_takes_a_third_of_the_size) {
  if (!can_compress_glb()) GTEST_SKIP() << "SKIPPED: built without meshoptimizer; tools/setup installs it";
  const TemporaryFolder folder;
  Mesh mesh;
  append_ball(mesh, {0, 0, 0}, 1, 100, 0);
  write_series(folder / "a.glb", std::array{mesh}, GlbPacking::quantized);
  write_series(folder / "b.glb", std::array{mesh}, GlbPacking::meshopt);
  EXPECT_LT(3 * std::filesystem::file_size(folder / "b.glb"), std::filesystem::file_size(folder / "a.glb"));
}

TEST(glb_series_of_all_builds, misuse_is_refused_by_name_and_adds_nothing) {
  const TemporaryFolder folder;
  GlbSeries series(k_bodies);
  const std::vector<Mesh> frames = three_frames();
  series.add(frames[0], 1);
  const auto field = [&](const Mesh& mesh, double time) {
    try {
      series.add(mesh, time);
    } catch (const ConfigError& error) {
      return error.problems().at(0).field;
    }
    return std::string("nothing");
  };
  for (const double time : {1.0, 0.5, -1.0, std::nan(""), std::nextafter(1.0, 2.0)})
    EXPECT_EQ(field(frames[1], time), "time") << time;
  Mesh wrong = frames[1];
  wrong.vertices[2].z() = INFINITY;
  EXPECT_EQ(field(wrong, 2), "mesh.vertices[2]");
  wrong = frames[1];
  wrong.triangles[3][1] = 1'000'000;
  EXPECT_EQ(field(wrong, 2), "mesh.triangles[3]");
  wrong = frames[1];
  wrong.material_ids.assign(wrong.vertices.size(), 2);
  EXPECT_EQ(field(wrong, 2), "bodies");
  EXPECT_EQ(series.frames(), 1u);
  if (!can_compress_glb()) {
    EXPECT_THROW(GlbSeries(k_bodies, GlbPacking::meshopt), ConfigError);
  }
  EXPECT_THROW(std::move(series).write(folder / "none" / "a.glb"), IoError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(glb_series_of_all_builds, places_of_any_size_and_distance_fit_the_grid) {
  const TemporaryFolder folder;
  for (const float size : {1e-20f, 1e-6f, 1.0f, 1e20f})
    for (const float far : {0.0f, 1e-3f, 1e3f}) {
      Mesh mesh = tetrahedron();
      mesh.normals.assign(4, Vec3(0, 0, 1));
      for (Vec3& vertex : mesh.vertices) vertex = size * vertex + Vec3::Constant(far * size);
      write_series(folder / "a.glb", std::array{mesh}, GlbPacking::quantized);
      const Glb glb(folder / "a.glb");
      const Json node = glb.body_node("frame 0", "left");
      const auto step = node.at("scale")[0].get<float>();
      const Mesh found = glb.mesh_of(node);
      for (std::size_t v = 0; v < 4; ++v)
        EXPECT_LE((found.vertices[v] - mesh.vertices[v]).lpNorm<Eigen::Infinity>(),
                  0.51f * step + 1e-6f * mesh.vertices[v].lpNorm<Eigen::Infinity>())
            << size << ' ' << far;
    }
}

}  // namespace glb_series_test
}  // namespace mallow
