#pragma once

#include <string>

#include "program/cache.h"
#include "program/output_files.h"

namespace CLI {
class App;
}

namespace mallow::cli {

/// The film that a command line asks for.
struct FilmOptions {
  std::string file;      ///< empty: the cache's film.mp4
  bool no_film = false;  ///< not even that
};

/// --film FILE and --no-film, one of them.
void add_film_options(CLI::App& command, FilmOptions& options);

/// Before any work: throws ConfigError or IoError where FILE is no film that can be written, and says on
/// stderr where ffmpeg is not installed, so that there will be none.
void check_film(const FilmOptions& options);

/// Throws IoError where FILE is there, and is no film of mallow's.
void refuse_to_replace(const FilmOptions& options, program::Replace replace);

/// Before a run goes on: throws IoError where its film would lack the picture of a frame up to `last`.
void check_pictures(const FilmOptions& options, const program::Cache& cache, int last);

/// The film of a cache, where one is wanted. Where ffmpeg is not installed it makes none, and says so on
/// stderr unless check_film() did. Throws what program::make_film() throws.
void make_film(const FilmOptions& options, const program::Cache& cache, int frames_per_second);

/// After all other work: throws RunFailure where FILE was asked for and there was no ffmpeg to make it.
void require_film(const FilmOptions& options);

}  // namespace mallow::cli
