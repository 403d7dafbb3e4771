#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/collider.h"
#include "mallow/mesh.h"
#include "mallow/scene.h"
#include "mallow/vec3.h"

/// Pictures of bodies in a white studio: one large soft key light, a bright sky, one bounce, a floor that
/// fades into the backdrop.
namespace mallow::render {

/// Rows from the top, pixels from the left, three bytes each: sRGB.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

struct Camera {
  Vec3 eye{0, -1, 0};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 0, 1};
  float field_of_view = 35.0f;  ///< vertical, degrees, in [1, 120]
};

/// A camera that has all of `scene_bounds` in view with a margin, a little from above: between the +x and the
/// -y side, or from the corner that has the most planes of `colliders` facing it. A target that the config
/// gives is kept; so is an eye, and then nothing is promised about the margin.
Camera frame_camera(const Aabb& scene_bounds, const RenderConfig& config,
                    std::span<const Collider> colliders = {});
/// The same for several boxes, at least one, which may leave out corners of the one around them.
Camera frame_camera(std::span<const Aabb> boxes, const RenderConfig& config,
                    std::span<const Collider> colliders = {});

/// Draws frames of one scene. The picture depends on the input and the machine, never on the number of
/// threads. Lengths of the look (softness of the fade, translucency) follow from the camera, so keep it for a
/// whole film.
class Renderer {
 public:
  /// Throws ConfigError with every value that is out of range. `threads` as in SolverConfig.
  Renderer(const RenderConfig& config, int threads);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// What moves with velocities is blurred from now on as far as it comes in this time [s], >= 0: half of it
  /// before and half of it after the moment of the frame. Colliders, and particles drawn as balls, are not.
  void set_exposure(float seconds);

  /// A surface; its material ids index `palette`. An empty mesh gives the empty studio. Throws ConfigError
  /// where a material id has no appearance or the camera is out of range.
  Image render(const Mesh& mesh, std::span<const Appearance> palette, std::span<const Collider> colliders,
               const Camera& camera);
  /// The particles themselves as balls of `radius` [m], > 0. `bodies` indexes `palette`; empty: all 0.
  Image render_points(std::span<const Vec3> positions, float radius, std::span<const std::uint32_t> bodies,
                      std::span<const Appearance> palette, std::span<const Collider> colliders,
                      const Camera& camera);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whole or not at all. Throws IoError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace mallow::render
