#include <algorithm>

#include "scene/scene_fixture.h"

namespace mallow {
namespace warnings_test {

using scene_warnings = SceneFixture;

/// A body of a spacing under a gravity, in a film of 30 frames; `run`: lines of that section.
std::string falling(const std::string& spacing, const std::string& radius, const std::string& gravity,
                    const std::string& run) {
  return "[solver]\nsupport_radius = " + radius + "\ngravity = [0, 0, " + gravity +
         "]\n[[material]]\nname = \"jelly\"\nalpha = 0.3\nrest_density = 1000.0\n[[body]]\nmaterial = "
         "\"jelly\"\nbox = { count = [4, 4, 4], spacing = " +
         spacing + ", corner = [0, 0, 0] }\n[run]\nframes = 30\n" + run;
}

std::vector<std::string> warnings_of(const Scene& scene) {
  return warnings(scene, build(scene, 1).info());
}

TEST_F(scene_warnings, name_a_film_that_is_many_times_slower_than_real_time_and_the_frame_time_that_is_not) {
  const auto slow = warnings_of(read(falling("0.003", "0.0063", "-9.81", "")));
  ASSERT_EQ(slow.size(), 1u);
  EXPECT_EQ(
      slow[0],
      "run: 30 frames of 0.00143674 s cover 0.0431022 s, and the film of them takes 1 s, 23 times slower; "
      "frame_time = 0.0333333 shows real time");
  EXPECT_TRUE(warnings_of(read(falling("0.003", "0.0063", "-9.81", "frame_time = 0.0333333\n"))).empty());
  EXPECT_EQ(warnings_of(read(falling("0.1", "0.21", "-9.81", ""))).size(), 1u)
      << "four times, without a word";
  EXPECT_TRUE(warnings_of(read(falling("0.1", "0.21", "-9.81", "frame_time = 0.008\n"))).empty())
      << "as asked";
  EXPECT_TRUE(warnings_of(read(falling("1.0", "2.1", "-0.3", ""))).empty()) << "free units";
}

TEST_F(scene_warnings, name_frames_in_which_nothing_moves_a_spacing_far) {
  const auto still = warnings_of(read(falling("1.0", "2.1", "-0.3", "frame_time = 0.01\n")));
  ASSERT_EQ(still.size(), 1u);
  EXPECT_EQ(
      still[0],
      "run: 30 frames of 0.01 s cover 0.3 s, in which nothing falls or flies farther than 0.0135 m, less "
      "than the spacing of 1 m; give more frames, or a longer frame_time");
}

}  // namespace warnings_test
}  // namespace mallow
