#include "figures/contact_sheet.h"

#include <cstdio>
#include <string>

#include "program/external_program.h"
#include "program/failure.h"

namespace mallow::bench {

void ContactSheet::begin_take(const Scene& scene, const ParticleFrame& first,
                              std::span<const float> spacings) {
  scene_ = scene;
  scene_.render.width = 320;
  scene_.render.height = 280;
  scene_.surface.kernel_radius = 2.5f;  // the gallery's: particles of a thin sheet do not show one by one
  spacings_.assign(spacings.begin(), spacings.end());
  surfacer_.emplace(scene_.surface, threads_);
  stills_.emplace(scene_, first, spacings_, threads_);
  ++takes_;
}

void ContactSheet::add(const ParticleFrame& frame) {
  SurfaceParticles particles = surface_particles(frame, spacings_);
  particles.velocities = {};
  render::write_png(picture(pictures_), stills_->take(frame, surfacer_->draw(particles)));
  ++pictures_;
}

void ContactSheet::close() {
  if (pictures_ == 0) return;
  if (!program::is_installed("ffmpeg")) {
    std::fprintf(stderr,
                 "mallow-bench: pictures are not joined, because the program ffmpeg is not installed\n");
    return;
  }
  const std::string tiles = std::to_string(pictures_ / takes_) + 'x' + std::to_string(takes_);
  write_whole(file_, [&](const std::filesystem::path& beside) {
    const int status = program::run_program(
        {"ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i", file_.stem().string() + "_%03d.png", "-vf",
         "tile=" + tiles, "-frames:v", "1", "-f", "image2", "-c:v", "png", beside.filename().string()},
        file_.parent_path());
    if (status != 0) throw program::RunFailure("ffmpeg failed with exit status " + std::to_string(status));
  });
  for (std::size_t number = 0; number < pictures_; ++number) std::filesystem::remove(picture(number));
}

std::filesystem::path ContactSheet::picture(std::size_t number) const {
  char ending[16];
  std::snprintf(ending, sizeof ending, "_%03zu.png", number);
  return file_.parent_path() / (file_.stem().string() + ending);
}

}  // namespace mallow::bench
