// mallow compare: how two runs or states differ.
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "mallow/files.h"

namespace mallow::test {
namespace compare_test {

namespace fs = std::filesystem;

class cli_compare : public CliTest {
 protected:
  Outcome compare(const std::string& a, const std::string& b, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"compare", at(a), at(b)});
    return run_mallow(more);
  }
  void make_runs() const {
    ASSERT_EQ(run({"--out", at("a"), "--frames", "4", "--checkpoint-every", "2"}).exit_code, 0);
    ASSERT_EQ(run_mallow({"run", scene_, "--no-images", "--out", at("b"), "--frames", "4", "--threads", "3",
                          "--checkpoint-every", "2"})
                  .exit_code,
              0);
  }
  fs::path particles(const std::string& run, int frame) const {
    return folder_ / run / "particles" / ("frame_00000" + std::to_string(frame) + ".ply");
  }
  /// Moves a particle by so many spacings, which are 1 m.
  void move(const std::string& run, int frame, std::size_t particle, float way) const {
    ParticleFrame moved = read_particles(particles(run, frame));
    moved.positions[particle].x() += way;
    write_particles(particles(run, frame), moved);
  }
};

TEST_F(cli_compare, finds_the_same_bits_of_runs_with_other_numbers_of_threads) {
  make_runs();
  Outcome outcome = compare("a", "b");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "same bits: 5 frames, 5 surfaces\n");
  outcome = compare("a/checkpoint", "b/checkpoint");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "same bits: 1 frame\n");
}

TEST_F(cli_compare, finds_the_particle_that_moved_and_by_how_much) {
  make_runs();
  move("b", 2, 77, 0.25f);
  move("b", 3, 12, 0.125f);
  Outcome outcome = compare("a", "b", {"--json", "--csv", at("rows.csv")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("differ"), std::string::npos) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("same_bits"), false);
  EXPECT_EQ(json.at("first_frame_that_differs"), 2);
  EXPECT_EQ(json.at("frames").at(1).at("same_bits"), true);
  const auto& frame = json.at("frames").at(2);
  EXPECT_NEAR(frame.at("largest").get<double>(), 0.25, 1e-6);
  EXPECT_NEAR(frame.at("rms").get<double>(), 0.25 / std::sqrt(125.0), 1e-7);
  EXPECT_EQ(frame.at("particle"), 77);
  EXPECT_EQ(frame.at("body"), "cube");
  EXPECT_EQ(frame.at("surface").at("same_bits"), true) << "which was not drawn anew";
  const std::string rows = read_text(at("rows.csv"));
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 6);
  outcome = compare("a", "b");
  EXPECT_NE(
      outcome.out.find("first frame that differs: 2\nlargest distance: 0.25 h in frame 2, particle 77 of "
                       "cube\n"),
      std::string::npos)
      << outcome.out;
  EXPECT_EQ(compare("a", "b", {"--tolerance", "0.26h"}).exit_code, 0);
  EXPECT_EQ(compare("a", "b", {"--tolerance", "0.24h"}).exit_code, 1);
  EXPECT_EQ(compare("a", "b", {"--tolerance", "0.26"}).exit_code, 0);
}

TEST_F(cli_compare, measures_the_distance_of_surfaces) {
  make_runs();
  Mesh mesh = read_mesh(at("b/surface/frame_000001.ply"));
  for (Vec3& vertex : mesh.vertices) vertex.z() += 20;
  write_mesh_ply(at("b/surface/frame_000001.ply"), mesh);
  const Outcome outcome = compare("a", "b", {"--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  const nlohmann::json frame = nlohmann::json::parse(outcome.out).at("frames").at(1);
  EXPECT_EQ(frame.at("same_bits"), true);
  EXPECT_NEAR(frame.at("surface").at("largest").get<double>(), 20, 0.5)
      << "its bottom is 20 h above the other's";
}

TEST_F(cli_compare, frames_and_particles_that_one_lacks_are_a_difference) {
  make_runs();
  ParticleFrame fewer = read_particles(particles("b", 4));
  for (std::uint64_t id = 0; id < 125; ++id)
    if (id != 3) fewer.ids.push_back(id);
  for (auto* vectors : {&fewer.positions, &fewer.velocities}) vectors->erase(vectors->begin() + 3);
  fewer.bodies.erase(fewer.bodies.begin() + 3);
  write_particles(particles("b", 4), fewer);
  Outcome outcome = compare("a", "b", {"--tolerance", "1000h"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("1 particles only in A, 0 only in B"), std::string::npos) << outcome.out;
  fs::remove(particles("b", 4));
  outcome = compare("a", "b");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("only in A: 1 frame"), std::string::npos) << outcome.out;
}

TEST_F(cli_compare, takes_frames_of_particles_alone) {
  make_runs();
  const Outcome outcome = run_mallow({"compare", particles("a", 0).string(), particles("b", 1).string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find(" cube "), std::string::npos) << "its run tells names and spacings";
  fs::copy(particles("a", 0), at("x.ply"));
  EXPECT_EQ(compare("x.ply", "a/particles/frame_000000.ply").exit_code, 0) << "the other one tells";
  Outcome alone = compare("x.ply", "x.ply");
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_NE(alone.err.find("--spacing: is needed"), std::string::npos) << alone.err;
  EXPECT_EQ(compare("x.ply", "x.ply", {"--spacing", "1"}).exit_code, 0);
}

TEST_F(cli_compare, says_where_two_samplings_of_one_body_are_compared) {
  make_runs();
  std::string scene = read_text(scene_);
  scene.replace(scene.find("count = [5, 5, 5], spacing = 1.0"), 32, "count = [6, 6, 6], spacing = 0.8");
  write("finer.toml", scene);
  ASSERT_EQ(
      run_mallow({"run", at("finer.toml"), "--no-images", "--frames", "1", "--out", at("finer")}).exit_code,
      0);
  const Outcome outcome = compare("a", "finer");
  EXPECT_NE(outcome.err.find(
                "are of different bodies: particles of cube are 1.000000 m apart in A and 0.800000 m in B"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(compare("a", "b").err, "");
}

TEST_F(cli_compare, takes_a_picture_of_where_they_differ_most) {
  make_runs();
  move("b", 2, 77, 0.25f);
  move("b", 3, 12, 0.5f);
  const Outcome outcome = compare("a", "b", {"--picture", at("most.png")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("most.png: frame 3 of B, from grey (as in A) to red (0.5 h from there)"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(read_text(at("most.png")).substr(1, 3), "PNG");
  ASSERT_EQ(compare("a", "b", {"--picture", at("again.png")}).exit_code, 1);
  EXPECT_TRUE(read_text(at("most.png")) == read_text(at("again.png")));
  ASSERT_EQ(compare("a", "a", {"--picture", at("same.png")}).exit_code, 0);
  EXPECT_FALSE(read_text(at("most.png")) == read_text(at("same.png"))) << "one ball is red";
  EXPECT_EQ(compare("a", "b", {"--picture", at("most.jpg")}).exit_code, 2);
}

TEST_F(cli_compare, refuses_what_cannot_be_compared) {
  make_runs();
  const auto refused = [&](const Outcome& outcome, const std::string& why) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
  };
  refused(compare("a", "nowhere"), "nowhere: is not there");
  refused(compare("a", "a/particles"), "holds no run of mallow");
  refused(compare("a", "b/checkpoint"), "is one state and");
  refused(compare("a/checkpoint", "cube.toml"), "cube.toml: cannot be compared: allowed are");
  refused(compare("a", "b", {"--tolerance", "-1h"}), "--tolerance: '-1h' is not allowed: a number >= 0");
  refused(compare("a", "b", {"--tolerance", "h"}), "is not allowed");
  refused(compare("a", "b", {"--csv", at("a/report.json")}), "--csv: would be written over");
}

TEST_F(cli_compare, reads_reports_that_name_no_materials) {
  make_runs();
  nlohmann::json report = read_json(at("a/report.json"));
  for (nlohmann::json& group : report.at("groups")) group.erase("material");
  write("a/report.json", report.dump());
  const Outcome outcome = compare("a", "b");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

/// A fine red cube goes into the first sink; then the second cuts the coarse blue bar, whose part takes the
/// red slot.
constexpr const char* k_slots = R"([solver]
support_radius = 2.1
gravity = [0.0, 0.0, 0.0]
[[material]]
name = "red"
[[material]]
name = "blue"
[[body]]
material = "red"
box = { count = [3, 3, 3], spacing = 0.8, corner = [0, 0, 0], jitter = 0 }
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
[render]
eye = [20.0, -60.0, 20.0]
target = [15.0, 0.0, 6.0]
width = 64
height = 36
samples = 1
)";

TEST_F(cli_compare, a_body_whose_slot_another_one_took_has_its_name_and_spacing_in_frames_that_show_it) {
  const std::string scene = write("slots.toml", k_slots).string();
  for (const char* out : {"a", "b"})
    ASSERT_EQ(run_mallow({"run", scene, "--out", at(out), "--no-images", "--no-surface"}).exit_code, 0);
  ASSERT_EQ(read_json(at("a/report.json")).at("groups")[0].at("name"), "body[1], part 2");
  move("b", 1, 3, 0.4f);
  const Outcome whole = compare("a", "b");
  EXPECT_NE(whole.out.find("largest distance: 0.5 h in frame 1, particle 3 of body[0]\n"), std::string::npos)
      << whole.out;
  const Outcome frame = compare("a/particles/frame_000001.ply", "b/particles/frame_000001.ply");
  EXPECT_NE(frame.out.find("particle 3 of body[0]\n"), std::string::npos) << frame.out;
  const nlohmann::json frames = nlohmann::json::parse(compare("a", "b", {"--json"}).out).at("frames");
  EXPECT_FALSE(frames[1].contains("kinetic_energy")) << "nobody knows the masses of the red body";
  EXPECT_TRUE(frames[9].contains("kinetic_energy"));
}

TEST_F(cli_compare, pictures_of_such_a_body_are_the_same_bytes_when_they_are_taken_again) {
  const std::string scene = write("slots.toml", k_slots).string();
  ASSERT_EQ(run_mallow({"run", scene, "--out", at("a"), "--no-surface"}).exit_code, 0);
  const std::string first = read_text(at("a/images/frame_000001.png"));
  ASSERT_EQ(run_mallow({"render", at("a")}).exit_code, 0);
  EXPECT_TRUE(read_text(at("a/images/frame_000001.png")) == first) << "balls are as large";
}

}  // namespace compare_test
}  // namespace mallow::test
