#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "config/run_field_tables.h"
#include "core/parallel.h"
#include "render/bodies.h"
#include "render/light_map.h"
#include "render/motion.h"
#include "render/sampling.h"
#include "render/viewport.h"
#include "render/world.h"

namespace mallow::render {
namespace {

// Rays through the pixels where surfaces meet, per sample of the light, and how many are taken first: where
// these differ by less than this, on the screen, the others are not needed.
constexpr int k_edge_rays = 4;
constexpr int k_first_edge_rays = 4;
constexpr float k_edge_spread = 0.02f;
// Rays through the pixels where something moves, at least, and what their times step on by: any number of
// them in a row are spread evenly.
constexpr int k_motion_rays = 24;
constexpr float k_golden = 0.618034f;

void check(const Camera& camera) {
  Checks checks;
  checks.vector("camera.eye", camera.eye);
  checks.vector("camera.target", camera.target);
  if (camera.eye == camera.target) checks.problem("camera.target", "must not be where camera.eye is");
  check_value("camera.field_of_view", camera.field_of_view, range_of(&RenderConfig::field_of_view), checks);
  checks.finish();
}

}  // namespace

struct Renderer::State {
  State(const RenderConfig& render_config, int requested_threads)
      : config(render_config), threads(requested_threads), light_map(config, threads) {}

  Image draw(std::span<const Collider> colliders, const Camera& camera);
  Environment environment(const Camera& camera, bool has_floor) const;
  /// Of a pixel on the screen, in [0, 1]. floor: that of the floor in the open.
  Vec3 still_color(const World& world, const Viewport& view, const Vec3& floor, int x, int y) const;
  Vec3 color(const World& world, const Viewport& view, bool flat, int x, int y) const;
  Vec3 edge_color(const World& world, const Viewport& view, int x, int y) const;

  RenderConfig config;
  Threads threads;
  Bodies bodies;
  float exposure = 0;  // [s]
  MotionMap motion;
  LightMap light_map;
  std::optional<HdrPicture> surroundings;
  HdrPicture soft_surroundings;
};

Vec3 Renderer::State::edge_color(const World& world, const Viewport& view, int x, int y) const {
  const bool moves = motion.at(x, y);
  const int most =
      moves ? std::max(k_motion_rays, k_edge_rays * config.samples) : k_edge_rays * config.samples;
  // Each pixel has times of its own, the same in every frame.
  const float own = unit(hash(static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(x)));
  Vec3 sum = Vec3::Zero(), lowest = Vec3::Ones(), highest = Vec3::Zero();
  std::array<Ray, World::k_batch> rays;
  std::array<Surfel, World::k_batch> seen;
  std::array<Surfel*, World::k_batch> to;
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = &seen[k];
  int taken = 0;
  while (taken < most) {
    const int count =
        taken == 0 ? k_first_edge_rays : std::min(most - taken, static_cast<int>(World::k_batch));
    for (int k = 0; k < count; ++k) {
      const Point2 point = sobol(static_cast<std::uint32_t>(taken + k));
      rays[static_cast<std::size_t>(k)] =
          view.ray(static_cast<float>(x) + point.x(), static_cast<float>(y) + point.y());
      if (moves) {
        const float time = own + static_cast<float>(taken + k) * k_golden;
        rays[static_cast<std::size_t>(k)].time = time - std::floor(time);
      }
    }
    const auto used = static_cast<std::size_t>(count);
    world.look({rays.data(), used}, to);
    for (std::size_t k = 0; k < used; ++k) {
      Light near;
      if (seen[k].look != Look::none) near = light_map.light_near(world, rays[k], seen[k], x, y);
      // Developed one by one: a highlight brighter than the screen must not eat the edge beside it.
      const Vec3 color = develop(world.color(rays[k], seen[k], near));
      sum += color;
      lowest = lowest.cwiseMin(color);
      highest = highest.cwiseMax(color);
    }
    taken += count;
    if ((highest - lowest).maxCoeff() < k_edge_spread) break;
  }
  return sum / static_cast<float>(taken);
}

// What most of a picture is needs no search for edges, and the floor no light.
Vec3 Renderer::State::still_color(const World& world, const Viewport& view, const Vec3& floor, int x,
                                  int y) const {
  const Ray ray = view.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const Surfel seen = world.look_past(ray);
  if (seen.look == Look::floor && seen.fade == 0) return floor;
  return develop(world.open_color(ray, seen));
}

Vec3 Renderer::State::color(const World& world, const Viewport& view, bool flat, int x, int y) const {
  if ((!flat && light_map.is_edge(x, y)) || motion.at(x, y)) return edge_color(world, view, x, y);
  return develop(world.color(view.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f),
                             light_map.surfel(x, y), light_map.light(x, y)));
}

Environment Renderer::State::environment(const Camera& camera, bool has_floor) const {
  return surroundings ? Environment(*surroundings, soft_surroundings, has_floor)
                      : Environment(camera, has_floor);
}

Image Renderer::State::draw(std::span<const Collider> colliders, const Camera& camera) {
  check(camera);
  const Viewport view(camera, config.width, config.height);
  const Obstacles obstacles(colliders, camera);
  const Environment light = environment(camera, obstacles.floor().has_value());
  const World world(bodies, obstacles, light, camera);
  light_map.trace(world, view);

  const Vec3 floor = develop(light.open_floor());
  const std::size_t pixels = static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height);
  Image image{config.width, config.height, std::vector<std::uint8_t>(3 * pixels)};
  light_map.for_tiles([&](const LightMap::Tile& tile) {
    const bool still = light_map.is_still(tile), flat = light_map.is_flat(tile);
    for (int y = tile.top; y < tile.bottom; ++y) {
      std::uint8_t* rgb =
          &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(config.width) +
                          static_cast<std::size_t>(tile.left))];
      for (int x = tile.left; x < tile.right; ++x) {
        const Vec3 screen = still ? still_color(world, view, floor, x, y) : color(world, view, flat, x, y);
        // Half a step of chance keeps the slow gradients of floor and backdrop free of bands.
        const float dither = unit(hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
        for (int c = 0; c < 3; ++c)
          *rgb++ = static_cast<std::uint8_t>(std::min(255 * screen[c] + dither, 255.0f));
      }
    }
  });
  return image;
}

Renderer::Renderer(const RenderConfig& config, int threads) {
  Checks checks;
  check_fields("render.", config, checks);
  check_value("threads", threads, range_of(&SolverConfig::threads), checks);
  checks.finish();
  state_ = std::make_unique<State>(config, threads);
  if (config.environment.empty()) return;
  state_->surroundings = read_hdr(config.environment);
  state_->soft_surroundings = state_->surroundings->shrunk(256, 128);
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::set_exposure(float seconds) {
  Checks checks;
  check_value("exposure", seconds, k_not_negative, checks);
  checks.finish();
  state_->exposure = seconds;
}

Image Renderer::render(const Mesh& mesh, std::span<const Appearance> palette,
                       std::span<const Collider> colliders, const Camera& camera) {
  state_->bodies.set_mesh(mesh, palette, state_->exposure);
  check(camera);
  if (state_->exposure > 0 && !mesh.velocities.empty())
    state_->motion =
        MotionMap(mesh, state_->exposure, Viewport(camera, state_->config.width, state_->config.height));
  return state_->draw(colliders, camera);
}

Image Renderer::render_points(std::span<const Vec3> positions, float radius,
                              std::span<const std::uint32_t> bodies, std::span<const Appearance> palette,
                              std::span<const Collider> colliders, const Camera& camera) {
  Checks checks;
  check_value("radius", radius, k_positive, checks);
  checks.finish();
  state_->motion = {};
  state_->bodies.set_points(positions, radius, bodies, palette);
  return state_->draw(colliders, camera);
}

}  // namespace mallow::render
