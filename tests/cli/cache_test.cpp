#include <sys/mount.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "cli/program.h"
#include "mallow/files.h"

namespace mallow::test {
namespace cache_test {

namespace fs = std::filesystem;
using cli_cache = CliTest;

const std::vector<std::string> k_three_surfaces = {"frame_000000.ply", "frame_000001.ply",
                                                   "frame_000002.ply"};
const std::vector<std::string> k_three_images = {"frame_000000.png", "frame_000001.png", "frame_000002.png"};

TEST_F(cli_cache, holds_particles_surfaces_pictures_report_and_summary) {
  const Outcome outcome = run({"--out", at("out"), "--no-film"}, true);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_in(at("out")),
            (std::vector<std::string>{".mallow-run", ".mallow-share", "checkpoint", "images", "particles",
                                      "report.json", "scene.toml", "summary.html", "surface"}));
  EXPECT_EQ(names_in(at("out/particles")), k_three_surfaces);
  EXPECT_EQ(names_in(at("out/surface")), k_three_surfaces);
  EXPECT_EQ(names_in(at("out/images")), k_three_images);
  EXPECT_EQ(why_not_closed(read_mesh(at("out/surface/frame_000002.ply"))), "");
  const std::string summary = read_text(at("out/summary.html"));
  for (const char* word : {"images/frame_000002.png", "region_sums", "pictures", "state hash", "<svg"}) {
    EXPECT_NE(summary.find(word), std::string::npos) << word;
  }
}

TEST_F(cli_cache, surfaces_drawn_again_are_the_same_bytes) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const std::string first = read_text(at("out/surface/frame_000002.ply"));
  fs::remove_all(at("out/surface"));
  const Outcome outcome = run_mallow({"surface", at("out"), "--threads", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_in(at("out/surface")), k_three_surfaces);
  EXPECT_EQ(read_text(at("out/surface/frame_000002.ply")), first);
}

TEST_F(cli_cache, pictures_taken_again_are_the_same_bytes) {
  ASSERT_EQ(run({"--out", at("out"), "--no-film"}, true).exit_code, 0);
  const std::string first = read_text(at("out/images/frame_000002.png"));
  fs::remove_all(at("out/images"));
  const Outcome outcome = run_mallow({"render", at("out"), "--no-film"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_in(at("out/images")), k_three_images);
  EXPECT_EQ(read_text(at("out/images/frame_000002.png")), first);
}

TEST_F(cli_cache, settings_of_surface_and_render_can_change_and_are_kept) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const std::size_t coarse = read_mesh(at("out/surface/frame_000000.ply")).vertices.size();
  ASSERT_EQ(run_mallow({"surface", at("out"), "--set", "surface.voxels=32"}).exit_code, 0);
  EXPECT_GT(read_mesh(at("out/surface/frame_000000.ply")).vertices.size(), 3 * coarse);
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film", "--set", "render.width=32"}).exit_code, 0);
  const std::string scene = read_text(at("out/scene.toml"));
  EXPECT_NE(scene.find("voxels = 32"), std::string::npos);
  EXPECT_NE(scene.find("width = 32"), std::string::npos);
}

TEST_F(cli_cache, each_surfacing_changes_what_the_run_drew_and_not_what_the_last_one_did) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  const auto draw = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {"surface", at("out"), "--threads", "1"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_text(at("out/surface/frame_000002.ply"));
  };
  const std::string as_run = read_text(at("out/surface/frame_000002.ply"));
  const std::string fine = draw({"surface.voxel_size=0.3"});
  EXPECT_NE(fine, as_run);
  EXPECT_NE(read_text(at("out/scene.toml")).find("voxel_size = 0.3"), std::string::npos);
  // The scene says voxels; voxel_size would count before it.
  const std::string coarse = draw({"surface.voxels=12"});
  EXPECT_NE(coarse, fine);
  EXPECT_EQ(read_text(at("out/scene.toml")).find("voxel_size = 0.3"), std::string::npos);
  EXPECT_EQ(draw({"surface.voxels=12"}), coarse);
  // Pictures in between change nothing of it.
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film", "--set", "render.width=32"}).exit_code, 0);
  EXPECT_EQ(draw({}), as_run);
  EXPECT_NE(read_text(at("out/scene.toml")).find("width = 32"), std::string::npos);
  // What a user writes into the scene by hand is as good as run.
  std::string scene = read_text(at("out/scene.toml"));
  scene.replace(scene.find("voxels = 16"), 11, "voxels = 12");
  write("out/scene.toml", scene);
  EXPECT_EQ(draw({}), coarse);
}

TEST_F(cli_cache, each_rendering_changes_what_the_run_showed_and_not_what_the_last_one_did) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film"}).exit_code, 0);
  const std::string picture = at("out/images/frame_000002.png"), as_run = read_text(picture);
  ASSERT_FALSE(as_run.empty());
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film", "--set", "render.width=32"}).exit_code, 0);
  EXPECT_NE(read_text(picture), as_run);
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film", "--set", "render.field_of_view=20"}).exit_code, 0);
  EXPECT_EQ(read_text(at("out/scene.toml")).find("width = 32"), std::string::npos);
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film"}).exit_code, 0);
  EXPECT_EQ(read_text(picture), as_run);
}

TEST_F(cli_cache, motion_cannot_be_changed_afterwards) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  const Outcome outcome = run_mallow({"surface", at("out"), "--set", "solver.time_step=0.1"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("only keys of surface"), std::string::npos) << outcome.err;
}

TEST_F(cli_cache, scene_of_the_cache_runs_from_where_it_is) {
  write("points.csv", "x,y,z\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n");
  const std::string scene = write("points.toml",
                                  "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"a\"\n[[body]]\n"
                                  "material = \"a\"\npoints = { file = \"points.csv\", spacing = 1.0 }\n")
                                .string();
  const std::vector<std::string> what = {"--no-images", "--no-surface", "--frames", "1"};
  std::vector<std::string> first = {"run", scene, "--out", at("deep/er/out")};
  first.insert(first.end(), what.begin(), what.end());
  ASSERT_EQ(run_mallow(first).exit_code, 0);
  std::vector<std::string> second = {"run", at("deep/er/out/scene.toml"), "--out", at("out")};
  second.insert(second.end(), what.begin(), what.end());
  // The points lie outside of the cache's folder, which a scene may name only where that is allowed.
  const Outcome refused = run_mallow(second);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("body[0].points.file: \"../../../points.csv\" is not allowed: a file below"),
            std::string::npos)
      << refused.err;
  EXPECT_NE(refused.err.find("--allow-outside-paths"), std::string::npos) << refused.err;
  second.emplace_back("--allow-outside-paths");
  const Outcome outcome = run_mallow(second);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_json(at("deep/er/out/report.json")).at("state_hash"),
            read_json(at("out/report.json")).at("state_hash"));
}

TEST_F(cli_cache, with_a_report_that_is_none_is_refused) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  for (const std::string& report :
       {std::string("{"), std::string(1'000'000, '['), std::string("{\"groups\": 3}")}) {
    write("out/report.json", report);
    const Outcome outcome = run_mallow({"surface", at("out")});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("report.json: "), std::string::npos) << outcome.err;
  }
}

TEST_F(cli_cache, a_folder_in_use_is_left_alone) {
  ASSERT_EQ(run({"--out", at("out"), "--no-surface"}).exit_code, 0);
  const std::string report = read_text(at("out/report.json"));
  const Outcome outcome = run({"--out", at("out"), "--no-surface", "--frames", "1"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--overwrite"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_text(at("out/report.json")), report);
  EXPECT_EQ(names_in(at("out/particles")), k_three_surfaces);
}

TEST_F(cli_cache, overwrite_removes_what_mallow_wrote_and_nothing_else) {
  ASSERT_EQ(run({"--out", at("out")}).exit_code, 0);
  write("out/notes.txt", "mine");
  write("out/surface/frame_final.ply", "mine");
  ASSERT_EQ(run({"--out", at("out"), "--overwrite", "--no-surface", "--frames", "1"}).exit_code, 0);
  EXPECT_EQ(names_in(at("out/particles")).size(), 2u);
  EXPECT_EQ(names_in(at("out/surface")), std::vector<std::string>{"frame_final.ply"});
  EXPECT_EQ(read_text(at("out/notes.txt")), "mine");
}

TEST_F(cli_cache, overwrite_refuses_a_folder_that_holds_no_run) {
  fs::create_directory(at("home"));
  write("home/report.json", "mine");
  const Outcome outcome = run({"--out", at("home"), "--overwrite"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("no .mallow-run"), std::string::npos) << outcome.err;
  EXPECT_EQ(names_in(at("home")), std::vector<std::string>{"report.json"});
  EXPECT_EQ(read_text(at("home/report.json")), "mine");
}

/// A disk of one MiB, for those who may mount one.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path folder) : folder_(std::move(folder)) {
    fs::create_directory(folder_);
    mounted_ = ::mount("none", folder_.c_str(), "tmpfs", 0, "size=1m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount(folder_.c_str());
  }
  bool mounted() const { return mounted_; }

 private:
  fs::path folder_;
  bool mounted_;
};

TEST_F(cli_cache, a_full_disk_leaves_only_whole_files) {
  const SmallDisk disk(at("disk"));
  if (!disk.mounted()) GTEST_SKIP() << "only root can mount a small disk";
  const Outcome outcome = run({"--out", at("disk/out"), "--frames", "2000", "--set", "run.frame_time=0.15"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("No space left"), std::string::npos) << outcome.err;

  const std::vector<std::string> frames = names_in(at("disk/out/particles"));
  EXPECT_GT(frames.size(), 3u);
  for (const std::string& name : frames) {
    EXPECT_EQ(read_particles(folder_ / "disk/out/particles" / name).positions.size(), 125u) << name;
  }
  const std::vector<std::string> surfaces = names_in(at("disk/out/surface"));
  for (const std::string& name : surfaces) {
    EXPECT_EQ(why_not_closed(read_mesh(folder_ / "disk/out/surface" / name)), "") << name;
  }
  // Frames are written behind the simulation's back; none may be counted that did not get to the disk.
  const nlohmann::json report = read_json(at("disk/out/report.json"));
  EXPECT_EQ(report.at("complete"), false);
  const bool report_still_fitted = report.at("steps") != 0;
  if (report_still_fitted) {
    EXPECT_EQ(report.at("frames").get<std::size_t>() + 1, std::min(frames.size(), surfaces.size()));
    EXPECT_NE(report.at("error").get<std::string>().find("No space left"), std::string::npos);
  }
}

}  // namespace cache_test
}  // namespace mallow::test
