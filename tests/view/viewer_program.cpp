#include "view/viewer_program.h"

#include <gtest/gtest.h>
#include <png.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "program/external_program.h"
#include "program/shell_word.h"

namespace mallow::test {
namespace fs = std::filesystem;

fs::path scratch() {
  /// Kept where a test failed, for whoever wants to see what was drawn.
  struct Scratch {
    Scratch() {
      std::string name = (fs::temp_directory_path() / "mallow_view_test_XXXXXX").string();
      if (!::mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
      path = name;
    }
    ~Scratch() {
      std::error_code ignored;
      if (!testing::UnitTest::GetInstance()->Failed()) fs::remove_all(path, ignored);
    }
    fs::path path;
  };
  static const Scratch k_scratch;
  return k_scratch.path;
}

Played play(const std::vector<std::string>& arguments, const std::string& script, int seconds) {
  const fs::path file = scratch() / "script.txt";
  std::ofstream(file) << script;
  // Not by xvfb-run: it waits for a signal of Xvfb's, and for ever where that comes before it waits.
  const fs::path run = scratch() / "run.sh", code = scratch() / "exit_code";
  fs::remove(code);
  std::string command = "timeout " + std::to_string(seconds) + ' ' + MALLOW_VIEW + " --script " +
                        program::shell_word(file.string());
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  std::ofstream(run) << "rm -f display\n"
                        "Xvfb -displayfd 3 -screen 0 1280x1024x24 -nolisten tcp 3>display >/dev/null 2>&1 &\n"
                        "server=$!\n"
                        "until [ -s display ] || ! kill -0 $server; do sleep 0.02; done\n"
                        "DISPLAY=:$(cat display) "
                     << command << "\necho $? > " << program::shell_word(code.string())
                     << "\nkill $server\nwait\n";
  const std::string line = "cd " + program::shell_word(scratch().string()) +
                           " && XDG_CACHE_HOME=" + program::shell_word((scratch() / "cache").string()) +
                           " sh " + program::shell_word(run.string()) + " 2>&1";
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
    if (!program::is_installed("Xvfb")) return std::string("Xvfb is not installed (Debian: xvfb)");
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
