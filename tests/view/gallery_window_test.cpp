#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "view/viewer_program.h"

namespace mallow {
namespace view_gallery_test {

namespace fs = std::filesystem;
using test::play;
using test::Played;

const fs::path k_scenes = fs::path(MALLOW_DATA_DIR) / "scenes";

TEST(view_gallery, takes_pictures_of_scenes_and_keeps_them) {
  if (const std::string why = test::why_no_window(); !why.empty()) GTEST_SKIP() << why;
  const fs::path scenes = test::scratch() / "scenes";
  fs::create_directories(scenes);
  fs::copy_file(k_scenes / "cube.toml", scenes / "cube.toml", fs::copy_options::overwrite_existing);
  const Played played = play({"--scenes", scenes.string()},
                             "pictures 2\nthumbnails\npictures 2\nscreenshot gallery.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  const auto kept = fs::recursive_directory_iterator(test::scratch() / "cache");
  EXPECT_EQ(std::count_if(begin(kept), end(kept),
                          [](const auto& entry) { return entry.path().extension() == ".ppm"; }),
            1);
}

class view_every_scene : public testing::TestWithParam<std::string> {};

/// 120 take half an hour for all scenes (tests/view/campaign); a few show that each opens, steps and is
/// drawn.
std::string frames_to_play() {
  const char* const frames = std::getenv("MALLOW_VIEW_FRAMES");
  return frames ? frames : "5";
}
int seconds_to_play() {
  const char* const seconds = std::getenv("MALLOW_VIEW_SECONDS");
  return seconds ? std::atoi(seconds) : 600;
}

TEST_P(view_every_scene, plays) {
  if (const std::string why = test::why_no_window(); !why.empty()) GTEST_SKIP() << why;
  const Played played =
      play({(k_scenes / GetParam()).string(), "--width", "320", "--height", "240"},
           "ready\nkey =\nframes " + frames_to_play() + "\nstatus\nclose\n", seconds_to_play());
  if (played.exit_code == 2 && played.out.find("meshes") != std::string::npos)
    GTEST_SKIP() << "its mesh is not there: tools/fetch_meshes";
  EXPECT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("failed 0"), std::string::npos) << played.out;
  RecordProperty("status_line", played.out.substr(std::min(played.out.size(), played.out.find("status "))));
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(k_scenes))
    if (entry.path().extension() == ".toml") names.push_back(fs::relative(entry.path(), k_scenes).string());
  std::ranges::sort(names);
  return names;
}
INSTANTIATE_TEST_SUITE_P(scenes, view_every_scene, testing::ValuesIn(scene_names()),
                         [](const testing::TestParamInfo<std::string>& scene) {
                           std::string name = scene.param;
                           std::ranges::replace_if(
                               name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
                               '_');
                           return name;
                         });

}  // namespace view_gallery_test
}  // namespace mallow
