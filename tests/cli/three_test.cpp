// What `mallow export` writes of all frames, as three.js plays it: tests/files/read_with_three.mjs.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/program.h"
#include "files/other_reader.h"
#include "mallow/files.h"
#include "program/frame_surface.h"

namespace mallow::test {
namespace three_test {

using nlohmann::json;

/// Two bodies with skins and one without fall on a floor. three.js drops what is between names of tracks, so
/// that the first two have one name there.
constexpr const char* k_scene = R"([solver]
time_step = 0.15
support_radius = 2.1
[[material]]
name = "jelly"
alpha = 0.2
[[material]]
name = "clay"
alpha = 0.5
color = [0.25, 0.5, 0.125]
finish = "clay"
[[body]]
material = "jelly"
group = "soft.1"
skin = "cube.obj"
box = { count = [4, 4, 4], spacing = 1.0, corner = [0, 0, 0.1] }
[[body]]
material = "clay"
group = "soft1"
skin = "wedge.obj"
box = { count = [3, 3, 3], spacing = 1.0, corner = [8, 0, 0.3] }
[[body]]
material = "clay"
group = "bare"
box = { count = [3, 3, 3], spacing = 1.0, corner = [16, 0, 0.2] }
velocity = [1, 2, 0]
[[collider]]
plane = { normal = [0, 0, 1], offset = 0 }
[surface]
voxels = 16
[run]
frames = 6
frame_time = 1.5
)";
constexpr const char* k_cube =
    "v 0 0 0.1\nv 4 0 0.1\nv 4 4 0.1\nv 0 4 0.1\nv 0 0 4.1\nv 4 0 4.1\nv 4 4 4.1\nv 0 4 4.1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
constexpr const char* k_wedge =
    "v 8 0 0.3\nv 11 0 0.3\nv 11 3 0.3\nv 8 3 3.3\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";
constexpr int k_frames = 7;
constexpr double k_rate = 30;  ///< frames a second of the film

Vec3 vector_of(const json& numbers, std::size_t row) {
  return {numbers.at(3 * row).get<float>(), numbers.at(3 * row + 1).get<float>(),
          numbers.at(3 * row + 2).get<float>()};
}

/// What three.js shows of a mesh, with z up as in the scene.
Mesh mesh_of(const json& shown) {
  Mesh mesh;
  const json& corners = shown.at("corners");
  for (std::size_t v = 0; v < shown.at("vertices").size() / 3; ++v)
    for (const auto& [name, column] : {std::pair{"vertices", &mesh.vertices}, {"normals", &mesh.normals}}) {
      const Vec3 there = vector_of(shown.at(name), v);
      column->emplace_back(there.x(), -there.z(), there.y());
    }
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3)
    mesh.triangles.push_back({corners[t], corners[t + 1], corners[t + 2]});
  return mesh;
}

/// By its name, of a frame that three.js shows.
std::map<std::string, Mesh> meshes_of(const json& frame) {
  std::map<std::string, Mesh> meshes;
  for (const json& shown : frame.at("meshes")) meshes[shown.at("name")] = mesh_of(shown);
  EXPECT_EQ(meshes.size(), frame.at("meshes").size()) << "of other names";
  return meshes;
}

float largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  float largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

Mesh body_of(const Mesh& frame, std::uint32_t number) {
  std::vector<bool> chosen(number + 1, false);
  chosen[number] = true;
  return program::part_of(frame, chosen);
}

class cli_three : public CliTest {
 protected:
  void SetUp() override {
    write("cube.obj", k_cube);
    write("wedge.obj", k_wedge);
    const std::string scene = write("three.toml", k_scene).string();
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"run", scene, "--threads", "1", "--no-images", "--out", at("out")},
          {"export", at("out"), "--skins", "glb", "--animation", "glb"}}) {
      const Outcome outcome = run_mallow(arguments);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
  }
  /// As mallow itself keeps it.
  Mesh frame_of(int frame) const {
    return read_mesh(at("out/surface/frame_00000" + std::to_string(frame) + ".ply"));
  }
};

TEST_F(cli_three, plays_skins_so_that_each_frame_is_there_at_its_time) {
  std::string times;
  for (int half = 0; half < 2 * k_frames - 1; ++half) times += std::to_string(half / (2 * k_rate)) + ',';
  times.pop_back();
  PLAY_WITH_THREE(played, times, folder_ / "out/export/skins.glb");
  ASSERT_EQ(played.at("durations").size(), 1u);
  EXPECT_NEAR(played["durations"][0].get<double>(), (k_frames - 1) / k_rate, 1e-6);
  float moved = 0;
  for (int half = 0; half < 2 * k_frames - 1; ++half) {
    std::map<std::string, Mesh> shown = meshes_of(played.at("shown").at(static_cast<std::size_t>(half)));
    ASSERT_EQ(shown.size(), 2u) << "bodies with skins";
    for (const auto& [name, number] : {std::pair{"soft.1", 0u}, {"soft1", 1u}}) {
      const Mesh before = body_of(frame_of(half / 2), number),
                 after = body_of(frame_of((half + 1) / 2), number);
      Mesh expected = before;
      for (std::size_t v = 0; v < expected.vertices.size(); ++v)
        expected.vertices[v] = 0.5f * (before.vertices[v] + after.vertices[v]);
      ASSERT_TRUE(shown.contains(name));
      EXPECT_LT(largest_distance(shown[name].vertices, expected.vertices), 1e-5f) << name << ' ' << half;
      EXPECT_EQ(shown[name].triangles, expected.triangles);
      if (half % 2 == 0) {
        EXPECT_LT(largest_distance(shown[name].normals, expected.normals), 1e-5f) << name << ' ' << half;
      }
      moved = std::max(moved, largest_distance(expected.vertices, body_of(frame_of(0), number).vertices));
    }
  }
  EXPECT_GT(moved, 0.5f) << "there is something to be seen";
}

/// The vertices of b that are nearest to those of a.
std::vector<std::uint32_t> nearest(const Mesh& a, const Mesh& b) {
  std::vector<std::uint32_t> rows;
  for (const Vec3& place : a.vertices) {
    const auto found = std::ranges::min_element(
        b.vertices, {}, [&](const Vec3& other) { return (other - place).squaredNorm(); });
    rows.push_back(static_cast<std::uint32_t>(found - b.vertices.begin()));
  }
  return rows;
}

/// Triangles whose vertices have other numbers, in an order of corners that does not depend on the first.
std::multiset<std::array<std::uint32_t, 3>> renumbered(const Mesh& mesh,
                                                       const std::vector<std::uint32_t>& rows) {
  std::multiset<std::array<std::uint32_t, 3>> all;
  for (const auto& t : mesh.triangles) {
    const std::uint32_t a = rows.at(t[0]), b = rows.at(t[1]), c = rows.at(t[2]);
    all.insert(std::min({std::array{a, b, c}, {b, c, a}, {c, a, b}}));
  }
  return all;
}

/// Steps of the file's grid, the finest power of two that has 16,383 of them along the frame's longest side.
float grid_step(const Mesh& frame) {
  const Aabb box = bounds(frame);
  return std::exp2(std::ceil(std::log2((box.max - box.min).maxCoeff() / 16382)));
}

/// What is shown of a body is its mesh on the grid, with normals of 8 bits.
void expect_on_grid(const Mesh& shown, const Mesh& expected, float step) {
  ASSERT_FALSE(shown.vertices.empty());
  const std::vector<std::uint32_t> rows = nearest(shown, expected);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    EXPECT_LT((shown.vertices[v] - expected.vertices[rows[v]]).lpNorm<Eigen::Infinity>(), 0.51f * step);
    EXPECT_GT(shown.normals[v].dot(expected.normals[rows[v]]), std::cos(1.3f * 3.1416f / 180));
  }
  std::vector<std::uint32_t> same(expected.vertices.size());
  for (std::size_t v = 0; v < same.size(); ++v) same[v] = static_cast<std::uint32_t>(v);
  EXPECT_TRUE(renumbered(shown, rows) == renumbered(expected, same));
}

TEST_F(cli_three, plays_surfaces_so_that_each_frame_alone_is_shown_until_the_next) {
  std::vector<std::string> files = {"surface.glb"};
  if (can_compress_glb()) {
    ASSERT_EQ(run_mallow({"export", at("out"), "--animation", "meshopt"}).exit_code, 0);
    files.emplace_back("surface.meshopt.glb");
  }
  std::string times;
  for (int frame = 0; frame < k_frames; ++frame)
    for (const double part : {0.01, 0.99}) times += std::to_string((frame + part) / k_rate) + ',';
  times.pop_back();
  for (const std::string& file : files) {
    PLAY_WITH_THREE(played, times, folder_ / "out/export" / file);
    ASSERT_EQ(played.at("durations").size(), 1u);
    EXPECT_NEAR(played["durations"][0].get<double>(), k_frames / k_rate, 1e-6) << "the last one is seen too";
    for (std::size_t k = 0; k < 2 * k_frames; ++k) {
      SCOPED_TRACE(file + " at half " + std::to_string(k));
      std::map<std::string, Mesh> shown = meshes_of(played.at("shown").at(k));
      ASSERT_EQ(shown.size(), 3u);
      const Mesh frame = frame_of(static_cast<int>(k) / 2);
      for (const auto& [name, number] : {std::pair{"soft.1", 0u}, {"soft1", 1u}, {"bare", 2u}})
        expect_on_grid(shown[name], body_of(frame, number), grid_step(frame));
    }
  }
}

TEST_F(cli_three, shows_the_materials_of_the_scene) {
  PLAY_WITH_THREE(played, "0", folder_ / "out/export/skins.glb");
  std::map<std::string, json> colors;
  for (const json& mesh : played.at("shown").at(0).at("meshes"))
    colors[mesh.at("material")] = mesh.at("color");
  ASSERT_EQ(colors.size(), 2u);
  EXPECT_EQ(colors.at("clay"), (json{0.25, 0.5, 0.125}));
}

}  // namespace three_test
}  // namespace mallow::test
