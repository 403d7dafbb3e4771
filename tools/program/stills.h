#pragma once

#include <utility>
#include <vector>

#include "mallow/files.h"
#include "mallow/mesh.h"
#include "mallow/scene.h"
#include "program/film_bounds.h"
#include "render/renderer.h"

namespace mallow::program {

/// The colliders of a scene that are seen, where they are at a time [s].
std::vector<Collider> colliders_at(const Scene& scene, double time);

/// The light that the scene names, where it is.
std::filesystem::path environment_file(const Scene& scene);
/// Throws IoError where the light that the scene names cannot be read.
void check_environment(const Scene& scene);

/// Takes the pictures of a run: camera and looks stay through the film.
class Stills {
 public:
  /// `scene` must outlive the stills. film: what the camera has in view, where the scene does not say where
  /// it is. spacings: h of each body [m].
  Stills(const Scene& scene, const FilmBounds& film, std::span<const float> spacings, int threads);
  /// Of a film of which one frame is known.
  Stills(const Scene& scene, const ParticleFrame& first, std::span<const float> spacings, int threads);

  const render::Camera& camera() const { return camera_; }
  float ball_radius() const { return ball_radius_; }  ///< of particles without a surface [m]

  /// Simulated time from one frame to the next [s], of which the shutter is open for a share; 0 to begin
  /// with.
  void set_frame_time(double seconds) {
    renderer_.set_exposure(scene_.render.shutter * static_cast<float>(seconds));
  }

  /// Of each body, by its slot, where some have come that the scene has not.
  void set_appearances(std::vector<Appearance> appearances) { palette_ = std::move(appearances); }
  /// The surface of a frame, or its particles where the surface is empty.
  render::Image take(const ParticleFrame& frame, const Mesh& surface);

 private:
  const Scene& scene_;
  render::Renderer renderer_;
  render::Camera camera_;
  std::vector<Appearance> palette_;  ///< appearance of each body, so far
  float ball_radius_;                ///< [m]
};

}  // namespace mallow::program
