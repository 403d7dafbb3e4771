#include "cli/program.h"

#include <nlohmann/json.hpp>

namespace mallow::test {
namespace inputs_test {

namespace fs = std::filesystem;
using cli_inputs = CliTest;

const std::vector<std::string> k_quick = {"--no-surface", "--no-images", "--frames", "1"};

/// A scene of four points in a file.
std::string points_scene(const std::string& file) {
  return "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"a\"\n[[body]]\nmaterial = \"a\"\n"
         "points = { file = \"" +
         file + "\", spacing = 1.0 }\n";
}
constexpr const char* k_points = "x,y,z\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n";
constexpr const char* k_tetrahedron =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n"
    "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

Outcome quick_run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), k_quick.begin(), k_quick.end());
  return run_mallow(arguments);
}

void expect_refused(const Outcome& outcome, const std::string& word) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find(word), std::string::npos) << "'" << word << "' is not in: " << outcome.err;
}

TEST_F(cli_inputs, columns_of_points_that_nothing_reads_are_told_once) {
  write("p.csv", "x,y,z,Time\n0,0,1,7\n1,0,1,7\n0,1,1,7\n1,1,1,7\n");
  const std::string note = "body[0].points: p.csv: column 'Time' is not read; those that are: x, y, z, ";
  const Outcome ran = quick_run({write("points.toml", points_scene("p.csv")).string(), "--out", at("out")});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_NE(ran.err.find(note), std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find(note), ran.err.rfind(note)) << ran.err;
  write("p.csv", "x,y,z,youngs_modulus\n0,0,1,7\n");
  const Outcome refused = quick_run({at("points.toml"), "--out", at("other")});
  expect_refused(refused, "p.csv:1:");
  expect_refused(refused, "give 'stiffness', a factor on the youngs_modulus of the material");
}

TEST_F(cli_inputs, a_scene_is_never_replaced_by_its_run) {
  fs::create_directory(at("mine"));
  write("mine/scene.toml", read_text(scene_) + "# by hand\n");
  const std::string text = read_text(at("mine/scene.toml"));
  expect_refused(quick_run({at("mine/scene.toml"), "--out", at("mine")}), "is not empty");
  expect_refused(quick_run({at("mine/scene.toml"), "--out", at("mine"), "--overwrite"}), "no .mallow-run");
  // Nor beside a report that looks like a run's.
  ASSERT_EQ(quick_run({at("mine/scene.toml"), "--report", at("mine/report.json")}).exit_code, 0);
  expect_refused(quick_run({at("mine/scene.toml"), "--out", at("mine"), "--overwrite"}), "no .mallow-run");
  EXPECT_EQ(read_text(at("mine/scene.toml")), text);
  EXPECT_EQ(names_in(at("mine")), (std::vector<std::string>{"report.json", "scene.toml"}));
}

TEST_F(cli_inputs, of_a_run_in_its_folder_are_kept_whatever_they_are_called) {
  ASSERT_EQ(quick_run({scene_, "--out", at("out")}).exit_code, 0);
  const std::string scene = read_text(at("out/scene.toml"));
  fs::create_hard_link(at("out/scene.toml"), at("hard.toml"));
  fs::create_symlink(at("out/scene.toml"), at("soft.toml"));
  fs::create_directory_symlink(at("out"), at("link"));
  for (const std::string given : {"out/scene.toml", "out/../out/scene.toml", "hard.toml", "soft.toml"})
    for (const std::string folder : {"out", "link", "link/../out/."})
      expect_refused(quick_run({at(given), "--out", at(folder), "--overwrite"}), "would be written over");
  write("next.toml", points_scene("out/particles/frame_000001.ply"));
  expect_refused(quick_run({at("next.toml"), "--out", at("out"), "--overwrite"}),
                 "out/particles/frame_000001.ply: --out: would be written over");
  EXPECT_EQ(read_text(at("out/scene.toml")), scene);
  EXPECT_EQ(names_in(at("out/particles")).size(), 2u);
  // What only lies in the folder is in nobody's way.
  write("out/other.toml", read_text(scene_));
  ASSERT_EQ(quick_run({at("out/other.toml"), "--out", at("out"), "--overwrite"}).exit_code, 0);
  EXPECT_EQ(read_text(at("out/other.toml")), read_text(scene_));
}

TEST_F(cli_inputs, are_refused_as_the_file_of_an_option) {
  write("points.csv", k_points);
  write("points.toml", points_scene("points.csv"));
  write("film.mp4", points_scene("points.csv"));
  fs::create_hard_link(at("points.csv"), at("hard.csv"));
  fs::create_symlink(at("points.toml"), at("soft.json"));
  fs::create_directory(at("deep"));
  for (const std::string option : {"--state-out", "--report"})
    for (const std::string file :
         {"points.csv", "points.toml", "hard.csv", "soft.json", "deep/../points.csv"})
      expect_refused(quick_run({at("points.toml"), option, at(file)}), option + ": would be written over");
  expect_refused(run_mallow({"run", at("film.mp4"), "--out", at("out"), "--film", at("film.mp4")}),
                 "--film: would be written over");
  EXPECT_EQ(read_text(at("points.csv")), k_points);
  EXPECT_EQ(read_text(at("points.toml")), points_scene("points.csv"));
  EXPECT_FALSE(fs::exists(at("out")));

  ASSERT_EQ(quick_run({at("points.toml"), "--out", at("out"), "--checkpoint-every", "1"}).exit_code, 0);
  expect_refused(run_mallow({"run", at("points.toml"), "--resume", at("out"), "--report", at("points.toml")}),
                 "--report: would be written over");
  write("export.toml", points_scene("exported/particles/frame_000001.csv"));
  fs::create_directories(at("exported/particles"));
  write("exported/particles/frame_000001.csv", k_points);
  ASSERT_EQ(quick_run({at("export.toml"), "--out", at("again")}).exit_code, 0);
  expect_refused(run_mallow({"export", at("again"), "--particles", "csv", "--out", at("exported")}),
                 "--out: would be written over");
  EXPECT_EQ(read_text(at("exported/particles/frame_000001.csv")), k_points);
}

TEST_F(cli_inputs, a_mesh_is_not_replaced_by_its_points) {
  write("mesh.ply", k_tetrahedron);
  fs::create_hard_link(at("mesh.ply"), at("same.ply"));
  for (const std::string out : {"mesh.ply", "same.ply"})
    expect_refused(run_mallow({"sample", at("mesh.ply"), "--count", "50", "--out", at(out)}),
                   "--out: would be written over");
  EXPECT_EQ(read_text(at("mesh.ply")), k_tetrahedron);
}

TEST_F(cli_inputs, a_file_that_is_there_is_replaced_where_that_is_asked_for_or_it_is_of_the_same_kind) {
  const std::string mine = "print('hours of work')\n";
  const auto is_kept = [&](const std::string& name, const std::string& option,
                           std::vector<std::string> arguments, bool overwrites) {
    SCOPED_TRACE(arguments.front() + " " + option);
    write(name, mine);
    arguments.insert(arguments.end(), {option, at(name)});
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(name + ": " + option + ": is there already, and was not written by " + option),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("--overwrite") != std::string::npos, overwrites) << outcome.err;
    EXPECT_EQ(read_text(at(name)), mine);
    if (!overwrites) return;
    arguments.push_back("--overwrite");
    for (const bool again : {false, true}) {
      const Outcome replaced = run_mallow(arguments);
      EXPECT_LE(replaced.exit_code, 1) << again << replaced.err;
      EXPECT_NE(read_text(at(name)), mine);
      if (name.ends_with(".png") || name.ends_with(".ply")) return;
      if (!again) arguments.pop_back();  // now it is what the option wrote before
    }
  };
  const std::vector<std::string> quick{"run", scene_, "--frames", "0", "--no-images", "--no-surface"};
  is_kept("gen.py", "--series", quick, true);
  is_kept("report.py", "--report", quick, true);
  is_kept("state.py", "--state-out", quick, true);
  write("mesh.ply", k_tetrahedron);
  const std::vector<std::string> sample{"sample", at("mesh.ply"), "--count", "50"};
  is_kept("points.csv", "--out", sample, true);
  is_kept("points.ply", "--out", sample, true);
  ASSERT_EQ(run({"--out", at("a"), "--frames", "2", "--checkpoint-every", "1"}).exit_code, 0);
  ASSERT_EQ(run({"--out", at("b"), "--frames", "2", "--set", "solver.gravity=[0,0,-1]"}).exit_code, 0);
  const std::vector<std::string> compare{"compare", at("a"), at("b")};
  is_kept("rows.csv", "--csv", compare, true);
  is_kept("most.png", "--picture", compare, true);
  for (const char* option : {"--series", "--report", "--state-out"})
    is_kept("resumed.py", option, {"run", "--resume", at("a"), "--frames", "3"}, false);
  write("film.mp4", mine);
  for (const std::vector<std::string>& film :
       {std::vector<std::string>{"render", at("a"), "--film", at("film.mp4")},
        std::vector<std::string>{"run", scene_, "--out", at("c"), "--film", at("film.mp4")}})
    expect_refused(run_mallow(film), "--film: is there already");
  EXPECT_EQ(read_text(at("film.mp4")), mine);
  EXPECT_FALSE(fs::exists(at("c")));
  EXPECT_EQ(quick_run({scene_, "--series", write("empty.csv", "").string()}).exit_code, 0);
}

TEST_F(cli_inputs, files_of_a_study_replace_those_of_a_study_alone) {
  fs::create_directory(at("site"));
  write("site/index.html", "mine");
  write("tuned.toml", "mine");
  expect_refused(run_mallow({"tradeoff", scene_, "--out", at("site")}),
                 "index.html: --out: is there already");
  expect_refused(run_mallow({"tune", scene_, "--error", "1h", "--out", at("site")}),
                 "--out: is there already");
  expect_refused(run_mallow({"tune", scene_, "--error", "1h", "--write", at("tuned.toml")}),
                 "tuned.toml: --write: is there already");
  EXPECT_EQ(read_text(at("site/index.html")), "mine");
  EXPECT_EQ(read_text(at("tuned.toml")), "mine");
  const std::vector<std::string> study{"tradeoff",     scene_,      "--budget",  "1s",
                                       "--repeats",    "1",         "--threads", "1",
                                       "--no-surface", "--no-film", "--out",     at("study")};
  for (const bool again : {false, true}) EXPECT_EQ(run_mallow(study).exit_code, 0) << again;
}

TEST_F(cli_inputs, no_file_is_written_twice_by_one_run) {
  fs::create_directory(at("b"));
  expect_refused(quick_run({scene_, "--report", at("a"), "--state-out", at("b/../a")}), "is also --report");
  fs::create_directory(at("out"));
  ASSERT_EQ(quick_run({scene_, "--out", at("out")}).exit_code, 0);
  expect_refused(quick_run({scene_, "--out", at("out"), "--overwrite", "--state-out", at("out/scene.toml")}),
                 "is also the run's scene.toml");
  EXPECT_EQ(
      quick_run({scene_, "--out", at("out"), "--overwrite", "--report", at("out/report.json")}).exit_code, 0);
}

TEST_F(cli_inputs, what_was_written_by_hand_into_the_scene_of_a_run_stays) {
  ASSERT_EQ(run({"--out", at("out"), "--frames", "1", "--checkpoint-every", "1"}).exit_code, 0);
  const std::string by_hand = "# mine\n" + read_text(at("out/scene.toml"));
  write("out/scene.toml", by_hand);
  ASSERT_EQ(run_mallow({"surface", at("out")}).exit_code, 0);
  ASSERT_EQ(run_mallow({"render", at("out"), "--no-film"}).exit_code, 0);
  ASSERT_EQ(run_mallow({"run", "--resume", at("out")}).exit_code, 0);
  EXPECT_EQ(read_text(at("out/scene.toml")), by_hand);

  // What would not be true of the run does not stay, and that is said.
  std::string untrue = by_hand;
  untrue.replace(untrue.find("alpha = 0.7"), 11, "alpha = 0.5");
  write("out/scene.toml", untrue);
  const Outcome outcome = run_mallow({"run", "--resume", at("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("scene.toml is put back"), std::string::npos) << outcome.err;
  EXPECT_NE(read_text(at("out/scene.toml")).find("alpha = 0.7"), std::string::npos);
}

TEST_F(cli_inputs, standard_output_that_is_a_file_is_not_replaced) {
  const Outcome outcome = quick_run({scene_, "--report", "/dev/stdout"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("/dev/stdout: leads to a file here"), std::string::npos) << outcome.err;
  EXPECT_TRUE(fs::is_symlink("/dev/stdout"));
}

}  // namespace inputs_test
}  // namespace mallow::test
