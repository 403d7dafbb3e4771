#include "program/film.h"

#include <vector>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/external_program.h"
#include "program/failure.h"
#include "program/shell_word.h"

namespace mallow::program {
namespace {

constexpr const char* k_ffmpeg = "ffmpeg";
/// The same whatever a run has: the bytes of a film depend on it.
constexpr const char* k_threads = "2";
/// In the metadata of every film.
constexpr const char* k_made_by = "made by mallow";

/// The pictures of the present folder from frame `first` on to an MP4.
std::vector<std::string> command_line(int first, const std::string& film, int frames_per_second) {
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
          k_threads,
          "-metadata",
          std::string("comment=") + k_made_by,
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          "file:" + film};  // a name with a colon is no protocol
}

/// ffmpeg ends a film where a picture is missing, and says nothing.
void require_all_pictures(const Cache& cache) {
  const std::vector<int> frames = cache.image_frames();
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i] != frames[0] + static_cast<int>(i))
      throw RunFailure("no film: " + missing_picture(cache, frames[0] + static_cast<int>(i)));
  if (frames.empty()) throw RunFailure("no film: " + missing_picture(cache, 0));
}

}  // namespace

bool can_make_films() {
  return is_installed(k_ffmpeg);
}

std::string missing_picture(const Cache& cache, int frame) {
  return "the picture of frame " + std::to_string(frame) + " is missing; 'mallow render " +
         shell_word(cache.folder().string()) + "' takes all of them again";
}

bool is_film(std::string_view beginning) {
  return beginning.substr(0, 12).ends_with("ftypisom") && beginning.find(k_made_by) != beginning.npos;
}

void make_film(const Cache& cache, const std::filesystem::path& film, int frames_per_second) {
  require_all_pictures(cache);
  make_film(cache.images_folder(), cache.image_frames().front(), film, frames_per_second);
}

void make_film(const std::filesystem::path& pictures, int first, const std::filesystem::path& film,
               int frames_per_second) {
  write_whole(film, [&](const std::filesystem::path& beside) {
    const std::string name = std::filesystem::absolute(beside).string();  // ffmpeg runs in another folder
    const int status = run_program(command_line(first, name, frames_per_second), pictures);
    if (status != 0) throw RunFailure("ffmpeg failed with exit status " + std::to_string(status));
  });
}

}  // namespace mallow::program
