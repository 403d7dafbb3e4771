#include "cli/film_options.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "mallow/errors.h"
#include "program/failure.h"
#include "program/film.h"

namespace mallow::cli {

void add_film_options(CLI::App& command, FilmOptions& options) {
  CLI::Option* file =
      command.add_option("--film", options.file, "MP4 file for the film, instead of film.mp4 in the folder");
  command.add_flag("--no-film", options.no_film, "Make no film")->excludes(file);
}

void check_film(const FilmOptions& options) {
  if (options.file.empty()) return;
  if (std::filesystem::path(options.file).extension() != ".mp4")
    throw ConfigError("--film", "'" + options.file + "' is not allowed: a file that ends in .mp4");
  program::check_writable(options.file);
  if (program::can_make_films()) return;
  std::fprintf(
      stderr,
      "mallow: %s will not be made, because the program ffmpeg is not installed; everything else will be\n",
      options.file.c_str());
}

void refuse_to_replace(const FilmOptions& options, program::Replace replace) {
  program::refuse_to_replace(options.file, "--film", replace, program::is_film);
}

void check_pictures(const FilmOptions& options, const program::Cache& cache, int last) {
  if (options.no_film || !program::can_make_films()) return;
  for (int frame = 0; frame <= last; ++frame) {
    if (std::filesystem::exists(cache.image_file(frame))) continue;
    throw IoError({cache.images_folder().string(), 0, 0, "",
                   program::missing_picture(cache, frame) + ", --no-film makes no film"});
  }
}

void make_film(const FilmOptions& options, const program::Cache& cache, int frames_per_second) {
  if (options.no_film) return;
  if (!program::can_make_films()) {
    if (options.file.empty())
      std::fprintf(stderr, "mallow: no film, because the program ffmpeg is not installed\n");
    return;
  }
  program::make_film(cache, options.file.empty() ? cache.film_file() : std::filesystem::path(options.file),
                     frames_per_second);
}

void require_film(const FilmOptions& options) {
  if (options.file.empty() || program::can_make_films()) return;
  throw program::RunFailure(options.file + " was not made, because the program ffmpeg is not installed");
}

}  // namespace mallow::cli
