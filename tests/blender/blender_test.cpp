#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "files/other_reader.h"
#include "mallow/files.h"

namespace mallow::test {
namespace blender_test {

using nlohmann::json;

/// A skinned cube with texture coordinates beside one that gets a surface, in another look.
constexpr const char* k_scene = R"([solver]
support_radius = 2.1
time_step = 0.15
[[material]]
name = "jelly"
alpha = 0.2
[[material]]
name = "grey clay"
alpha = 0.5
color = [0.25, 0.5, 0.125]
finish = "clay"
[[body]]
material = "jelly"
group = "skinned"
skin = "cube.obj"
box = { count = [4, 4, 4], spacing = 1.0, corner = [0, 0, 0.5] }
[[body]]
material = "grey clay"
box = { count = [3, 3, 3], spacing = 1.0, corner = [8, 0, 2] }
[[collider]]
plane = { normal = [0, 0, 1], offset = 0 }
[surface]
voxels = 24
[run]
frames = 6
)";
/// Each face has the whole picture, but the last, which has none.
constexpr const char* k_cube =
    "v 0 0 0.5\nv 4 0 0.5\nv 4 4 0.5\nv 0 4 0.5\nv 0 0 4.5\nv 4 0 4.5\nv 4 4 4.5\nv 0 4 4.5\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 4/2 3/3 2/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4 1 5 "
    "8\n";

class blender_import : public CliTest {
 protected:
  void SetUp() override {
    write("scene.toml", k_scene);
    write("cube.obj", k_cube);
    for (const char* out : {"out", "other"})
      ASSERT_EQ(
          run_mallow({"run", at("scene.toml"), "--threads", "1", "--no-images", "--out", at(out)}).exit_code,
          0);
  }
};

#define BLENDER(status, arguments)                                                                          \
  const int status = std::string(MALLOW_BLENDER).ends_with("-NOTFOUND")                                     \
                         ? 127                                                                              \
                         : WEXITSTATUS(std::system(("'" MALLOW_BLENDER "' -b --factory-startup "            \
                                                    "--python-exit-code 1 " +                               \
                                                    std::string(arguments) + " > '" + at("log") + "' 2>&1") \
                                                       .c_str()));                                          \
  if (status == 127) GTEST_SKIP() << "SKIPPED: there is no Blender; tools/setup --blender installs it"

std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> numbers;
  for (const Vec3& vector : vectors) numbers.insert(numbers.end(), vector.begin(), vector.end());
  return numbers;
}

/// A body's triangles with the vertices that they have, and how fast those are in a second of the film.
Mesh part_of_body(const Mesh& mesh, std::uint32_t body, float speed) {
  Mesh part;
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles)
    if (mesh.material_ids[t[0]] == body)
      for (const std::uint32_t v : t) used[v] = true;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<std::uint32_t>(part.vertices.size());
    part.vertices.push_back(mesh.vertices[v]);
    part.velocities.emplace_back(speed * mesh.velocities[v]);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    if (mesh.material_ids[a] == body) part.triangles.push_back({number[a], number[b], number[c]});
  return part;
}

TEST_F(blender_import, shows_each_frame_of_each_body_and_leaves_nothing_behind) {
  ASSERT_EQ(run_mallow({"export", at("out"), "--skins", "glb", "--animation", "glb"}).exit_code, 0);
  BLENDER(status, "-P '" MALLOW_BLENDER_CHECKS "/check_in_blender.py' -- '" MALLOW_BLENDER_TOOLS "' '" +
                      at("out") + "' '" + at("other") + "' '" + at("found.json") + "' '" +
                      at("out/export/skins.glb") + "' '" + at("out/export/surface.glb") + "'");
  ASSERT_EQ(status, 0) << read_text(at("log"));
  const json found = read_json(at("found.json"));
  EXPECT_EQ(found.at("range"), (json{0, 6, 30}));

  const json report = read_json(at("out/report.json"));
  const double speed = report.at("frame_time").get<double>() * 30;
  for (const std::string frame : {"0", "3", "6", "100"}) {
    const json& shown = found.at("frames").at(frame);
    ASSERT_EQ(shown.size(), 2u);
    // Behind the last frame it stays.
    const Mesh mesh = read_mesh(at("out/surface/frame_00000" + (frame == "100" ? "6" : frame) + ".ply"));
    for (std::uint32_t body = 0; body < 2; ++body) {
      const json& object = shown.at(body == 0 ? "skinned" : "body[1]");
      EXPECT_EQ(object.at("body"), body);
      EXPECT_EQ(object.at("materials"), json{body == 0 ? "skinned" : "body[1]"})
          << "a material for each body";
      EXPECT_EQ(object.at("valid"), true);
      const Mesh part = part_of_body(mesh, body, static_cast<float>(speed));
      EXPECT_GT(part.vertices.size(), body == 0 ? 7u : 50u);
      EXPECT_EQ(object.at("vertices").get<std::vector<double>>(), flat(part.vertices))
          << frame << ' ' << body;
      std::vector<std::uint32_t> corners;
      for (const auto& t : part.triangles) corners.insert(corners.end(), t.begin(), t.end());
      EXPECT_EQ(object.at("corners").get<std::vector<std::uint32_t>>(), corners);
      const auto velocities = object.at("velocities").get<std::vector<double>>();
      const std::vector<double> expected = flat(part.velocities);
      ASSERT_EQ(velocities.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(velocities[i], expected[i], 1e-5 * (1 + std::abs(expected[i])));
    }
    const json& uv = shown.at("skinned").at("uv");
    ASSERT_EQ(uv.size(), 36u);
    for (std::size_t face = 0; face < 6; ++face) {
      const json whole = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
      for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(uv[6 * face + k], face < 5 ? whole[k] : json({0, 0}));
    }
    EXPECT_TRUE(shown.at("body[1]").at("uv").empty());
  }

  const json& looks = found.at("looks");
  EXPECT_EQ(looks.at("body[1]").at("color"), (json{0.25, 0.5, 0.125}));
  EXPECT_GT(looks["body[1]"]["roughness"], 0.8);
  EXPECT_LT(looks.at("skinned").at("roughness"), 0.5);
  const json color = report.at("groups")[0].at("color");
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(looks["skinned"]["color"][k].get<double>(), color[k], 1e-6);

  EXPECT_EQ(found.at("counts_after_frames"), found.at("first_counts")) << "frames pile up";
  EXPECT_EQ(found.at("counts_after_imports"), found.at("first_counts")) << "imports pile up";
  EXPECT_EQ(found.at("kept_roughness"), 0.125) << "what the user changed in a material stays";
  EXPECT_EQ(found.at("handlers"), 1);
  for (const auto& [kind, more] :
       {std::pair{"meshes", 2}, {"objects", 2}, {"materials", 2}, {"collections", 1}})
    EXPECT_EQ(found.at("counts_of_two_runs").at(kind), found["first_counts"][kind].get<int>() + more) << kind;
  EXPECT_EQ(found.at("kept_where_damaged"), true);
  EXPECT_NE(found.at("no_run").get<std::string>().find("there is no such file"), std::string::npos);

  // Blender's own reader of glTF, whose frames are those of its scene.
  const auto expect_box = [&](const json& object, const Mesh& mesh, std::uint32_t body) {
    Mesh part = part_of_body(mesh, body, 1);
    const Aabb box = bounds(part);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(object.at("box")[0][k].get<double>(), double{box.min[static_cast<int>(k)]}, 2e-3);
      EXPECT_NEAR(object.at("box")[1][k].get<double>(), double{box.max[static_cast<int>(k)]}, 2e-3);
    }
  };
  const double rate = found.at("gltf")[0].at("fps").get<double>() / 30;
  ASSERT_GE(rate, 0.79);
  for (int f = 0; f < 7; ++f) {
    // Blender reads the files in its own rate, of 24 frames a second: only those of its frames that are ours.
    const double frame = f / rate;
    if (std::abs(frame - std::round(frame)) > 1e-6 || frame > 6) continue;
    const Mesh mesh = read_mesh(at("out/surface/frame_00000" + std::to_string(std::lround(frame)) + ".ply"));
    const json& skin = found["gltf"][0].at("shown").at(std::to_string(f));
    ASSERT_EQ(skin.size(), 1u);
    expect_box(skin.begin().value(), mesh, 0);
    const json& surface = found["gltf"][1].at("shown").at(std::to_string(f));
    ASSERT_EQ(surface.size(), 2u) << "one frame's bodies";
    for (const json& object : surface) expect_box(object, mesh, object.at("materials")[0] == "jelly" ? 0 : 1);
  }
}

TEST_F(blender_import, takes_a_picture_from_the_command_line) {
  BLENDER(status, "-P '" MALLOW_BLENDER_TOOLS "/open_run.py' -- '" + at("out") +
                      "' --render 3 --samples 1 --to '" + at("picture.png") + "'");
  ASSERT_EQ(status, 0) << read_text(at("log"));
  EXPECT_EQ(read_text(at("picture.png")).substr(1, 3), "PNG");
  BLENDER(refused, "-P '" MALLOW_BLENDER_TOOLS "/open_run.py' -- '" + at("none") + "'");
  EXPECT_EQ(refused, 2);
  EXPECT_NE(read_text(at("log")).find("report.json: there is no such file"), std::string::npos)
      << read_text(at("log"));
}

TEST_F(blender_import, damaged_files_are_read_or_refused_in_words) {
  std::filesystem::create_directory(at("scratch"));
  const auto counts = read_with("'" MALLOW_PYTHON "' '" MALLOW_BLENDER_CHECKS
                                "/check_run_files.py' "
                                "'" MALLOW_BLENDER_TOOLS "/mallow_import' '" +
                                    at("out") + "'",
                                folder_ / "scratch");
  if (!counts) GTEST_SKIP() << "SKIPPED: there is no numpy; tools/setup installs it with python3-openvdb";
  EXPECT_GT(counts->at("refused"), 500);
}

}  // namespace blender_test
}  // namespace mallow::test
