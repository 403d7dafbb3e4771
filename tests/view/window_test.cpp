#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "program/external_program.h"
#include "program/shell_word.h"
#include "view/viewer_program.h"

namespace mallow {
namespace view_window_test {

using test::Picture;
using test::play;
using test::Played;
using test::read_png;
using test::scratch;

const std::string k_cube = std::string(MALLOW_DATA_DIR) + "/scenes/cube.toml";

class view_window : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* const film : {"view.mp4", "view_2.mp4"}) {
      std::filesystem::remove(scratch() / film);
      std::filesystem::remove_all((scratch() / film).string() + ".frames");
    }
    if (const std::string why = test::why_no_window(); !why.empty()) GTEST_SKIP() << why;
  }
};

/// Share of bytes that differ by more than `most`.
double far_off(const Picture& a, const Picture& b, int most) {
  if (a.width != b.width || a.height != b.height || a.rgb.empty()) return 1;
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.rgb.size(); ++k) count += std::abs(a.rgb[k] - b.rgb[k]) > most ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(a.rgb.size());
}

/// The last number behind a word.
double number_behind(const std::string& text, const std::string& word) {
  const std::size_t at = text.rfind(word + " ");
  return at == text.npos ? std::nan("") : std::atof(text.c_str() + at + word.size() + 1);
}

TEST_F(view_window, draws_the_stored_picture) {
  const Played played = play({k_cube, "--paused", "--width", "320", "--height", "240", "--samples", "4"},
                             "ready\npictures 3\nscene drawn.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  const Picture drawn = read_png(scratch() / "drawn.png");
  const Picture stored = read_png(std::filesystem::path(MALLOW_VIEW_PICTURES) / "cube.png");
  EXPECT_LT(far_off(drawn, stored, 16), 0.01) << "drawn: " << scratch() / "drawn.png";
}

/// Where no graphics card draws, light is found at corners alone, and edges have one sample.
TEST_F(view_window, draws_nearly_the_same_with_one_sample_a_pixel) {
  const Played played = play({k_cube, "--paused", "--width", "320", "--height", "240", "--samples", "1"},
                             "ready\npictures 3\nscene plain.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  const Picture drawn = read_png(scratch() / "plain.png");
  const Picture stored = read_png(std::filesystem::path(MALLOW_VIEW_PICTURES) / "cube.png");
  EXPECT_LT(far_off(drawn, stored, 16), 0.004) << "drawn: " << scratch() / "plain.png";
}

TEST_F(view_window, a_grab_moves_what_it_should) {
  const std::string fall = "ready\nframes 60\nkey space\nsettled\nkey space\n";
  const std::string wait = "frames 40\nkey space\nsettled\ncenter\nclose\n";
  const Played free = play({k_cube}, fall + wait);
  const Played held = play({k_cube}, fall + "move 0.5 0.7\npress 0\nmove 0.5 0.2\n" + wait);
  ASSERT_EQ(free.exit_code, 0) << free.out;
  ASSERT_EQ(held.exit_code, 0) << held.out;
  const std::regex center("center (\\S+) (\\S+) (\\S+)");
  std::smatch of_free, of_held;
  ASSERT_TRUE(std::regex_search(free.out, of_free, center)) << free.out;
  ASSERT_TRUE(std::regex_search(held.out, of_held, center)) << held.out;
  EXPECT_GT(std::stod(of_held[3]), std::stod(of_free[3]) + 1.0) << "the cube is 8 m high";
}

TEST_F(view_window, is_resized_minimised_and_closed_while_it_steps) {
  const Played played =
      play({k_cube},
           "ready\nkey =\nresize 640 480\npictures 4\nstatus\nresize 200 150\npictures 4\n"
           "resize 1000 700\npictures 4\nstatus\nminimise\npictures 2\nrestore\npictures 2\nclose\n");
  EXPECT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("size 640 480"), std::string::npos) << played.out;
  EXPECT_NE(played.out.find("size 1000 700"), std::string::npos) << played.out;
}

TEST_F(view_window, keys_pause_step_go_back_reset_and_save) {
  const Played played =
      play({k_cube},
           "ready\nframes 20\nkey space\nsettled\nkey .\nsettled\nkey backspace\nsettled\n"
           "status\nkey r\nsettled\nstatus\nkey p\nsettled\nkey k\nsettled\nkey h\npictures 2\n"
           "key s\nsettled\nstatus\nkey c\npictures 2\nkey escape\npictures 2\nclose\n");
  EXPECT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("paused 1"), std::string::npos) << played.out;
  EXPECT_NE(played.out.find("time 0 frame 0 steps 0"), std::string::npos) << played.out;
  EXPECT_TRUE(std::filesystem::exists(scratch() / "view_cube" / "checkpoint")) << played.out;
}

TEST_F(view_window, every_slider_goes_once_through_its_range) {
  const Played played = play({k_cube, "--width", "320", "--height", "240"}, "ready\nsweep\nstatus\nclose\n");
  EXPECT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("sweep solver.time_step_factor"), std::string::npos);
  EXPECT_NE(played.out.find("sweep surface.voxels_per_spacing"), std::string::npos);
  EXPECT_GT(number_behind(played.out, "steps"), 0) << played.out;
  EXPECT_EQ(number_behind(played.out, "failed"), 0) << played.out;
}

TEST_F(view_window, a_scene_that_is_wrong_is_said_and_ends_with_2) {
  const Played played = play({"/nonexistent.toml"}, "close\n");
  EXPECT_EQ(played.exit_code, 2) << played.out;
  EXPECT_NE(played.out.find("/nonexistent.toml"), std::string::npos) << played.out;
}

TEST_F(view_window, a_folder_without_scenes_is_said_and_ends_with_2) {
  const std::filesystem::path empty = scratch() / "empty";
  std::filesystem::create_directories(empty);
  for (const std::string& folder : {std::string("/nonexistent"), empty.string()}) {
    const Played played = play({"--scenes", folder}, "close\n");
    EXPECT_EQ(played.exit_code, 2) << played.out;
    EXPECT_NE(played.out.find("'" + folder + "'"), std::string::npos) << played.out;
    EXPECT_NE(played.out.find("*.toml"), std::string::npos) << played.out;
  }
}

TEST_F(view_window, marks_show_pins_the_region_of_a_particle_and_contacts) {
  const std::string click = "move 0.5 0.5\npictures 2\npress 0\nrelease 0\nsettled\n";
  const Played played =
      play({k_cube},
           "ready\nkey =\nmark contacts\nframes 110\nkey space\nsettled\nscreenshot touching.png\nmarks\n"
           "mark contacts\nkey 7\n" +
               click + "marks\nkey 6\n" + click +
               "mark pins\nsettled\nmarks\nscreenshot pinned.png\n"
               "mark pins\nmark region\nsettled\nmarks\nscreenshot bare.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  const std::regex counts("marks pins (\\d+) region (\\d+) contacts (\\d+)");
  std::vector<std::array<int, 3>> seen;
  for (auto at = std::sregex_iterator(played.out.begin(), played.out.end(), counts);
       at != std::sregex_iterator(); ++at)
    seen.push_back({std::stoi((*at)[1]), std::stoi((*at)[2]), std::stoi((*at)[3])});
  ASSERT_EQ(seen.size(), 4u) << played.out;
  EXPECT_EQ(seen[0], (std::array{0, 0, 1})) << "the cube lies on the floor";
  EXPECT_EQ(seen[1][0], 0);
  EXPECT_GT(seen[1][1], 10) << "a region is of some dozen particles";
  EXPECT_EQ(seen[1][2], 0);
  EXPECT_GT(seen[2][0], 0);
  EXPECT_EQ(seen[3], (std::array{0, 0, 0}));
  const Picture bare = read_png(scratch() / "bare.png");
  for (const char* const marked : {"touching.png", "pinned.png"})
    EXPECT_GT(far_off(read_png(scratch() / marked), bare, 16), 1e-4) << marked;
}

TEST_F(view_window, a_film_holds_every_frame_of_the_scene_once) {
  const Played played =
      play({k_cube, "--width", "320", "--height", "240"},
           "ready\nkey space\nsettled\nkey f\nfilmed 8\npictures 2\nkey f\npictures 2\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  if (!program::is_installed("ffmpeg") || !program::is_installed("ffprobe")) {
    EXPECT_TRUE(std::filesystem::exists(scratch() / "view.mp4.frames" / "images")) << "as no ffmpeg is here";
    GTEST_SKIP() << "ffmpeg is not installed (Debian: ffmpeg): pictures were made, and no film";
  }
  const std::filesystem::path film = scratch() / "view.mp4";
  ASSERT_TRUE(std::filesystem::exists(film)) << played.out;
  EXPECT_FALSE(std::filesystem::exists(film.string() + ".frames")) << "pictures are joined, and taken away";
  const std::string probe =
      "ffprobe -v error -count_frames -select_streams v -of csv=p=0 -show_entries "
      "stream=nb_read_frames " +
      program::shell_word(film.string()) + " > " + program::shell_word((scratch() / "count.txt").string());
  ASSERT_EQ(std::system(probe.c_str()), 0);
  int count = 0;
  std::ifstream(scratch() / "count.txt") >> count;
  EXPECT_GE(count, 8);
  EXPECT_LE(count, 12) << "frames that ended until the key was read";
}

/// A scene whose steps take next to no time.
std::string tiny() {
  const std::filesystem::path file = scratch() / "tiny.toml";
  std::ofstream(file) << "[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = 'jelly'\n"
                         "box = { count = [4, 4, 4], spacing = 0.01, corner = [-0.035, -0.035, 0.1] }\n"
                         "[[collider]]\nplane = {}\n[run]\nframes = 60\nframe_time = 0.02\n";
  return file.string();
}

/// Pictures in a film; 0 where there is none.
int pictures_in(const std::filesystem::path& film) {
  const std::filesystem::path count = scratch() / "count.txt";
  const std::string probe =
      "ffprobe -v error -count_frames -select_streams v -of csv=p=0 -show_entries stream=nb_read_frames " +
      program::shell_word(film.string()) + " > " + program::shell_word(count.string());
  int pictures = 0;
  if (std::system(probe.c_str()) == 0) std::ifstream(count) >> pictures;
  return pictures;
}

bool can_look_into_films() {
  return program::is_installed("ffmpeg") && program::is_installed("ffprobe");
}

/// The small one steps far faster than a window draws; a hand turns the view meanwhile, which draws each
/// frame more than once.
TEST_F(view_window, a_film_holds_every_frame_once_in_a_window_that_waits_for_events) {
  const std::string turn =
      "press 1\nmove 0.3 0.3\npictures 3\nmove 0.5 0.4\npictures 3\nmove 0.4 0.3\nrelease 1\n";
  const Played played = play({tiny(), "--paused", "--width", "320", "--height", "240"},
                             "ready\nhand\nkey =\nkey f\nfilmed 40\n" + turn +
                                 "filmed 80\nfilm\n"
                                 "key f\npictures 1\njoined\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  const double pictures = number_behind(played.out, "film pictures");
  EXPECT_GE(pictures, 80);
  EXPECT_EQ(number_behind(played.out, "first"), 1) << played.out;
  EXPECT_EQ(number_behind(played.out, "last"), pictures) << played.out;
  EXPECT_EQ(number_behind(played.out, "of"), pictures) << "frames of the scene have ended\n" << played.out;
  if (!can_look_into_films()) GTEST_SKIP() << "ffmpeg is not installed (Debian: ffmpeg)";
  EXPECT_GE(pictures_in(scratch() / "view.mp4"), pictures) << played.out;
}

TEST_F(view_window, closed_while_it_records_it_makes_the_film_and_says_where) {
  if (!can_look_into_films()) GTEST_SKIP() << "ffmpeg is not installed (Debian: ffmpeg)";
  const Played played =
      play({tiny(), "--width", "320", "--height", "240"}, "ready\nkey f\nfilmed 9\nfilm\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("view.mp4"), std::string::npos) << played.out;
  EXPECT_FALSE(std::filesystem::exists(scratch() / "view.mp4.frames"));
  EXPECT_GE(pictures_in(scratch() / "view.mp4"), number_behind(played.out, "film pictures")) << played.out;
}

TEST_F(view_window, a_film_ends_with_its_scene_and_the_next_one_plays) {
  if (!can_look_into_films()) GTEST_SKIP() << "ffmpeg is not installed (Debian: ffmpeg)";
  const Played played =
      play({tiny(), "--width", "320", "--height", "240"},
           "ready\nkey space\nsettled\nkey f\nfilmed 9\nkey escape\npictures 3\nopen " + k_cube +
               "\npictures 3\nready\nframes 1\n"
               "status\nkey space\nsettled\nkey f\nfilmed 3\nkey f\npictures 3\njoined\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("paused 0"), std::string::npos) << played.out;
  EXPECT_GE(pictures_in(scratch() / "view.mp4"), 9);
  EXPECT_GE(pictures_in(scratch() / "view_2.mp4"), 3) << played.out;
}

TEST_F(view_window, what_was_said_last_is_seen) {
  const Played played = play({tiny(), "--paused", "--set", "solver.time_step_factor=0.9"},
                             "ready\nkey 3\nmove 0.5 0.22\npictures 2\npress 0\nrelease 0\nsaid poked\n"
                             "key c\nsaid copied\ncopied\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("shown poked"), std::string::npos) << played.out;
  EXPECT_NE(played.out.find("shown copied: mallow run"), std::string::npos) << played.out;
  EXPECT_NE(played.out.find("--set solver.time_step_factor=0.9  # without what the mouse did"),
            std::string::npos)
      << played.out;
}

TEST_F(view_window, a_scene_that_is_refused_when_built_anew_goes_on_as_it_was) {
  const Played played =
      play({tiny(), "--set", "solver.time_step=0.002"},
           "ready\nframes 3\nset solver.time_step 1\nrebuild\nsaid time_step\nkey =\nframes 3\nstatus\n"
           "key s\nsettled\nset solver.time_step 0\nrebuild\nsettled\nready\nstatus\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("shown "), std::string::npos) << played.out;
  EXPECT_NE(played.out.find("time_step"), std::string::npos) << played.out;
  EXPECT_TRUE(std::filesystem::exists(scratch() / "view_tiny" / "checkpoint")) << played.out;
}

TEST_F(view_window, the_field_of_view_is_seen_at_once) {
  const Played played = play({k_cube, "--paused", "--width", "320", "--height", "240"},
                             "ready\npictures 2\nscene narrow.png\nset render.field_of_view 0.6\nsettled\n"
                             "scene wide.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_GT(far_off(read_png(scratch() / "narrow.png"), read_png(scratch() / "wide.png"), 16), 0.05);
}

TEST_F(view_window, all_that_can_be_pressed_lies_inside_and_momentum_is_seen_at_the_default_size) {
  const Played played =
      play({tiny(), "--paused"}, "ready\npictures 4\nbars\nresize 660 600\npictures 8\nbars\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_NE(played.out.find("of 1280 high 68 plots 3"), std::string::npos) << played.out;
  EXPECT_EQ(number_behind(played.out, "of"), 660) << played.out;
  EXPECT_GT(number_behind(played.out, "end"), 300) << played.out;
  EXPECT_LT(number_behind(played.out, "end"), 660) << played.out;
}

TEST_F(view_window, help_is_shown_in_the_gallery_too) {
  const Played played =
      play({}, "pictures 3\nscreenshot plain.png\nkey h\npictures 3\nscreenshot help.png\nclose\n");
  ASSERT_EQ(played.exit_code, 0) << played.out;
  EXPECT_GT(far_off(read_png(scratch() / "plain.png"), read_png(scratch() / "help.png"), 16), 0.08);
}

}  // namespace view_window_test
}  // namespace mallow
