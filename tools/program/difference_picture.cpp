#include "program/difference_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mallow/scene.h"
#include "program/film_bounds.h"
#include "program/stills.h"

namespace mallow::program {
namespace {

constexpr std::size_t k_colors = 32;

/// Linear RGB from "the same place" to "farthest", in even steps.
std::array<Appearance, k_colors> palette() {
  const std::array<Vec3, 3> ends{Vec3(0.6f, 0.6f, 0.6f), Vec3(0.9f, 0.6f, 0.05f), Vec3(0.7f, 0.02f, 0.02f)};
  std::array<Appearance, k_colors> colors;
  for (std::size_t c = 0; c < k_colors; ++c) {
    const float share = 2 * static_cast<float>(c) / (k_colors - 1);
    const std::size_t end = share < 1 ? 0 : 1;
    const float between = share - static_cast<float>(end);
    colors[c] = {.color = (1 - between) * ends[end] + between * ends[end + 1], .finish = Finish::clay};
  }
  return colors;
}

}  // namespace

render::Image difference_picture(const ComparedStates& a, const ComparedStates& b,
                                 const FrameDifference& frame, int threads) {
  const ParticleFrame particles = b.particles(frame.frame);
  std::vector<std::uint32_t> colors;
  for (const double distance : distances(a, b, frame.frame)) {
    const double share = frame.largest > 0         ? std::min(distance / frame.largest, 1.0)
                         : std::isfinite(distance) ? 0
                                                   : 1;
    colors.push_back(static_cast<std::uint32_t>(std::lround(share * (k_colors - 1))));
  }
  const Scene scene = b.scene();
  const std::vector<Collider> colliders = colliders_at(scene, particles.time);
  const std::vector<float> spacings = spacings_of(a.bodies(frame.frame));
  const FilmBounds bounds(spacings, particles, scene.emitters);
  const render::Camera camera =
      render::frame_camera(bounds.boxes(scene), scene.render, visible_colliders(scene));
  render::Renderer renderer(scene.render, threads);
  const auto looks = palette();
  const float radius = 0.5f * std::ranges::min(spacings);
  return renderer.render_points(particles.positions, radius, colors, looks, colliders, camera);
}

}  // namespace mallow::program
