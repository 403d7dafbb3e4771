#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "cli/program.h"
#include "files/other_reader.h"
#include "mallow/files.h"

namespace mallow::test {
namespace export_test {

namespace fs = std::filesystem;
using cli_export = CliTest;

std::vector<std::string> three_frames(const std::vector<std::string>& endings) {
  std::vector<std::string> names;
  for (const char* frame : {"frame_000000.", "frame_000001.", "frame_000002."}) {
    for (const std::string& ending : endings) names.push_back(frame + ending);
  }
  return names;
}

void expect_refused(const Outcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
}

TEST_F(cli_export, writes_every_frame_in_every_format_and_leaves_the_run_as_it_is) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const std::string report = read_text(at("out/report.json"));
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "obj,glb", "--surface",
                                      "vtp,usda,vdb", "--particles", "vdb,vtp,csv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "surface 3\nparticles 3\n");
  EXPECT_EQ(names_in(at("out/export")),
            (std::vector<std::string>{"particles", "particles.pvd", "surface", "surface.manifest.usda",
                                      "surface.pvd", "surface.usda"}));
  std::vector<std::string> surfaces = three_frames({"glb", "obj", "usda", "vdb", "vtp"});
  surfaces.push_back("materials.mtl");
  EXPECT_EQ(names_in(at("out/export/surface")), surfaces);
  EXPECT_EQ(names_in(at("out/export/particles")), three_frames({"csv", "vdb", "vtp"}));
  EXPECT_EQ(read_text(at("out/report.json")), report);

  const Mesh mesh = read_mesh(at("out/surface/frame_000002.ply"));
  const Mesh exported = read_mesh(at("out/export/surface/frame_000002.obj"));
  EXPECT_EQ(exported.vertices, mesh.vertices);
  EXPECT_EQ(exported.triangles, mesh.triangles);
  EXPECT_EQ(read_points(at("out/export/particles/frame_000001.csv"), 1).velocities,
            read_particles(at("out/particles/frame_000001.ply")).velocities);
}

TEST_F(cli_export, collections_name_files_that_are_there_at_the_time_of_their_frames) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "vtp", "--particles", "vtp"}).exit_code, 0);
  for (const std::string kind : {"surface", "particles"}) {
    const std::string text = read_text(folder_ / "out/export" / (kind + ".pvd"));
    std::size_t at_tag = 0;
    for (int frame = 0; frame < 3; ++frame) {
      at_tag = text.find("<DataSet timestep=\"", at_tag) + 19;
      ASSERT_LT(at_tag, text.size());
      const std::string name = "frame_00000" + std::to_string(frame);
      EXPECT_EQ(std::strtod(text.c_str() + at_tag, nullptr),
                read_particles(folder_ / "out/particles" / (name + ".ply")).time);
      const std::size_t file = text.find("file=\"", at_tag) + 6;
      const std::string path = text.substr(file, text.find('"', file) - file);
      EXPECT_EQ(path, kind + '/' + name + ".vtp");
      EXPECT_TRUE(fs::exists(folder_ / "out/export" / path));
    }
    EXPECT_EQ(text.find("<DataSet", at_tag), std::string::npos);
  }
}

nlohmann::json json_of_glb(const std::string& glb) {
  std::uint32_t length = 0;  // of the JSON, which stands first
  if (glb.size() >= 20) std::memcpy(&length, glb.data() + 12, sizeof length);
  return nlohmann::json::parse(glb.substr(std::min<std::size_t>(glb.size(), 20), length));
}

/// A second body, of a second material, whose names no format takes as they are.
constexpr const char* k_second_body = R"(
[[material]]
name = "blue \"clay\""
alpha = 0.5
color = [0.25, 0.5, 0.125]
finish = "clay"
[[body]]
material = "blue \"clay\""
group = "2nd"
box = { count = [3, 3, 3], spacing = 1.0, corner = [5.0, 5.0, 0.6] }
)";

TEST_F(cli_export, groups_and_materials_have_the_names_and_looks_of_the_scene) {
  write("cube.toml", read_text(scene_) + k_second_body);
  ASSERT_EQ(run({"--out", at("out"), "--frames", "0"}).exit_code, 0);
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "glb,obj,usda,vtp,vdb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto expect_texts = [&](const std::string& file, const std::vector<const char*>& texts) {
    const std::string content = read_text(folder_ / "out/export/surface" / file);
    for (const char* text : texts) EXPECT_NE(content.find(text), std::string::npos) << file << ": " << text;
  };
  const auto json = json_of_glb(read_text(at("out/export/surface/frame_000000.glb")));
  std::vector<std::string> nodes, materials;
  for (const auto& node : json.at("nodes")) nodes.push_back(node.at("name"));
  for (const auto& material : json.at("materials")) materials.push_back(material.at("name"));
  EXPECT_EQ(nodes, (std::vector<std::string>{"surface", "cube", "2nd"}));
  EXPECT_EQ(materials, (std::vector<std::string>{"paste", "blue \"clay\""}));
  const auto& clay = json.at("materials").at(1).at("pbrMetallicRoughness");
  EXPECT_EQ(clay.at("baseColorFactor"), (nlohmann::json{0.25, 0.5, 0.125, 1.0}));
  EXPECT_EQ(clay.at("roughnessFactor"), 0.9);

  expect_texts("frame_000000.obj", {"# z is up\n", "mtllib materials.mtl\n", "g cube\nusemtl paste\nf ",
                                    "g 2nd\nusemtl blue_\"clay\"\nf "});
  expect_texts("materials.mtl", {"newmtl paste\n", "newmtl blue_\"clay\"\nKd 0.537099 0.735357 0.388573\n"});
  expect_texts("frame_000000.usda",
               {"def GeomSubset \"cube\"", "def GeomSubset \"_2nd\"", "displayName = \"2nd\"",
                "def Material \"paste\"", "def Material \"blue__clay_\"",
                "displayName = \"blue \\\"clay\\\"\"", "color3f inputs:diffuseColor = (0.25, 0.5, 0.125)"});
  // Of names in VTP tells vtk_file_test, of grids openvdb_test: text in both kinds of file.
  const std::string zero(1, '\0');
  const std::string vtp = read_text(at("out/export/surface/frame_000000.vtp"));
  EXPECT_NE(vtp.find("cube" + zero + "2nd" + zero), std::string::npos);
  EXPECT_NE(vtp.find("paste" + zero + "blue \"clay\"" + zero), std::string::npos);
  expect_texts("frame_000000.vdb", {"cube", "2nd", "body_name", "paste", "blue \"clay\""});
}

TEST_F(cli_export, a_body_whose_slot_another_one_took_keeps_its_name_and_looks_in_the_frames_that_show_it) {
  // The red cube goes into the first sink; then the second cuts the blue bar, whose part takes the red slot.
  const std::string scene = write("slots.toml", R"([solver]
support_radius = 2.1
gravity = [0.0, 0.0, 0.0]
[[material]]
name = "red"
color = [0.5, 0.0, 0.0]
[[material]]
name = "blue"
color = [0.0, 0.0, 0.5]
[[body]]
material = "red"
box = { count = [3, 3, 3], spacing = 1.0, corner = [0, 0, 0], jitter = 0 }
velocity = [-2.0, 0.0, 0.0]
[[body]]
material = "blue"
splits = true
box = { count = [3, 3, 18], spacing = 1.0, corner = [20, 0, 0], jitter = 0 }
velocity = [2.0, 0.0, 0.0]
[[sink]]
box = { min = [-9.0, -9.0, -9.0], max = [-0.5, 9.0, 9.0] }
[[sink]]
box = { min = [27.0, -9.0, 6.5], max = [60.0, 9.0, 10.5] }
[run]
frames = 9
frame_time = 0.45
)")
                                .string();
  ASSERT_EQ(run_mallow({"run", scene, "--out", at("out"), "--no-images"}).exit_code, 0);
  const nlohmann::json report = read_json(at("out/report.json"));
  ASSERT_EQ(report.at("groups")[0].at("name"), "body[1], part 2") << "which has the slot now";
  ASSERT_EQ(report.at("past_bodies").size(), 1u);
  EXPECT_EQ(report.at("past_bodies")[0].at("name"), "body[0]");
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "obj,glb,usda,vtp,vdb", "--particles",
                                      "vtp,csv", "--animation", "glb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto obj = [&](const char* frame) {
    return read_text(folder_ / "out/export/surface" / (std::string("frame_00000") + frame + ".obj"));
  };
  EXPECT_NE(obj("0").find("g body[0]\nusemtl red\n"), std::string::npos);
  EXPECT_EQ(obj("0").find("part_2"), std::string::npos);
  EXPECT_NE(obj("9").find("g body[1],_part_2\nusemtl blue\n"), std::string::npos);
  EXPECT_EQ(obj("9").find("body[0]"), std::string::npos);
  for (const char* name : {"newmtl red\n", "newmtl blue\n"})
    EXPECT_NE(read_text(at("out/export/surface/materials.mtl")).find(name), std::string::npos);
  const auto json = json_of_glb(read_text(at("out/export/surface.glb")));
  std::set<std::string> nodes;
  for (const auto& node : json.at("nodes")) nodes.insert(node.at("name").get<std::string>());
  for (const char* name : {"body[0]", "body[1]", "body[1], part 2"})
    EXPECT_TRUE(nodes.contains(name)) << name;
  for (const auto& mesh : json.at("meshes")) {
    const auto& material =
        json.at("materials").at(mesh.at("primitives")[0].at("material").get<std::size_t>());
    EXPECT_EQ(material.at("name"), mesh.at("name") == "body[0]" ? "red" : "blue") << mesh.at("name");
  }
}

TEST_F(cli_export, a_thousand_bodies_are_told_apart_in_frames_surfaces_and_pictures) {
  std::string text = read_text(scene_);
  text.replace(text.find("voxels = 16"), 11, "voxels = 64");
  for (int b = 1; b < 1000; ++b)
    text += "[[body]]\nmaterial = \"paste\"\nbox = { count = [2, 2, 2], spacing = 1.0, corner = [" +
            std::to_string(4 * (b % 10)) + ".0, " + std::to_string(4 * (b / 10 % 10) + 6) + ".0, " +
            std::to_string(4 * (b / 100)) + ".6] }\n";
  write("cube.toml", text);
  const Outcome ran = run({"--out", at("out"), "--frames", "1"}, true);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(names_in(at("out/images")).size(), 2u);
  const std::vector<std::uint32_t> bodies = read_particles(at("out/particles/frame_000001.ply")).bodies;
  ASSERT_EQ(bodies.size(), 125u + 999 * 8);
  for (std::size_t i = 0; i < bodies.size(); ++i) ASSERT_EQ(bodies[i], i < 125 ? 0 : 1 + (i - 125) / 8);
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "obj", "--particles", "vtp,vdb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string obj = read_text(at("out/export/surface/frame_000001.obj"));
  for (const char* name : {"\ng cube\n", "\ng body[256]\n", "\ng body[999]\n"})
    EXPECT_NE(obj.find(name), std::string::npos) << name;
}

TEST_F(cli_export, up_turns_surfaces_and_particles_alike) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "0"}).exit_code, 0);
  ASSERT_EQ(
      run_mallow({"export", at("out"), "--up", "y", "--surface", "obj,usda,vtp,glb", "--particles", "csv"})
          .exit_code,
      0);
  const auto expect_turned = [](const std::vector<Vec3>& found, const std::vector<Vec3>& z_up) {
    ASSERT_EQ(found.size(), z_up.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], with_y_up(z_up[i])) << i;
  };
  const Mesh mesh = read_mesh(at("out/surface/frame_000000.ply"));
  expect_turned(read_mesh(at("out/export/surface/frame_000000.obj")).vertices, mesh.vertices);
  expect_turned(read_points(at("out/export/particles/frame_000000.csv"), 1).positions,
                read_particles(at("out/particles/frame_000000.ply")).positions);
  for (const char* file : {"out/export/surface.usda", "out/export/surface/frame_000000.usda"})
    EXPECT_NE(read_text(at(file)).find("upAxis = \"Y\"\n"), std::string::npos) << file;
  // glTF is y up by its standard: its vertices stay, and a node turns them.
  const std::string with_y = read_text(at("out/export/surface/frame_000000.glb"));
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "glb"}).exit_code, 0);
  EXPECT_EQ(read_text(at("out/export/surface/frame_000000.glb")), with_y);
}

TEST_F(cli_export, usda_is_one_mesh_of_which_tinyusdz_reads_every_frame) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "1"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "usda"}).exit_code, 0);
  const auto expect_frame = [&](const nlohmann::json& read, const std::string& frame) {
    ASSERT_EQ(read.at("error"), "");
    ASSERT_EQ(read.at("meshes").size(), 1u);
    const Mesh mesh = read_mesh(at("out/surface/" + frame + ".ply"));
    const nlohmann::json& found = read.at("meshes")[0];
    EXPECT_EQ(found.at("path"), "/surface/mesh");
    nlohmann::json points = nlohmann::json::array();
    for (const Vec3& vertex : mesh.vertices)
      for (const float x : vertex) points.push_back(x);
    EXPECT_EQ(found.at("points"), points);
    nlohmann::json corners = nlohmann::json::array();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) corners.push_back(vertex);
    EXPECT_EQ(found.at("corners"), corners);
  };
  READ_WITH_TINYUSDZ(series, folder_ / "out/export/surface.usda");
  expect_frame(series, "frame_000000");
  for (const std::string frame : {"frame_000000", "frame_000001"}) {
    READ_WITH_TINYUSDZ(read, folder_ / "out/export/surface" / (frame + ".usda"));
    expect_frame(read, frame);
    EXPECT_NE(series.at("root").get<std::string>().find("@./surface/" + frame + ".usda@"), std::string::npos);
  }
}

/// A frame of USD is one of the film, and lasts as long; velocities lead from each to the next.
TEST_F(cli_export, usd_has_the_frames_of_the_film_and_velocities_per_second_of_it) {
  const auto number = [](const std::string& text, const std::string& name) {
    return std::strtod(text.c_str() + text.find(name) + name.size(), nullptr);
  };
  struct Case {
    const char* time_step;
    const char* frame_time;
    int rate;
  };
  for (const auto& [time_step, frame_time, rate] : {Case{"0.0333", "0.0333", 30}, Case{"0.15", "0.45", 25}}) {
    ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--frames", "2", "--set",
                   std::string("solver.time_step=") + time_step, "--set",
                   std::string("run.frame_time=") + frame_time, "--set",
                   "render.frames_per_second=" + std::to_string(rate)})
                  .exit_code,
              0);
    ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "usda"}).exit_code, 0);
    const std::string series = read_text(at("out/export/surface.usda"));
    EXPECT_NE(series.find("active = [(0, 0), (1, 1), (2, 2)]"), std::string::npos) << series;
    for (const char* file : {"surface.usda", "surface/frame_000002.usda", "surface.manifest.usda"}) {
      const std::string text = read_text(folder_ / "out/export" / file);
      for (const char* name : {"timeCodesPerSecond = ", "framesPerSecond = "})
        EXPECT_EQ(number(text, name), rate) << file;
      EXPECT_EQ(number(text, "endTimeCode = "), 2) << file;
    }
    const double frames_time = read_particles(at("out/particles/frame_000002.ply")).time / 2;
    const double speed = std::abs(frames_time * rate - 1) < 2e-3 ? 1 : frames_time * rate;
    const Vec3 velocity = read_mesh(at("out/surface/frame_000002.ply")).velocities.at(0);
    ASSERT_LT(velocity.z(), 0);
    const std::string text = read_text(at("out/export/surface/frame_000002.usda"));
    const std::string begin = "velocities.timeSamples = {\n            2: [(";
    const std::size_t found = text.find(begin);
    ASSERT_NE(found, std::string::npos);
    const char* digits = text.c_str() + found + begin.size();
    for (int k = 0; k < 3; ++k) {
      char* end = nullptr;
      EXPECT_NEAR(std::strtod(digits, &end), speed * double{velocity[k]},
                  1e-6 * speed * double{velocity.norm()})
          << k;
      digits = end + 2;  // behind ", "
    }
  }
}

TEST_F(cli_export, an_animation_is_one_file_of_all_frames_with_the_bodies_names) {
  write("cube.toml", read_text(scene_) + k_second_body);
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  std::string formats = "glb";
  if (can_compress_glb()) formats += ",meshopt";
  const Outcome outcome = run_mallow({"export", at("out"), "--animation", formats, "--surface", "vtp"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "surface 3\nanimation 3\n");
  for (const std::string file : {"surface.glb", "surface.meshopt.glb"}) {
    if (file == "surface.meshopt.glb" && !can_compress_glb()) continue;
    const nlohmann::json json = json_of_glb(read_text(at("out/export/" + file)));
    std::vector<std::string> names;
    for (const auto& node : json.at("nodes")) names.push_back(node.at("name"));
    EXPECT_EQ(names, (std::vector<std::string>{"cube", "2nd", "frame 0", "cube", "2nd", "frame 1", "cube",
                                               "2nd", "frame 2", "surface"}));
    // A frame is one of the film, which has 30 a second.
    EXPECT_EQ(json.at("animations")[0].at("channels").size(), 3u);
    float last = 0;
    for (const auto& accessor : json.at("accessors"))
      if (accessor.at("type") == "SCALAR" && accessor.contains("max"))
        last = std::max(last, accessor["max"][0].get<float>());
    EXPECT_FLOAT_EQ(last, 3.0f / 30);
  }
  // Another run removes it with the rest of the old one.
  ASSERT_EQ(run({"--out", at("out"), "--overwrite"}).exit_code, 0);
  EXPECT_TRUE(names_in(at("out/export")).empty());
}

TEST_F(cli_export, tables_have_temperatures_where_the_scene_has_heat) {
  std::string text = read_text(scene_);
  const std::size_t material = text.find("[[material]]\n") + 13;
  write("cube.toml", text.insert(material, "temperature = 350.5\n"));
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--particles", "csv,vtp"}).exit_code, 0);
  const std::string csv = read_text(at("out/export/particles/frame_000000.csv"));
  EXPECT_TRUE(csv.starts_with("id,x,y,z,vx,vy,vz,body,temperature\n")) << csv.substr(0, 100);
  EXPECT_NE(csv.find(",350.5\n"), std::string::npos);
  EXPECT_NE(read_text(at("out/export/particles/frame_000000.vtp")).find("Name=\"Temperature\""),
            std::string::npos);
}

TEST_F(cli_export, out_names_another_folder) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  const Outcome outcome = run_mallow({"export", at("out"), "--particles", "csv", "--out", at("some/where")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_in(at("some/where/particles")), three_frames({"csv"}));
  EXPECT_FALSE(fs::exists(at("out/export")));
}

TEST_F(cli_export, a_frame_without_its_surface_is_passed_over) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  fs::remove(at("out/surface/frame_000002.ply"));
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "glb"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "surface 2\n");
}

TEST_F(cli_export, wrong_use_is_refused_with_what_is_allowed) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  expect_refused(run_mallow({"export"}), {"DIR"});
  expect_refused(run_mallow({"export", at("out")}), {"--surface", "--particles", "--animation"});
  expect_refused(run_mallow({"export", at("out"), "--surface", "fbx"}), {"fbx", "obj", "glb", "vtp", "usda"});
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv,obj"}), {"obj", "vdb", "vtp", "csv"});
  expect_refused(run_mallow({"export", at("out"), "--animation", "obj"}), {"obj", "glb", "meshopt"});
  expect_refused(run_mallow({"export", at("out"), "--animation", "glb"}), {"no surfaces", "mallow surface"});
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv", "--up", "x"}),
                 {"--up", "x", "y", "z"});
  expect_refused(run_mallow({"export", at("none"), "--particles", "csv"}), {"no scene.toml"});
  expect_refused(run_mallow({"export", at("out"), "--surface", "glb"}), {"no surfaces", "mallow surface"});
  write("file", "");
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv", "--out", at("file")}),
                 {"file: --out: cannot be made"});
  EXPECT_FALSE(fs::exists(at("out/export")));
  const Outcome help = run_mallow({"export", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* word : {"obj", "glb", "vtp", "usda", "vdb", "csv", "--up"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

TEST_F(cli_export, overwrite_removes_the_exports_of_the_earlier_run) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--particles", "csv,vtp"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"surface", at("out")}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "obj,usda"}).exit_code, 0);
  write("out/export/particles/notes.txt", "mine");
  ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface", "--frames", "1"}).exit_code, 0);
  EXPECT_EQ(names_in(at("out/export")), std::vector<std::string>{"particles"});
  EXPECT_EQ(names_in(at("out/export/particles")), std::vector<std::string>{"notes.txt"});
}

}  // namespace export_test
}  // namespace mallow::test
