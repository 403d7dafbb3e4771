#include "mallow/film.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

#include "mallow/errors.h"
#include "mallow/external_program.h"
#include "mallow/failure.h"
#include "mallow/files.h"
#include "mallow/shell_word.h"

namespace mallow::cli {
namespace {

constexpr const char* k_ffmpeg = "ffmpeg";

/// The pictures of the present folder from frame `first` on to an MP4.
std::vector<std::string> command_line(int first, const std::string& film, int frames_per_second,
                                      int threads) {
  // yuv420p, which every player knows, has no odd sides: hence the pad.
  return {k_ffmpeg,
          "-nostdin",
          "-y",
          "-loglevel",
          "error",
          "-framerate",
          std::to_string(frames_per_second),
          "-start_number",
          std::to_string(first),
          "-i",
          "frame_%06d.png",
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

std::string missing(const Cache& cache, int frame) {
  return "the picture of frame " + std::to_string(frame) + " is missing; 'mallow render " +
         shell_word(cache.folder().string()) + "' takes all of them again";
}

/// ffmpeg ends a film where a picture is missing, and says nothing.
void require_all_pictures(const Cache& cache) {
  const std::vector<int> frames = cache.image_frames();
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i] != frames[0] + static_cast<int>(i))
      throw RunFailure("no film: " + missing(cache, frames[0] + static_cast<int>(i)));
  if (frames.empty()) throw RunFailure("no film: " + missing(cache, 0));
}

}  // namespace

void add_film_options(CLI::App& command, FilmOptions& options) {
  CLI::Option* file =
      command.add_option("--film", options.file, "MP4 file for the film, instead of film.mp4 in the folder");
  command.add_flag("--no-film", options.no_film, "Make no film")->excludes(file);
}

void check_film(const FilmOptions& options) {
  if (options.file.empty()) return;
  if (std::filesystem::path(options.file).extension() != ".mp4")
    throw ConfigError("--film", "'" + options.file + "' is not allowed: a file that ends in .mp4");
  check_writable(options.file);
  if (is_installed(k_ffmpeg)) return;
  std::fprintf(
      stderr,
      "mallow: %s will not be made, because the program ffmpeg is not installed; everything else will be\n",
      options.file.c_str());
}

void check_pictures(const FilmOptions& options, const Cache& cache, int last) {
  if (options.no_film || !is_installed(k_ffmpeg)) return;
  for (int frame = 0; frame <= last; ++frame) {
    if (std::filesystem::exists(cache.image_file(frame))) continue;
    throw IoError(
        {cache.images_folder().string(), 0, 0, "", missing(cache, frame) + ", --no-film makes no film"});
  }
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
  require_all_pictures(cache);
  const int first = cache.image_frames().front();
  write_whole(film, [&](const std::filesystem::path& beside) {
    const std::string name = std::filesystem::absolute(beside).string();  // ffmpeg runs in another folder
    const int status =
        run_program(command_line(first, name, frames_per_second, threads), cache.images_folder());
    if (status != 0) throw RunFailure("ffmpeg failed with exit status " + std::to_string(status));
  });
}

void require_film(const FilmOptions& options) {
  if (options.file.empty() || is_installed(k_ffmpeg)) return;
  throw RunFailure(options.file + " was not made, because the program ffmpeg is not installed");
}

}  // namespace mallow::cli
