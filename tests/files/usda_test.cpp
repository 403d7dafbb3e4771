#include <charconv>
#include <limits>

#include "files/file_fixture.h"
#include "files/other_reader.h"

namespace mallow {
namespace {

const std::vector<Vec3> k_colors = {{0.8f, 0.24f, 0.09f}, {0, 1, 0.5f}, {0.1f, 0.2f, 0.3f}};
const std::vector<Appearance> k_palette = {{k_colors[0]}, {k_colors[1]}, {k_colors[2]}};

Mesh triangle() {
  Mesh mesh;
  mesh.vertices = {{0, 0.1f, -2}, {1.0f / 3.0f, 1e10f, 1e-20f}, {7, 8, -0.5f}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Two triangles of groups 2 and 0, with corners of both in one of them.
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
  mesh.material_ids = {1, 1, 0};
  write_mesh_usda(folder / "a.usda", mesh, k_palette);
  EXPECT_EQ(content_of(folder / "a.usda"), R"(#usda 1.0
(
    defaultPrim = "surface"
    metersPerUnit = 1
    upAxis = "Z"
)

def Mesh "surface"
{
    uniform bool doubleSided = 0
    uniform token orientation = "rightHanded"
    uniform token subdivisionScheme = "none"
    float3[] extent = [(0, 0.1, -2), (7, 1e+10, 1e-20)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0.1, -2), (0.33333334, 1e+10, 1e-20), (7, 8, -0.5)]
    vector3f[] velocities = [(0, 0, 0), (1, 2, 3), (0, 0, -9.8)]
    color3f[] primvars:displayColor = [(0.8, 0.24, 0.09), (0, 1, 0.5), (0.1, 0.2, 0.3)] (
        interpolation = "uniform"
    )
    int[] primvars:displayColor:indices = [1]
    int[] primvars:group = [1] (
        interpolation = "uniform"
    )
}
)");
}

TEST(usda, a_series_shows_each_frame_until_the_next) {
  const TemporaryFolder folder;
  const std::vector<UsdFrame> frames = {{"s/a.usda", 0}, {"s/b.usda", 1}, {"s/c@.usda", 1000003}};
  write_usda_series(folder / "a.usda", frames, {.time_codes_per_second = 0.1, .frames_per_second = 24});
  EXPECT_EQ(content_of(folder / "a.usda"), R"(#usda 1.0
(
    defaultPrim = "surface"
    endTimeCode = 1000003
    startTimeCode = 0
    framesPerSecond = 24
    timeCodesPerSecond = 0.1
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "surface"
{
    def "frame_000000" (
        prepend references = @./s/a.usda@
    )
    {
        token visibility.timeSamples = {
            0: "inherited",
            1: "invisible",
        }
    }
    def "frame_000001" (
        prepend references = @./s/b.usda@
    )
    {
        token visibility = "invisible"
        token visibility.timeSamples = {
            0: "invisible",
            1: "inherited",
            1000003: "invisible",
        }
    }
    def "frame_1000003" (
        prepend references = @@@./s/c@.usda@@@
    )
    {
        token visibility = "invisible"
        token visibility.timeSamples = {
            0: "invisible",
            1000003: "inherited",
        }
    }
}
)");
}

TEST(usda, tinyusdz_reads_the_mesh_that_was_written) {
  const TemporaryFolder folder;
  const Mesh mesh = full_mesh();
  write_mesh_usda(folder / "a.usda", mesh, k_palette);
  READ_WITH_TINYUSDZ(read, folder / "a.usda");
  ASSERT_EQ(read.at("error"), "");
  ASSERT_EQ(read.at("meshes").size(), 1u);
  const nlohmann::json& found = read.at("meshes")[0];
  EXPECT_EQ(found.at("path"), "/surface");
  EXPECT_EQ(found.at("points"), numbers(mesh.vertices));
  EXPECT_EQ(found.at("normals"), numbers(mesh.normals));
  EXPECT_EQ(found.at("counts"), (nlohmann::json{3, 3}));
  EXPECT_EQ(found.at("corners"), (nlohmann::json{0, 2, 1, 3, 1, 0}));

  const nlohmann::json& layer = read.at("layer");
  expect_values(layer, "vector3f[] velocities", mesh.velocities);
  expect_values(layer, "color3f[] primvars:displayColor", k_colors);
  expect_values(layer, "float3[] extent", {bounds(mesh).min, bounds(mesh).max});
  EXPECT_EQ(values_of(layer, "int[] primvars:displayColor:indices"), (std::vector<float>{2, 0}));
  EXPECT_EQ(values_of(layer, "int[] primvars:group"), (std::vector<float>{2, 0}));
  for (const char* line : {"metersPerUnit = 1\n", "upAxis = \"Z\"\n", "defaultPrim = \"surface\"\n",
                           "uniform token subdivisionScheme = \"none\"\n", "uniform bool doubleSided = 0\n",
                           "uniform token orientation = \"rightHanded\"\n"})
    EXPECT_TRUE(has(layer, line)) << line << layer;
}

TEST(usda, tinyusdz_plays_the_frames_of_a_series) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "s");
  const std::array<Mesh, 2> meshes = {triangle(), full_mesh()};
  write_mesh_usda(folder / "s/frame_000000.usda", meshes[0], k_palette);
  write_mesh_usda(folder / "s/frame_000001.usda", meshes[1], k_palette);
  write_usda_series(folder / "a.usda",
                    std::vector<UsdFrame>{{"s/frame_000000.usda", 0}, {"s/frame_000001.usda", 1}},
                    {.time_codes_per_second = 6.5, .frames_per_second = 25});
  READ_WITH_TINYUSDZ(read, folder / "a.usda");
  ASSERT_EQ(read.at("error"), "");
  ASSERT_EQ(read.at("meshes").size(), 2u);
  for (std::size_t f = 0; f < 2; ++f) {
    const nlohmann::json& found = read.at("meshes")[f];
    EXPECT_EQ(found.at("path"), "/surface/frame_00000" + std::to_string(f));
    EXPECT_EQ(found.at("points"), numbers(meshes[f].vertices));
    EXPECT_EQ(found.at("corners").size(), 3 * meshes[f].triangles.size());
  }
  const nlohmann::json& root = read.at("root");
  for (const char* line : {"timeCodesPerSecond = 6.5\n", "framesPerSecond = 25\n", "startTimeCode = 0\n",
                           "endTimeCode = 1\n", "upAxis = \"Z\"\n", "metersPerUnit = 1\n"})
    EXPECT_TRUE(has(root, line)) << line << root;
  // The samples stay with the mesh once the references are part of the layer.
  const std::string& layer = read.at("layer").get_ref<const std::string&>();
  const std::size_t second = layer.find("def Mesh \"frame_000001\"");
  ASSERT_LT(second, layer.size());
  EXPECT_TRUE(
      has(layer.substr(0, second),
          "visibility.timeSamples = {\n            0: \"inherited\",\n            1: \"invisible\",\n"))
      << layer;
  EXPECT_TRUE(
      has(layer.substr(second),
          "visibility.timeSamples = {\n            0: \"invisible\",\n            1: \"inherited\",\n"))
      << layer;
  EXPECT_TRUE(has(layer.substr(second), "token visibility = \"invisible\"\n")) << layer;
}

/// So that what it reads without complaint says something.
TEST(usda, tinyusdz_refuses_a_series_with_a_broken_sample_and_a_mesh_with_a_wrong_corner) {
  const TemporaryFolder folder;
  const auto damaged = [&](const char* right, const char* wrong) {
    std::string text = content_of(folder / "a.usda");
    text.replace(text.find(right), std::string(right).size(), wrong);
    return folder.file("b.usda", text);
  };
  write_usda_series(folder / "a.usda", std::vector<UsdFrame>{{"s/a.usda", 0}, {"s/b.usda", 1}}, {});
  READ_WITH_TINYUSDZ(no_value, damaged("1: \"invisible\"", "1: "));
  EXPECT_NE(no_value.at("error"), "");
  READ_WITH_TINYUSDZ(no_time, damaged("1: \"invisible\"", "one: \"invisible\""));
  EXPECT_NE(no_time.at("error"), "");
  write_mesh_usda(folder / "a.usda", triangle(), k_palette);
  READ_WITH_TINYUSDZ(wrong_corner, damaged("[0, 1, 2]", "[0, 1, 3]"));
  EXPECT_NE(wrong_corner.at("error"), "");
}

TEST(usda, tinyusdz_reads_a_bare_mesh_and_one_of_nothing) {
  const TemporaryFolder folder;
  write_mesh_usda(folder / "bare.usda", tetrahedron(), std::span(k_palette).first(1));
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
  const auto mesh_field = [&](const Mesh& mesh, std::span<const Appearance> palette) {
    return field([&] { write_mesh_usda(folder / "a.usda", mesh, palette); });
  };
  EXPECT_EQ(mesh_field(full_mesh(), std::span(k_palette).first(2)), "palette");
  EXPECT_EQ(mesh_field(triangle(), {}), "palette");
  EXPECT_EQ(mesh_field(triangle(), std::array{Appearance{{0, 2, 0}}}), "palette[0].color");
  Mesh wrong = full_mesh();
  wrong.velocities.pop_back();
  EXPECT_EQ(mesh_field(wrong, k_palette), "mesh.velocities");
  wrong = full_mesh();
  wrong.normals[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mesh_field(wrong, k_palette), "mesh.normals[2]");

  const auto series_field = [&](const std::vector<UsdFrame>& frames, const UsdTimeline& timeline) {
    return field([&] { write_usda_series(folder / "a.usda", frames, timeline); });
  };
  EXPECT_EQ(series_field({{"a.usda", 1}, {"b.usda", 1}}, {}), "frames[1].number");
  EXPECT_EQ(series_field({{"a.usda", -1}}, {}), "frames[0].number");
  EXPECT_EQ(series_field({}, {.time_codes_per_second = 0}), "timeline.time_codes_per_second");
  EXPECT_EQ(series_field({}, {.frames_per_second = std::numeric_limits<double>::infinity()}),
            "timeline.frames_per_second");
  EXPECT_THROW(write_usda_series(folder / "a.usda", std::vector<UsdFrame>{{"a@@@.usda", 0}}, {}), IoError);
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace mallow
