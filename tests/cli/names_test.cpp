#include <unistd.h>
#include <nlohmann/json.hpp>

#include <csignal>

#include "cli/program.h"
#include "mallow/files.h"
#include "program/external_program.h"

namespace mallow::test {
namespace names_test {

namespace fs = std::filesystem;

/// Folders and files of names that are legal, if unwise: each means something to a shell, a format string,
/// ffmpeg, TOML, XML or HTML.
class cli_names : public CliTest {
 protected:
  static inline const std::vector<std::string> k_names = {
      "-f %06d %% %s 100%",  "it's \"quoted\" `x` $HOME \\ back\\slash",
      "new\nline\ttab",      "\xC3\xBC\xC3\xB6\xC3\xA4 <&amp;> #?*[]{}|;:=,@",
      std::string(255, 'n'),
  };

  void expect_done(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_mallow(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
};

std::string in_toml(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n' || c == '\t')
      quoted += c == '\n' ? "\\n" : "\\t";
    else
      quoted += c;
  }
  return '"' + quoted + '"';
}

std::string short_name(const std::string& name, const char* ending) {
  return name.substr(0, 255 - std::string(ending).size()) + ending;
}

TEST_F(cli_names, do_not_matter_to_any_command) {
  const bool film = program::is_installed("ffmpeg");
  for (const std::string& name : k_names) {
    SCOPED_TRACE(name);
    const fs::path folder = folder_ / name;
    fs::create_directory(folder);
    const std::string points = short_name(name, ".csv");
    write((fs::path(name) / points).string(),
          "x,y,z\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n0,0,2\n1,0,2\n0,1,2\n1,1,2\n");
    const std::string scene = (folder / short_name(name, ".toml")).string();
    write((fs::path(name) / short_name(name, ".toml")).string(),
          "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"a\"\nalpha = 0.5\n[[body]]\nmaterial = "
          "\"a\"\n"
          "points = { file = " +
              in_toml(points) +
              ", spacing = 1.0 }\n[surface]\nvoxels = 8\n[render]\nwidth = 32\nheight = 18\nsamples = 1\n");
    const std::string out = (folder_ / "out" / name).string();
    std::vector<std::string> command = {"run",
                                        scene,
                                        "--out",
                                        out,
                                        "--frames",
                                        "1",
                                        "--threads",
                                        "1",
                                        "--report",
                                        (folder / short_name(name, ".json")).string(),
                                        "--checkpoint-every",
                                        "1"};
    if (film) command.insert(command.end(), {"--film", (folder / short_name(name, ".mp4")).string()});
    expect_done(command);
    expect_done({"run", "--resume", out, "--frames", "2"});
    expect_done({"surface", out});
    expect_done({"render", out});
    expect_done({"export", out, "--surface", "obj,vtp,usda", "--particles", "vtp", "--out",
                 (folder / "export").string()});
    EXPECT_EQ(names_in(out + "/images").size(), 3u);
    EXPECT_EQ(fs::exists(out + "/film.mp4"), film);
    EXPECT_EQ(fs::exists(folder / short_name(name, ".mp4")), film);
    for (const char* file :
         {"surface/frame_000002.obj", "surface/frame_000002.vtp", "surface.pvd", "surface.usda"})
      EXPECT_TRUE(fs::exists(folder / "export" / file)) << file;
    expect_done({"run", out + "/scene.toml", "--allow-outside-paths", "--frames", "1"});
    fs::remove_all(folder);
  }
}

TEST_F(cli_names, of_files_may_begin_like_an_option) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  fs::create_directory("-x");
  fs::copy_file("cube.toml", "-x/cube.toml");
  expect_done({"run", "--out=-x/out", "--frames", "1", "--", "-x/cube.toml"});
  expect_done({"render", "--film=-x/film.mp4", "--", "-x/out"});
  EXPECT_EQ(fs::exists("-x/film.mp4"), program::is_installed("ffmpeg"));
  fs::current_path(before);
}

TEST_F(cli_names, that_no_scene_can_hold_are_refused_before_the_run) {
  const std::string latin1 = "\xFC.csv";
  write(latin1, "x,y,z\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n");
  const std::string scene = write("points.toml",
                                  "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"a\"\n[[body]]\n"
                                  "material = \"a\"\npoints = { file = \"points.csv\", spacing = 1.0 }\n")
                                .string();
  fs::create_symlink(at(latin1), at("points.csv"));
  EXPECT_EQ(run_mallow({"run", scene, "--out", at("out"), "--frames", "0", "--no-images"}).exit_code, 0);
  fs::create_directory(at("\xFC"));
  fs::rename(at("points.csv"), at("\xFC/points.csv"));
  fs::rename(scene, at("\xFC/points.toml"));
  const Outcome outcome =
      run_mallow({"run", at("\xFC/points.toml"), "--out", at("again"), "--allow-outside-paths"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("is not UTF-8"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(at("again")));
}

TEST_F(cli_names, are_pasted_into_a_shell_as_they_are_printed) {
  const std::string out = at("it's \"100%\" $HOME");
  Running running({"run", scene_, "--out", out, "--no-images", "--no-surface", "--frames", "1000000"});
  while (running.alive() && names_in(out + "/particles").size() < 2) ::usleep(1000);
  running.send(SIGINT);
  const std::string said = running.wait().err;
  const std::size_t at_command = said.find("mallow run --resume ");
  ASSERT_NE(at_command, std::string::npos) << said;
  const std::string word = said.substr(at_command + 20, said.find('\n', at_command) - at_command - 20);
  EXPECT_EQ(word, "'" + at("it") + "'\\''s \"100%\" $HOME'");
}

}  // namespace names_test
}  // namespace mallow::test
