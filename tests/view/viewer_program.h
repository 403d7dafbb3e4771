#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mallow::test {

/// What a scripted viewer left behind.
struct Played {
  int exit_code = -1;
  std::string out;  ///< both streams
  double seconds = 0;
};

/// Why no window can be opened here; empty where one can.
std::string why_no_window();
/// Runs the viewer in a screen of its own. script: lines, see view/script.h. It is ended after so many
/// seconds, with exit code 124.
Played play(const std::vector<std::string>& arguments, const std::string& script, int seconds = 600);

struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;
};
Picture read_png(const std::filesystem::path& file);
/// A folder for what tests write.
std::filesystem::path scratch();

}  // namespace mallow::test
