#pragma once

#include "mallow/cache.h"

namespace mallow::cli {

/// Joins the pictures of a cache to film.mp4 (H.264) with the program ffmpeg. Where ffmpeg is not installed
/// it says so on stderr and makes none. Throws RunFailure where ffmpeg fails.
void make_film(const Cache& cache, int frames_per_second, int threads);

}  // namespace mallow::cli
