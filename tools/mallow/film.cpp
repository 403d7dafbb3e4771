#include "mallow/film.h"

#include <cstdio>
#include <string>

#include "mallow/external_program.h"
#include "mallow/failure.h"
#include "mallow/files.h"

namespace mallow::cli {
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
