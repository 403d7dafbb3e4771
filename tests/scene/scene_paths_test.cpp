#include "scene/scene_fixture.h"

namespace mallow {
namespace scene_paths_test {

/// What a scene may name: a file in its folder or below, or below a folder that is marked.
class scene_paths : public SceneFixture {
 protected:
  scene_paths() {
    std::filesystem::create_directories(folder_ / "project/scenes");
    std::filesystem::create_directories(folder_ / "project/data");
    for (const char* name : {"points.csv", "project/data/points.csv", "project/scenes/points.csv"})
      write(name, "x,y,z\n1,2,3\n");
  }

  static std::string text_of(const std::string& file) {
    return "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"jelly\"\n[[body]]\nmaterial = \"jelly\"\n"
           "points = { file = \"" +
           file + "\", spacing = 1.0 }\n";
  }

  /// What is wrong with a scene in project/scenes that names this file.
  std::vector<std::string> problems_of(const std::string& file,
                                       const std::vector<std::string>& overrides = {},
                                       const SceneReadOptions& options = {}) const {
    try {
      read_scene(write("project/scenes/scene.toml", text_of(file)), overrides, options);
    } catch (const ConfigError& error) {
      return shown(error);
    }
    return {};
  }

  /// That and nothing else, also where the file is not there: what lies outside is not looked at.
  static std::vector<std::string> refused(const std::string& file, const std::string& root) {
    return {"project/scenes/scene.toml:7:19: body[0].points.file: \"" + file +
            "\" is not allowed: a file below " + root +
            ", unless paths outside are allowed (--allow-outside-paths)"};
  }
};

TEST_F(scene_paths, lie_in_its_folder_or_below) {
  EXPECT_EQ(problems_of("points.csv"), std::vector<std::string>{});
  EXPECT_EQ(problems_of("../scenes/points.csv"), std::vector<std::string>{});
  EXPECT_EQ(problems_of((folder_ / "project/scenes/points.csv").string()), std::vector<std::string>{});
  for (const char* file : {"../data/points.csv", "../../points.csv", "/etc/passwd", "/no/such/file", "..",
                           "../scenes_too/points.csv"})
    EXPECT_EQ(problems_of(file), refused(file, "project/scenes")) << file;
}

TEST_F(scene_paths, are_not_reached_by_links) {
  std::filesystem::create_symlink("../data/points.csv", folder_ / "project/scenes/link.csv");
  std::filesystem::create_directory_symlink("../data", folder_ / "project/scenes/link");
  std::filesystem::create_symlink("points.csv", folder_ / "project/scenes/own.csv");
  std::filesystem::create_symlink("round.csv", folder_ / "project/scenes/round.csv");
  for (const char* file : {"link.csv", "link/points.csv", "round.csv"})
    EXPECT_EQ(problems_of(file), refused(file, "project/scenes")) << file;
  EXPECT_EQ(problems_of("own.csv"), std::vector<std::string>{});
}

TEST_F(scene_paths, lie_below_the_nearest_marked_folder) {
  write("project/.mallow-root", "");
  EXPECT_EQ(problems_of("../data/points.csv"), std::vector<std::string>{});
  EXPECT_EQ(problems_of("../../points.csv"), refused("../../points.csv", "project"));
  write("project/scenes/.mallow-root", "");
  EXPECT_EQ(problems_of("../data/points.csv"), refused("../data/points.csv", "project/scenes"));
}

TEST_F(scene_paths, lie_anywhere_where_that_is_allowed_or_typed) {
  EXPECT_EQ(problems_of("../../points.csv", {}, {.allow_outside_paths = true}), std::vector<std::string>{});
  EXPECT_EQ(problems_of("points.csv", {"body[0].points.file=../../points.csv"}), std::vector<std::string>{});
}

TEST_F(scene_paths, are_found_from_a_scene_without_a_folder) {
  const auto before = std::filesystem::current_path();
  write("project/scenes/scene.toml", text_of("points.csv"));
  write("project/scenes/other.toml", text_of("../data/points.csv"));
  std::filesystem::current_path(folder_ / "project/scenes");
  EXPECT_NO_THROW(read_scene("scene.toml"));
  EXPECT_THROW(read_scene("other.toml"), ConfigError);
  std::filesystem::current_path(before);
}

}  // namespace scene_paths_test
}  // namespace mallow
