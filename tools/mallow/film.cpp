#include "mallow/film.h"

#include <cstdio>
#include <vector>

#include "mallow/errors.h"
#include "mallow/external_program.h"
#include "mallow/failure.h"
#include "mallow/files.h"

namespace mallow::cli {
namespace {

constexpr const char* k_ffmpeg = "ffmpeg";

/// Pictures named by ffmpeg's `pattern` to an MP4.
std::vector<std::string> command_line(const std::string& pattern, const std::string& film,
                                      int frames_per_second, int threads) {
  // yuv420p, which every player knows, has no odd sides: hence the pad.
  return {k_ffmpeg,
          "-nostdin",
          "-y",
          "-loglevel",
          "error",
          "-framerate",
          std::to_string(frames_per_second),
          "-i",
          pattern,
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
          "file:" + film};  // a name with a colon is no protocol
}

}  // namespace

void add_film_options(CLI::App& command, FilmOptions& options) {
  CLI::Option* file =
      command.add_option("--film", options.file, "MP4 file for the film, instead of film.mp4 in the folder");
  command.add_flag("--no-film", options.no_film, "No film")->excludes(file);
}

void check_film(const FilmOptions& options) {
  if (options.file.empty()) return;
  if (std::filesystem::path(options.file).extension() != ".mp4")
    throw ConfigError("--film", "'" + options.file + "' is not allowed: a file that ends in .mp4");
  check_writable(options.file);
  if (is_installed(k_ffmpeg)) return;
  std::fprintf(stderr,
               "mallow: %s will not be made, because the program ffmpeg is not installed; all else is\n",
               options.file.c_str());
}

void make_film(const FilmOptions& options, const Cache& cache, int frames_per_second, int threads) {
  if (options.no_film) return;
  if (!is_installed(k_ffmpeg)) {
    if (options.file.empty())
      std::fprintf(stderr, "mallow: no film, because the program ffmpeg is not installed\n");
    return;
  }
  const std::filesystem::path film =
      options.file.empty() ? cache.film_file() : std::filesystem::path(options.file);
  const std::string pictures = (cache.images_folder() / "frame_%06d.png").string();
  write_whole(film, [&](const std::filesystem::path& beside) {
    const int status = run_program(command_line(pictures, beside.string(), frames_per_second, threads));
    if (status != 0) throw RunFailure("ffmpeg failed with exit status " + std::to_string(status));
  });
}

void require_film(const FilmOptions& options) {
  if (options.file.empty() || is_installed(k_ffmpeg)) return;
  throw RunFailure(options.file + " was not made, because the program ffmpeg is not installed");
}

}  // namespace mallow::cli
