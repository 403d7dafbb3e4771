#include "mallow/film.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "mallow/failure.h"
#include "mallow/files.h"

namespace mallow::cli {
namespace {

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Runs a program without a shell; gives its exit status.
int run_program(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ);
  if (error != 0) throw RunFailure(arguments[0] + " cannot be started: " + std::strerror(error));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

void make_film(const Cache& cache, int frames_per_second, int threads) {
  if (!is_installed("ffmpeg")) {
    std::fprintf(stderr, "mallow: no film, because the program ffmpeg is not installed\n");
    return;
  }
  const std::string pictures = (cache.images_folder() / "frame_%06d.png").string();
  write_whole(cache.film_file(), [&](const std::filesystem::path& beside) {
    // yuv420p, which every player knows, has no odd sides: hence the pad.
    const int status = run_program({"ffmpeg",
                                    "-nostdin",
                                    "-y",
                                    "-loglevel",
                                    "error",
                                    "-framerate",
                                    std::to_string(frames_per_second),
                                    "-i",
                                    pictures,
                                    "-vf",
                                    "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                    "-c:v",
                                    "libx264",
                                    "-preset",
                                    "fast",
                                    "-crf",
                                    "18",
                                    "-pix_fmt",
                                    "yuv420p",
                                    "-threads",
                                    std::to_string(threads),
                                    "-movflags",
                                    "+faststart",
                                    "-f",
                                    "mp4",
                                    beside.string()});
    if (status != 0) throw RunFailure("ffmpeg failed with exit status " + std::to_string(status));
  });
}

}  // namespace mallow::cli
