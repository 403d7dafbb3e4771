#include <algorithm>
#include <cstdlib>
#include <utility>

#include "cli/program.h"
#include "files/other_reader.h"
#include "mallow/files.h"

namespace mallow::test {
namespace {

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
  EXPECT_EQ(names_in(at("out/export")), (std::vector<std::string>{"particles", "particles.pvd", "surface",
                                                                  "surface.pvd", "surface.usda"}));
  EXPECT_EQ(names_in(at("out/export/surface")), three_frames({"glb", "obj", "usda", "vdb", "vtp"}));
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

TEST_F(cli_export, glb_has_the_colour_and_finish_of_the_material) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "0"}).exit_code, 0);
  const std::string scene = read_text(at("out/scene.toml"));
  std::string changed = scene;
  changed.replace(changed.find("[[material]]"), 12, "[[material]]\ncolor = [0.25, 0.5, 0.125]");
  changed.replace(changed.find("\"jelly\""), 7, "\"clay\"");
  write("out/scene.toml", changed);
  const Outcome outcome = run_mallow({"export", at("out"), "--surface", "glb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string glb = read_text(at("out/export/surface/frame_000000.glb"));
  EXPECT_NE(glb.find("\"baseColorFactor\":[0.25,0.5,0.125,1.0]"), std::string::npos) << glb.substr(0, 2000);
  EXPECT_NE(glb.find("\"roughnessFactor\":0.9"), std::string::npos) << glb.substr(0, 2000);
}

TEST_F(cli_export, usda_is_what_tinyusdz_plays_frame_by_frame) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "1"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--surface", "usda"}).exit_code, 0);
  READ_WITH_TINYUSDZ(read, folder_ / "out/export/surface.usda");
  ASSERT_EQ(read.at("error"), "");
  ASSERT_EQ(read.at("meshes").size(), 2u);
  for (std::size_t f = 0; f < 2; ++f) {
    const std::string frame = "frame_00000" + std::to_string(f);
    const Mesh mesh = read_mesh(at("out/surface/" + frame + ".ply"));
    const nlohmann::json& found = read.at("meshes")[f];
    EXPECT_EQ(found.at("path"), "/surface/" + frame);
    nlohmann::json points = nlohmann::json::array();
    for (const Vec3& vertex : mesh.vertices)
      for (const float x : vertex) points.push_back(x);
    EXPECT_EQ(found.at("points"), points);
    nlohmann::json corners = nlohmann::json::array();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) corners.push_back(vertex);
    EXPECT_EQ(found.at("corners"), corners);
  }
  const std::string& layer = read.at("layer").get_ref<const std::string&>();
  EXPECT_NE(layer.find("endTimeCode = 1\n"), std::string::npos);
  EXPECT_NE(layer.find("{\n            0: \"invisible\",\n            1: \"inherited\",\n"),
            std::string::npos);
}

TEST_F(cli_export, usd_has_the_seconds_of_the_simulation_and_the_frames_of_the_film) {
  const auto rates = [&](const std::vector<std::string>& overrides) {
    std::vector<std::string> arguments = {"--out", at("out"), "--overwrite", "--frames", "1"};
    for (const std::string& value : overrides) arguments.insert(arguments.end(), {"--set", value});
    EXPECT_EQ(run(arguments).exit_code, 0);
    EXPECT_EQ(run_mallow({"export", at("out"), "--surface", "usda"}).exit_code, 0);
    const std::string text = read_text(at("out/export/surface.usda"));
    const auto rate = [&](const std::string& name) {
      return std::strtod(text.c_str() + text.find(name + " = ") + name.size() + 3, nullptr);
    };
    return std::pair(rate("timeCodesPerSecond"), rate("framesPerSecond"));
  };
  const auto in_real_time = rates({"run.frame_time=0.0333", "render.frames_per_second=30"});
  EXPECT_EQ(in_real_time, std::pair(30.0, 30.0));
  const auto slowed = rates({"run.frame_time=0.02", "render.frames_per_second=25"});
  EXPECT_NEAR(slowed.first, 50, 1e-4);
  EXPECT_EQ(slowed.second, 25);

  const std::string line = "frame_time = 0.45\n";
  std::string left_out = read_text(scene_);
  ASSERT_NE(left_out.find(line), std::string::npos);
  write("cube.toml", left_out.erase(left_out.find(line), line.size()));
  EXPECT_NEAR(rates({}).first, 1 / static_cast<double>(0.15f), 1e-9);
  EXPECT_NEAR(rates({"solver.support_radius=1.05"}).first, 1 / static_cast<double>(0.15f), 1e-9);
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
  expect_refused(run_mallow({"export", at("out")}), {"--surface", "--particles"});
  expect_refused(run_mallow({"export", at("out"), "--surface", "fbx"}), {"fbx", "obj", "glb", "vtp", "usda"});
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv,obj"}), {"obj", "vdb", "vtp", "csv"});
  expect_refused(run_mallow({"export", at("none"), "--particles", "csv"}), {"no scene.toml"});
  expect_refused(run_mallow({"export", at("out"), "--surface", "glb"}), {"no surfaces", "mallow surface"});
  write("file", "");
  expect_refused(run_mallow({"export", at("out"), "--particles", "csv", "--out", at("file")}),
                 {"file/particles"});
  EXPECT_FALSE(fs::exists(at("out/export")));
  const Outcome help = run_mallow({"export", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* word : {"obj", "glb", "vtp", "usda", "vdb", "csv"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

TEST_F(cli_export, overwrite_removes_the_exports_of_the_earlier_run) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"export", at("out"), "--particles", "csv,vtp"}).exit_code, 0);
  write("out/export/surface.usda", "");
  write("out/export/particles/notes.txt", "mine");
  ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface", "--frames", "1"}).exit_code, 0);
  EXPECT_EQ(names_in(at("out/export")), std::vector<std::string>{"particles"});
  EXPECT_EQ(names_in(at("out/export/particles")), std::vector<std::string>{"notes.txt"});
}

}  // namespace
}  // namespace mallow::test
