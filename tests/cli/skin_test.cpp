#include <algorithm>

#include "cli/program.h"
#include "mallow/files.h"

namespace mallow::test {
namespace cli_skin_test {

/// A cube with a skin falls beside one without.
constexpr const char* k_scene = R"([solver]
time_step = 0.15
support_radius = 2.1
[[material]]
name = "jelly"
alpha = 0.2
update_threshold = 0.5
[[body]]
material = "jelly"
skin = "cube.obj"
box = { count = [4, 4, 4], spacing = 1.0, corner = [0, 0, 0.5] }
[[body]]
material = "jelly"
box = { count = [3, 3, 3], spacing = 1.0, corner = [8, 0, 2] }
[[collider]]
plane = { normal = [0, 0, 1], offset = 0 }
[run]
frames = 6
)";

constexpr const char* k_cube =
    "v 0 0 0.5\nv 4 0 0.5\nv 4 4 0.5\nv 0 4 0.5\nv 0 0 4.5\nv 4 0 4.5\nv 4 4 4.5\nv 0 4 4.5\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class cli_skin : public CliTest {
 protected:
  cli_skin() {
    write("skin.toml", k_scene);
    write("cube.obj", k_cube);
  }
  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"run", at("skin.toml"), "--threads", "1", "--no-images"});
    return run_mallow(arguments);
  }
  Mesh frame(const std::string& folder, int number) const {
    return read_mesh(at(folder + "/surface/frame_00000" + std::to_string(number) + ".ply"));
  }
};

TEST_F(cli_skin, is_drawn_in_place_of_a_surface_around_its_body) {
  const Outcome outcome = run({"--out", at("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Vec3> rest = read_mesh(at("cube.obj")).vertices;
  for (int number = 0; number <= 6; ++number) {
    const Mesh mesh = frame("out", number);
    EXPECT_EQ(std::ranges::count(mesh.material_ids, 0u), 8);
    EXPECT_GT(std::ranges::count(mesh.material_ids, 1u), 50);
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    const std::size_t first = mesh.vertices.size() - 8;
    for (std::size_t v = 0; v < 8; ++v)
      EXPECT_LT((mesh.vertices[first + v] - rest[v]).norm(), number == 0 ? 1e-5f : 2.0f) << number;
  }
}

TEST_F(cli_skin, goes_on_from_a_checkpoint_with_the_same_bits) {
  ASSERT_EQ(run({"--out", at("whole")}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("halves"), "--frames", "3", "--checkpoint-every", "3"}).exit_code, 0);
  const Outcome outcome = run_mallow({"run", "--resume", at("halves"), "--frames", "6"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (int number = 0; number <= 6; ++number) {
    const std::string name = "/surface/frame_00000" + std::to_string(number) + ".ply";
    EXPECT_EQ(read_text(at("whole" + name)), read_text(at("halves" + name))) << number;
  }
}

TEST_F(cli_skin, stays_where_surfaces_are_drawn_again) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const Mesh before = frame("out", 4);
  const Outcome outcome =
      run_mallow({"surface", at("out"), "--set", "surface.voxels_per_spacing=4", "--threads", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Mesh after = frame("out", 4);
  EXPECT_GT(after.vertices.size(), before.vertices.size());
  for (std::size_t v = 1; v <= 8; ++v)
    EXPECT_EQ(after.vertices[after.vertices.size() - v], before.vertices[before.vertices.size() - v]);
}

TEST_F(cli_skin, is_exported_as_one_animation) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const Outcome outcome = run_mallow({"export", at("out"), "--skins", "glb", "--surface", "obj"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "surface 7\nskins 7\n");
  const std::string glb = read_text(at("out/export/skins.glb"));
  EXPECT_NE(glb.find("\"weights\""), std::string::npos);
  EXPECT_NE(glb.find("\"targets\""), std::string::npos);
  // Another run removes it with the rest of the old one.
  ASSERT_EQ(run({"--out", at("out"), "--overwrite"}).exit_code, 0);
  EXPECT_TRUE(names_in(at("out/export")).empty());
}

TEST_F(cli_skin, is_asked_for_in_vain_where_no_body_has_one) {
  ASSERT_EQ(CliTest::run({"--out", at("bare")}).exit_code, 0);
  const Outcome outcome = run_mallow({"export", at("bare"), "--skins", "glb"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("no body of the run's scene has a skin"), std::string::npos) << outcome.err;
}

TEST_F(cli_skin, is_not_written_over) {
  const Outcome outcome = run({"--state-out", at("cube.obj")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(read_text(at("cube.obj")), k_cube);
}

}  // namespace cli_skin_test
}  // namespace mallow::test
