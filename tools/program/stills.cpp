#include "program/stills.h"

#include <algorithm>

#include "program/body_appearances.h"
#include "render/hdr.h"

namespace mallow::program {
namespace {

/// How pictures are taken, with files where they are.
RenderConfig of_scene(const Scene& scene) {
  RenderConfig config = scene.render;
  if (!config.environment.empty()) config.environment = environment_file(scene);
  return config;
}

}  // namespace

std::filesystem::path environment_file(const Scene& scene) {
  return scene.file.parent_path() / scene.render.environment;
}

std::vector<Collider> colliders_at(const Scene& scene, double time) {
  std::vector<Collider> colliders = visible_colliders(scene);
  for (Collider& collider : colliders)
    collider.pose =
        collider.keyframes.empty() ? pose_after(collider, time) : pose_at(collider.keyframes, time);
  return colliders;
}

void check_environment(const Scene& scene) {
  if (!scene.render.environment.empty()) render::read_hdr(environment_file(scene));
}

Stills::Stills(const Scene& scene, const FilmBounds& film, std::span<const float> spacings, int threads)
    : scene_(scene),
      renderer_(of_scene(scene), threads),
      palette_(body_appearances(scene)),
      ball_radius_(0.5f * *std::min_element(spacings.begin(), spacings.end())) {
  camera_ = render::frame_camera(film.boxes(scene), scene.render, visible_colliders(scene));
}

Stills::Stills(const Scene& scene, const ParticleFrame& first, std::span<const float> spacings, int threads)
    : Stills(scene, FilmBounds(spacings, first, scene.emitters), spacings, threads) {}

render::Image Stills::take(const ParticleFrame& frame, const Mesh& surface) {
  const std::vector<Collider> colliders = colliders_at(scene_, frame.time);
  if (const auto last = std::ranges::max_element(frame.bodies);
      last != frame.bodies.end() && *last >= palette_.size())
    palette_ = body_appearances(scene_, std::vector<std::string>(std::size_t{1} + *last));
  if (!surface.triangles.empty()) return renderer_.render(surface, palette_, colliders, camera_);
  return renderer_.render_points(frame.positions, ball_radius_, frame.bodies, palette_, colliders, camera_);
}

}  // namespace mallow::program
