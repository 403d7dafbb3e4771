#include "view/viewer_program.h"

#include <png.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>

#include "program/external_program.h"
#include "program/shell_word.h"

namespace mallow::test {
namespace fs = std::filesystem;

fs::path scratch() {
  const fs::path folder = fs::temp_directory_path() / ("mallow_view_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  return folder;
}

Played play(const std::vector<std::string>& arguments, const std::string& script, int seconds) {
  const fs::path file = scratch() / "script.txt";
  std::ofstream(file) << script;
  // What xvfb-run ends with is not always what the viewer did: it may fail to clean up behind one that ended
  // at once.
  const fs::path run = scratch() / "run.sh", code = scratch() / "exit_code";
  fs::remove(code);
  std::string command = "timeout " + std::to_string(seconds) + ' ' + MALLOW_VIEW + " --script " +
                        program::shell_word(file.string());
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  std::ofstream(run) << command << "\necho $? > " << program::shell_word(code.string()) << "\n";
  const std::string line = "cd " + program::shell_word(scratch().string()) +
                           " && XDG_CACHE_HOME=" + program::shell_word((scratch() / "cache").string()) +
                           " xvfb-run -a -s '-screen 0 1280x1024x24' sh " +
                           program::shell_word(run.string()) + " 2>&1";
  Played played;
  const auto started = std::chrono::steady_clock::now();
  FILE* const pipe = ::popen(line.c_str(), "r");
  char part[4096];
  while (std::fgets(part, sizeof part, pipe)) played.out += part;
  const int status = ::pclose(pipe);
  if (!(std::ifstream(code) >> played.exit_code))
    played.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  played.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return played;
}

std::string why_no_window() {
  static const std::string why = [] {
    if (!program::is_installed("xvfb-run") || !program::is_installed("Xvfb"))
      return std::string("Xvfb is not installed (Debian: xvfb)");
    const Played tried = play({std::string(MALLOW_DATA_DIR) + "/scenes/cube.toml", "--paused"}, "close\n");
    if (tried.exit_code == 0) return std::string();
    const bool no_gl = tried.out.find("needs OpenGL") != std::string::npos;
    return no_gl ? "there is no OpenGL 3.3 here (Debian: libgl1-mesa-dri): " + tried.out : std::string();
  }();
  return why;
}

Picture read_png(const fs::path& file) {
  Picture picture;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, file.c_str())) return picture;
  image.format = PNG_FORMAT_RGB;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr);
  return picture;
}

}  // namespace mallow::test
