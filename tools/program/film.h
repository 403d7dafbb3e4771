#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "program/cache.h"

namespace mallow::program {

/// Whether films can be made: the program ffmpeg is installed.
bool can_make_films();

/// What to say where a run lacks the picture of a frame, and what takes it again.
std::string missing_picture(const Cache& cache, int frame);

/// Joins the pictures of a run to a film (H.264), an MP4 file. Throws RunFailure where ffmpeg fails or a
/// picture between two others is missing. The same pictures make the same bytes.
void make_film(const Cache& cache, const std::filesystem::path& film, int frames_per_second);
/// The same of the pictures frame_000000.png and so on of a folder, from `first` to the last that follows.
void make_film(const std::filesystem::path& pictures, int first, const std::filesystem::path& film,
               int frames_per_second);

/// Whether a file that begins so is a film that make_film() made.
bool is_film(std::string_view beginning);

}  // namespace mallow::program
