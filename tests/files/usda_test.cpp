#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>

#include "files/file_fixture.h"
#include "files/other_reader.h"

namespace mallow {
namespace usda_test {

const std::vector<Vec3> k_colors = {{0.8f, 0.24f, 0.09f}, {0, 1, 0.5f}, {0.1f, 0.2f, 0.3f}};
const std::vector<MeshBody> k_bodies = {{{k_colors[0]}, "cube", "jelly"},
                                        {{k_colors[1]}, "2 \"balls\"", "clay"},
                                        {{k_colors[2]}, "pool", "jelly"}};
/// Of one body, whose material is bound to the whole mesh.
const std::vector<MeshBody> k_body = {{{k_colors[0], Finish::clay}, "cube", "soft clay"}};
constexpr const char* k_mesh = "/surface/mesh";

Mesh triangle() {
  Mesh mesh;
  mesh.vertices = {{0, 0.1f, -2}, {1.0f / 3.0f, 1e10f, 1e-20f}, {7, 8, -0.5f}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Two triangles of bodies 2 and 0, with corners of both in one of them.
Mesh full_mesh() {
  Mesh mesh = tetrahedron();
  mesh.triangles = {{0, 2, 1}, {3, 1, 0}};
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {0.57735026f, 0.57735026f, 0.57735026f}, {0.6f, 0, -0.8f}};
  mesh.velocities = {{0, 0, -9.8f}, {1e-3f, 0, 0}, {2, 3, 16777217.0f}, {0, -1, 1e-40f}};
  mesh.material_ids = {0, 2, 2, 0};
  return mesh;
}

nlohmann::json numbers(const std::vector<Vec3>& vectors) {
  nlohmann::json list = nlohmann::json::array();
  for (const Vec3& v : vectors)
    for (const float x : v) list.push_back(x);
  return list;
}

bool has(const nlohmann::json& layer, const std::string& text) {
  return layer.get<std::string>().find(text) != std::string::npos;
}

/// The numbers of `name = [...]` in a layer as it was read and printed again.
std::vector<float> values_of(const nlohmann::json& layer, const std::string& name) {
  const auto& text = layer.get_ref<const std::string&>();
  const std::size_t begin = text.find(name + " = [");
  std::vector<float> values;
  if (begin == std::string::npos) return values;
  const char* at = text.data() + begin + name.size() + 4;
  while (*at != ']') {
    float value = 0;
    const auto [stop, error] = std::from_chars(at, text.data() + text.size(), value);
    if (error == std::errc{}) values.push_back(value);
    at = error == std::errc{} ? stop : at + 1;
  }
  return values;
}

void expect_values(const nlohmann::json& layer, const std::string& name, const std::vector<Vec3>& vectors) {
  const std::vector<float> values = values_of(layer, name);
  ASSERT_EQ(values.size(), 3 * vectors.size()) << name;
  // It prints nine digits, the last of them not always the nearest.
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_FLOAT_EQ(values[i], vectors[i / 3][static_cast<int>(i % 3)]) << name << ' ' << i;
}

TEST(usda, a_mesh_is_the_text_that_usd_expects) {
  const TemporaryFolder folder;
  Mesh mesh = triangle();
  mesh.velocities = {{0, 0, 0}, {1, 2, 3}, {0, 0, -9.8f}};
  write_mesh_usda(folder / "a.usda", mesh, k_body);
  EXPECT_EQ(content_of(folder / "a.usda"), R"(#usda 1.0
(
    defaultPrim = "surface"
    framesPerSecond = 30
    metersPerUnit = 1
    timeCodesPerSecond = 30
    upAxis = "Z"
)

def Xform "surface"
{
    def Mesh "mesh" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {
        uniform bool doubleSided = 0
        uniform token orientation = "rightHanded"
        uniform token subdivisionScheme = "none"
        float3[] extent = [(0, 0.1, -2), (7, 1e+10, 1e-20)]
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0.1, -2), (0.33333334, 1e+10, 1e-20), (7, 8, -0.5)]
        vector3f[] velocities = [(0, 0, 0), (1, 2, 3), (0, 0, -9.8)]
        color3f[] primvars:displayColor = [(0.8, 0.24, 0.09)] (
            interpolation = "constant"
        )
        rel material:binding = </surface/materials/soft_clay>
    }

    def Scope "materials"
    {
        def Material "soft_clay" (
            displayName = "soft clay"
        )
        {
            token outputs:surface.connect = </surface/materials/soft_clay/preview.outputs:surface>

            def Shader "preview"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (0.8, 0.24, 0.09)
                float inputs:roughness = 0.9
                token outputs:surface
            }
        }
    }
}
)");
}

/// Where a frame's values are samples at its time, of all that changes with its topology, and with y up.
TEST(usda, a_frame_of_several_bodies_is_the_text_that_usd_expects) {
  const TemporaryFolder folder;
  Mesh mesh = triangle();
  mesh.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  mesh.velocities = {{0, 0, 0}, {1, 2, 3}, {0, 0, -9.5f}};
  mesh.material_ids = {1, 1, 0};
  write_mesh_usda(folder / "a.usda", mesh, std::span(k_bodies).first(2),
                  {.up = UpAxis::y, .frames_per_second = 24, .speed = 2}, 12);
  const std::string text = content_of(folder / "a.usda");
  const std::string begin = R"(#usda 1.0
(
    defaultPrim = "surface"
    endTimeCode = 12
    framesPerSecond = 24
    metersPerUnit = 1
    startTimeCode = 12
    timeCodesPerSecond = 24
    upAxis = "Y"
)

def Xform "surface"
{
    def Mesh "mesh"
    {
        uniform bool doubleSided = 0
        uniform token orientation = "rightHanded"
        uniform token subdivisionScheme = "none"
        float3[] extent.timeSamples = {
            12: [(0, -2, -1e+10), (7, 1e-20, -0.1)],
        }
        int[] faceVertexCounts.timeSamples = {
            12: [3],
        }
        int[] faceVertexIndices.timeSamples = {
            12: [0, 1, 2],
        }
        point3f[] points.timeSamples = {
            12: [(0, -2, -0.1), (0.33333334, 1e-20, -1e+10), (7, -0.5, -8)],
        }
        normal3f[] normals (
            interpolation = "vertex"
        )
        normal3f[] normals.timeSamples = {
            12: [(0, 1, 0), (0, 0, -1), (1, 0, 0)],
        }
        vector3f[] velocities.timeSamples = {
            12: [(0, 0, 0), (2, 6, -4), (0, -19, 0)],
        }
        color3f[] primvars:displayColor (
            interpolation = "uniform"
        )
        color3f[] primvars:displayColor.timeSamples = {
            12: [(0, 1, 0.5)],
        }
        int[] primvars:group (
            interpolation = "uniform"
        )
        int[] primvars:group.timeSamples = {
            12: [1],
        }
        uniform token subsetFamily:materialBind:familyType = "partition"

        def GeomSubset "cube" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices.timeSamples = {
                12: [],
            }
            rel material:binding = </surface/materials/jelly>
        }

        def GeomSubset "_2__balls_" (
            prepend apiSchemas = ["MaterialBindingAPI"]
            displayName = "2 \"balls\""
        )
        {
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices.timeSamples = {
                12: [0],
            }
            rel material:binding = </surface/materials/clay>
        }
    }

    def Scope "materials"
    {
        def Material "jelly"
        {
)";
  EXPECT_EQ(text.substr(0, begin.size()), begin);
}

TEST(usda, a_series_is_one_mesh_with_the_files_of_its_frames_as_value_clips) {
  const TemporaryFolder folder;
  const std::vector<UsdFrame> frames = {{"s/a.usda", 0}, {"s/b.usda", 1}, {"s/c@.usda", 1000003}};
  write_usda_series(folder / "a.usda", frames, k_bodies, {.frames_per_second = 24});
  const std::string header = R"(#usda 1.0
(
    defaultPrim = "surface"
    endTimeCode = 1000003
    framesPerSecond = 24
    metersPerUnit = 1
    startTimeCode = 0
    timeCodesPerSecond = 24
    upAxis = "Z"
)

)";
  EXPECT_EQ(content_of(folder / "a.usda"), header + R"(def Xform "surface" (
    clips = {
        dictionary default = {
            double2[] active = [(0, 0), (1, 1), (1000003, 2)]
            asset[] assetPaths = [@./s/a.usda@, @./s/b.usda@, @@@./s/c@.usda@@@]
            asset manifestAssetPath = @./a.manifest.usda@
            string primPath = "/surface"
            double2[] times = [(0, 0), (1, 1), (1000003, 1000003)]
        }
    }
    prepend references = @./s/a.usda@
)
{
    def Mesh "mesh"
    {
    }
}
)");
  EXPECT_EQ(usda_manifest(folder / "a.usda"), folder / "a.manifest.usda");
  EXPECT_EQ(content_of(folder / "a.manifest.usda"), header + R"(def Xform "surface"
{
    def Mesh "mesh"
    {
        float3[] extent
        int[] faceVertexCounts
        int[] faceVertexIndices
        point3f[] points
        normal3f[] normals (
            interpolation = "vertex"
        )
        vector3f[] velocities
        color3f[] primvars:displayColor (
            interpolation = "uniform"
        )
        int[] primvars:group (
            interpolation = "uniform"
        )

        def GeomSubset "cube"
        {
            int[] indices
        }

        def GeomSubset "_2__balls_"
        {
            int[] indices
        }

        def GeomSubset "pool"
        {
            int[] indices
        }
    }
}
)");
}

/// The attributes of a text of USD that have samples, as `prim/type name`.
std::vector<std::string> attributes_of(const std::string& text, const std::string& ending) {
  std::vector<std::string> found;
  std::string prim;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const std::size_t def = line.find("def "); def != std::string::npos)
      prim = line.substr(def, line.rfind('"') - def);
    const std::size_t begin = line.find_first_not_of(' ');
    const std::size_t end = line.size() - std::min(line.size(), ending.size());
    if (line.find("[] ") != std::string::npos && line.substr(end) == ending)
      found.push_back(prim + '/' + line.substr(begin, end - begin));
  }
  return found;
}

/// A value clip gives what the manifest names and no more, and holds nothing from the clip before.
TEST(usda, a_manifest_names_what_has_samples_in_frames_of_a_full_mesh_and_of_nothing) {
  const TemporaryFolder folder;
  for (const std::vector<MeshBody>& bodies : {k_bodies, k_body}) {
    Mesh mesh = full_mesh();
    if (bodies.size() == 1) mesh.material_ids.clear();
    write_usda_series(folder / "a.usda", std::vector<UsdFrame>{{"s/a.usda", 0}}, bodies);
    std::string manifest = content_of(folder / "a.manifest.usda");
    for (std::size_t at = manifest.find(" (\n"); at != std::string::npos; at = manifest.find(" (\n", at))
      manifest.erase(at, 2);
    const std::vector<std::string> named = attributes_of(manifest, "");
    EXPECT_EQ(named.size(), bodies.size() == 1 ? 6u : 11u);
    for (const Mesh& frame : {mesh, Mesh{}}) {
      write_mesh_usda(folder / "b.usda", frame, bodies, {}, 0);
      EXPECT_EQ(attributes_of(content_of(folder / "b.usda"), ".timeSamples = {"), named);
    }
  }
}

/// Frames of other triangles each, one of nothing, played by a reader that knows value clips.
TEST(usda, a_series_plays_every_frame_with_all_that_changes) {
  const TemporaryFolder folder;
  for (const std::vector<MeshBody>& bodies : {k_bodies, k_body})
    for (const UpAxis up : {UpAxis::z, UpAxis::y}) {
      std::vector<Mesh> meshes = {full_mesh(), {}, full_mesh()};
      meshes[2].triangles.pop_back();
      meshes[2].vertices.emplace_back(5, 6, 7);
      meshes[2].normals.emplace_back(0, 1, 0);
      meshes[2].velocities.emplace_back(1, 2, 3);
      meshes[2].material_ids.push_back(0);
      const UsdOptions options{.up = up, .frames_per_second = 24, .speed = 2};
      std::filesystem::create_directories(folder / "s");
      std::vector<UsdFrame> frames;
      for (std::size_t f = 0; f < 3; ++f) {
        if (bodies.size() == 1) meshes[f].material_ids.clear();
        const int number = static_cast<int>(5 * f + 2);
        frames.push_back({"s/" + std::to_string(f) + ".usda", number});
        write_mesh_usda(folder / ("s/" + std::to_string(f) + ".usda"), meshes[f], bodies, options, number);
      }
      write_usda_series(folder / "a.usda", frames, bodies, options);
      const auto played = read_with("'" MALLOW_PYTHON "' '" MALLOW_PLAY_USDA "'", folder / "a.usda");
      ASSERT_TRUE(played.has_value()) << "tests need python3";
      ASSERT_FALSE(played->contains("error")) << played->at("error");
      const nlohmann::json& metadata = played->at("metadata");
      EXPECT_EQ(metadata.at("upAxis"), up == UpAxis::y ? "Y" : "Z");
      EXPECT_EQ(metadata.at("startTimeCode"), 2);
      EXPECT_EQ(metadata.at("endTimeCode"), 12);
      EXPECT_EQ(metadata.at("timeCodesPerSecond"), 24);
      EXPECT_EQ(metadata.at("metersPerUnit"), 1);
      EXPECT_EQ(played->at("bindings").size(), bodies.size());
      ASSERT_EQ(played->at("frames").size(), 3u);
      for (std::size_t f = 0; f < 3; ++f) {
        const nlohmann::json& shown = played->at("frames").at(std::to_string(frames[f].number)).at(k_mesh);
        const auto expect_vectors = [&](const char* name, const std::vector<Vec3>& vectors, float factor) {
          ASSERT_EQ(shown.at(name).size(), vectors.size()) << name;
          for (std::size_t v = 0; v < vectors.size(); ++v) {
            const Vec3 expected = up == UpAxis::y ? with_y_up(vectors[v]) : vectors[v];
            for (std::size_t k = 0; k < 3; ++k)
              EXPECT_EQ(shown.at(name)[v][k].get<float>(), factor * expected[static_cast<int>(k)]) << name;
          }
        };
        expect_vectors("points", meshes[f].vertices, 1);
        expect_vectors("normals", meshes[f].normals, 1);
        expect_vectors("velocities", meshes[f].velocities, 2);
        EXPECT_EQ(shown.at("faceVertexCounts").size(), meshes[f].triangles.size());
        for (std::size_t t = 0; t < meshes[f].triangles.size(); ++t) {
          for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(shown.at("faceVertexIndices")[3 * t + k], meshes[f].triangles[t][k]);
          if (bodies.size() == 1) continue;
          const std::size_t body = shown.at("primvars:group")[t];
          for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(shown.at("primvars:displayColor")[t][k].get<float>(),
                      k_colors[body][static_cast<int>(k)]);
        }
      }
    }
}

TEST(usda, tinyusdz_reads_the_mesh_that_was_written) {
  const TemporaryFolder folder;
  const Mesh mesh = full_mesh();
  write_mesh_usda(folder / "a.usda", mesh, k_bodies);
  READ_WITH_TINYUSDZ(read, folder / "a.usda");
  ASSERT_EQ(read.at("error"), "");
  ASSERT_EQ(read.at("meshes").size(), 1u);
  const nlohmann::json& found = read.at("meshes")[0];
  EXPECT_EQ(found.at("path"), k_mesh);
  EXPECT_EQ(found.at("points"), numbers(mesh.vertices));
  EXPECT_EQ(found.at("normals"), numbers(mesh.normals));
  EXPECT_EQ(found.at("counts"), (nlohmann::json{3, 3}));
  EXPECT_EQ(found.at("corners"), (nlohmann::json{0, 2, 1, 3, 1, 0}));

  const nlohmann::json& layer = read.at("layer");
  expect_values(layer, "vector3f[] velocities", mesh.velocities);
  expect_values(layer, "color3f[] primvars:displayColor", {k_colors[2], k_colors[0]});
  expect_values(layer, "float3[] extent", {bounds(mesh).min, bounds(mesh).max});
  EXPECT_EQ(values_of(layer, "int[] primvars:group"), (std::vector<float>{2, 0}));
  for (const char* line : {"metersPerUnit = 1\n", "upAxis = \"Z\"\n", "defaultPrim = \"surface\"\n",
                           "uniform token subdivisionScheme = \"none\"\n", "uniform bool doubleSided = 0\n",
                           "uniform token orientation = \"rightHanded\"\n"})
    EXPECT_TRUE(has(layer, line)) << line << layer;
}

/// It knows no value clips: what it shows of a series is the first frame, under the prim that the others
/// change.
TEST(usda, tinyusdz_finds_one_mesh_in_a_series_and_each_frame_by_itself) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "s");
  Mesh other = full_mesh();
  other.triangles.pop_back();
  const std::array<Mesh, 2> meshes = {full_mesh(), other};
  const UsdOptions options{.frames_per_second = 25, .speed = 0.5};
  write_mesh_usda(folder / "s/frame_000000.usda", meshes[0], k_bodies, options, 0);
  write_mesh_usda(folder / "s/frame_000001.usda", meshes[1], k_bodies, options, 1);
  write_usda_series(folder / "a.usda",
                    std::vector<UsdFrame>{{"s/frame_000000.usda", 0}, {"s/frame_000001.usda", 1}}, k_bodies,
                    options);
  const auto expect_mesh = [](const nlohmann::json& read, const Mesh& mesh) {
    ASSERT_EQ(read.at("error"), "");
    ASSERT_EQ(read.at("meshes").size(), 1u);
    const nlohmann::json& found = read.at("meshes")[0];
    EXPECT_EQ(found.at("path"), k_mesh);
    EXPECT_EQ(found.at("points"), numbers(mesh.vertices));
    EXPECT_EQ(found.at("normals"), numbers(mesh.normals));
    EXPECT_EQ(found.at("corners").size(), 3 * mesh.triangles.size());
  };
  READ_WITH_TINYUSDZ(read, folder / "a.usda");
  expect_mesh(read, meshes[0]);
  const nlohmann::json& root = read.at("root");
  for (const char* line :
       {"timeCodesPerSecond = 25\n", "framesPerSecond = 25\n", "startTimeCode = 0\n", "endTimeCode = 1\n",
        "upAxis = \"Z\"\n", "metersPerUnit = 1\n",
        "assetPaths = [@./s/frame_000000.usda@, @./s/frame_000001.usda@]\n",
        "asset manifestAssetPath = @./a.manifest.usda@\n", "string primPath = \"/surface\"\n"})
    EXPECT_TRUE(has(root, line)) << line << root;
  READ_WITH_TINYUSDZ(second, folder / "s/frame_000001.usda");
  expect_mesh(second, meshes[1]);
  for (const char* text :
       {"vector3f[] velocities.timeSamples = {\n            1: [(0, 0, -4.9), (0.0005, 0, 0), ",
        "color3f[] primvars:displayColor.timeSamples = {\n            1: [(0.1, 0.2, 0.3)],\n",
        "def Material \"jelly\"", "rel material:binding = </surface/materials/clay>"})
    EXPECT_TRUE(has(second.at("layer"), text)) << text << second.at("layer");
  READ_WITH_TINYUSDZ(manifest, folder / "a.manifest.usda");
  EXPECT_TRUE(has(manifest.at("root"), "def GeomSubset \"pool\"\n")) << manifest;
}

/// So that what it reads without complaint says something.
TEST(usda, tinyusdz_refuses_a_frame_with_a_broken_sample_and_a_mesh_with_a_wrong_corner) {
  const TemporaryFolder folder;
  const auto damaged = [&](const char* right, const char* wrong) {
    std::string text = content_of(folder / "a.usda");
    text.replace(text.find(right), std::string(right).size(), wrong);
    return folder.file("b.usda", text);
  };
  write_mesh_usda(folder / "a.usda", triangle(), k_body, {}, 7);
  READ_WITH_TINYUSDZ(no_value, damaged("7: [3]", "7: "));
  EXPECT_NE(no_value.at("error"), "");
  READ_WITH_TINYUSDZ(no_time, damaged("7: [3]", "seven: [3]"));
  EXPECT_NE(no_time.at("error"), "");
  write_mesh_usda(folder / "a.usda", triangle(), k_body);
  READ_WITH_TINYUSDZ(wrong_corner, damaged("[0, 1, 2]", "[0, 1, 3]"));
  EXPECT_NE(wrong_corner.at("error"), "");
}

TEST(usda, tinyusdz_reads_a_bare_mesh_and_one_of_nothing) {
  const TemporaryFolder folder;
  write_mesh_usda(folder / "bare.usda", tetrahedron(), k_body);
  READ_WITH_TINYUSDZ(bare, folder / "bare.usda");
  EXPECT_EQ(bare.at("error"), "");
  expect_values(bare.at("layer"), "color3f[] primvars:displayColor", {k_colors[0]});
  EXPECT_FALSE(has(bare.at("layer"), "normals") || has(bare.at("layer"), "velocities"));
  write_mesh_usda(folder / "none.usda", Mesh{}, {});
  READ_WITH_TINYUSDZ(none, folder / "none.usda");
  // A layer that it reads; only of its scenes for drawing it asks that meshes have points.
  EXPECT_TRUE(has(none.at("layer"), "point3f[] points = []")) << none;
}

TEST(usda, what_usd_cannot_say_is_refused_by_name) {
  const TemporaryFolder folder;
  const auto field = [&](const auto& write) {
    try {
      write();
    } catch (const ConfigError& error) {
      return error.problems().at(0).field;
    }
    return std::string("nothing");
  };
  const auto mesh_field = [&](const Mesh& mesh, std::span<const MeshBody> bodies,
                              const UsdOptions& options = {}, std::optional<int> frame = {}) {
    return field([&] { write_mesh_usda(folder / "a.usda", mesh, bodies, options, frame); });
  };
  EXPECT_EQ(mesh_field(full_mesh(), std::span(k_bodies).first(2)), "bodies");
  EXPECT_EQ(mesh_field(triangle(), {}), "bodies");
  EXPECT_EQ(mesh_field(triangle(), std::array{MeshBody{{{0, 2, 0}}}}), "bodies[0].appearance.color");
  EXPECT_EQ(mesh_field(triangle(), k_body, {}, -1), "frame");
  EXPECT_EQ(mesh_field(triangle(), k_body, {.speed = 0}), "options.speed");
  Mesh wrong = full_mesh();
  wrong.velocities.pop_back();
  EXPECT_EQ(mesh_field(wrong, k_bodies), "mesh.velocities");
  wrong = full_mesh();
  wrong.normals[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mesh_field(wrong, k_bodies), "mesh.normals[2]");

  const auto series_field = [&](const std::vector<UsdFrame>& frames, const UsdOptions& options) {
    return field([&] { write_usda_series(folder / "a.usda", frames, k_bodies, options); });
  };
  EXPECT_EQ(series_field({{"a.usda", 1}, {"b.usda", 1}}, {}), "frames[1].number");
  EXPECT_EQ(series_field({{"a.usda", -1}}, {}), "frames[0].number");
  EXPECT_EQ(series_field({}, {.frames_per_second = std::numeric_limits<double>::infinity()}),
            "options.frames_per_second");
  for (const char* name : {"a@@@.usda", "a\n.usda"}) {
    EXPECT_THROW(write_usda_series(folder / "a.usda", std::vector<UsdFrame>{{name, 0}}, k_bodies), IoError);
  }
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace usda_test
}  // namespace mallow
