#include "render/renderer.h"

#include <algorithm>
#include <cmath>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "config/run_field_tables.h"
#include "core/parallel.h"
#include "render/bodies.h"
#include "render/sampling.h"
#include "render/viewport.h"
#include "render/world.h"

namespace mallow::render {
namespace {

// Pixels per unit of work: few enough to balance, enough to hide the scheduling.
constexpr std::size_t k_pixels = 64;
// Rays through the pixels where surfaces meet, per sample of the light.
constexpr int k_edge_rays = 4;

// Whether the light on one surfel may stand for that on the other: same object, same way to face, same plane
// within `reach`.
bool alike(const Surfel& a, const Surfel& b, float reach) {
  return a.same_object(b) && a.normal.dot(b.normal) > 0.9f &&
         std::abs(a.normal.dot(b.position - a.position)) < reach;
}

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
      : config(render_config),
        threads(requested_threads),
        key_points(config.samples),
        hemisphere_points(config.samples),
        surfels(static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height)),
        light(surfels.size()),
        scratch(surfels.size()) {}

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(config.width) + static_cast<std::size_t>(x);
  }
  template <class Body>
  void for_pixels(const Body& body) {
    parallel_for(
        threads, surfels.size(),
        [&](std::size_t begin, std::size_t end) {
          const auto width = static_cast<std::size_t>(config.width);
          for (std::size_t i = begin; i < end; ++i)
            body(i, static_cast<int>(i % width), static_cast<int>(i / width));
        },
        k_pixels);
  }

  Image draw(std::span<const Collider> colliders, const Camera& camera);
  void trace(const World& world, const Viewport& view);
  void smooth(float footprint);
  void average(const std::vector<Light>& from, std::vector<Light>& to, int step_x, int step_y,
               float footprint);
  bool is_edge(int x, int y, float footprint) const;
  Vec3 edge_color(const World& world, const Viewport& view, int x, int y) const;
  Light light_near(const World& world, const Surfel& seen, int x, int y, float footprint) const;

  RenderConfig config;
  Threads threads;
  InterleavedDisc key_points;
  InterleavedDisc hemisphere_points;
  Bodies bodies;
  std::vector<Surfel> surfels;  // through the middle of each pixel
  std::vector<Light> light;
  std::vector<Light> scratch;
};

void Renderer::State::trace(const World& world, const Viewport& view) {
  for_pixels([&](std::size_t i, int x, int y) {
    surfels[i] = world.look(view.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
    if (surfels[i].look == Look::none) return;
    // The two sets are turned against each other, so that a pixel's place in one says nothing about the
    // other.
    light[i] = world.gather(surfels[i], key_points.at(x, y), hemisphere_points.at(y + 2, x + 1));
  });
}

// One axis of the mean over the 4 × 4 window in which the interleaved set is whole: five pixels of which the
// outer two count half, so that the window has a middle.
void Renderer::State::average(const std::vector<Light>& from, std::vector<Light>& to, int step_x, int step_y,
                              float footprint) {
  constexpr int k_radius = InterleavedDisc::k_tile / 2;
  for_pixels([&](std::size_t i, int x, int y) {
    const Surfel& here = surfels[i];
    if (here.look == Look::none) return;
    const float reach = 2 * footprint * here.distance * static_cast<float>(step_x + step_y);
    Light sum;
    float weights = 0;
    for (int k = -k_radius; k <= k_radius; ++k) {
      const int nx = x + k * step_x;
      const int ny = y + k * step_y;
      if (nx < 0 || ny < 0 || nx >= config.width || ny >= config.height) continue;
      const std::size_t j = index(nx, ny);
      if (!alike(here, surfels[j], reach)) continue;
      const float weight = std::abs(k) == k_radius ? 0.5f : 1.0f;
      sum.ambient += weight * from[j].ambient;
      sum.key += weight * from[j].key;
      weights += weight;
    }
    to[i] = {.ambient = sum.ambient / weights, .key = sum.key / weights};
  });
}

// Once to gather the interleaved set, once more, wider, against the steps that 64 directions leave in large
// gradients.
void Renderer::State::smooth(float footprint) {
  for (const int step : {1, 3}) {
    average(light, scratch, step, 0, footprint);
    average(scratch, light, 0, step, footprint);
  }
}

bool Renderer::State::is_edge(int x, int y, float footprint) const {
  const Surfel& here = surfels[index(x, y)];
  const auto differs = [&](int nx, int ny) {
    if (nx < 0 || ny < 0 || nx >= config.width || ny >= config.height) return false;
    const Surfel& there = surfels[index(nx, ny)];
    if (here.veil.shape != there.veil.shape || here.veil.light != there.veil.light) return true;
    if (here.look == Look::none && there.look == Look::none) return false;
    return !alike(here, there, 4 * footprint * here.distance);
  };
  return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
}

Light Renderer::State::light_near(const World& world, const Surfel& seen, int x, int y,
                                  float footprint) const {
  Light sum;
  float count = 0;
  for (int ny = std::max(0, y - 1); ny <= std::min(config.height - 1, y + 1); ++ny) {
    for (int nx = std::max(0, x - 1); nx <= std::min(config.width - 1, x + 1); ++nx) {
      const std::size_t j = index(nx, ny);
      if (!alike(seen, surfels[j], 4 * footprint * seen.distance)) continue;
      sum.ambient += light[j].ambient;
      sum.key += light[j].key;
      count += 1;
    }
  }
  if (count == 0) return world.gather(seen, key_points.at(x, y), hemisphere_points.at(y + 2, x + 1));
  return {.ambient = sum.ambient / count, .key = sum.key / count};
}

Vec3 Renderer::State::edge_color(const World& world, const Viewport& view, int x, int y) const {
  const int rays = k_edge_rays * config.samples;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < rays; ++k) {
    const Point2 point = sobol(static_cast<std::uint32_t>(k));
    const Ray ray = view.ray(static_cast<float>(x) + point.x(), static_cast<float>(y) + point.y());
    const Surfel seen = world.look(ray);
    Light near;
    if (seen.look != Look::none) near = light_near(world, seen, x, y, view.footprint());
    // Developed one by one: a highlight brighter than the screen must not eat the edge beside it.
    sum += develop(world.color(ray, seen, near));
  }
  return sum / static_cast<float>(rays);
}

Image Renderer::State::draw(std::span<const Collider> colliders, const Camera& camera) {
  check(camera);
  const Viewport view(camera, config.width, config.height);
  const World world(bodies, colliders, camera);
  const float footprint = view.footprint();
  trace(world, view);
  smooth(footprint);

  Image image{config.width, config.height, std::vector<std::uint8_t>(3 * surfels.size())};
  for_pixels([&](std::size_t i, int x, int y) {
    Vec3 color;
    if (is_edge(x, y, footprint)) {
      color = edge_color(world, view, x, y);
    } else {
      const Ray ray = view.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      color = develop(world.color(ray, surfels[i], light[i]));
    }
    // Half a step of chance keeps the slow gradients of floor and backdrop free of bands.
    const float dither = unit(hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
    for (int c = 0; c < 3; ++c) {
      image.rgb[3 * i + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::clamp(255 * color[c] + dither, 0.0f, 255.0f));
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
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Image Renderer::render(const Mesh& mesh, std::span<const Appearance> palette,
                       std::span<const Collider> colliders, const Camera& camera) {
  state_->bodies.set_mesh(mesh, palette);
  return state_->draw(colliders, camera);
}

Image Renderer::render_points(std::span<const Vec3> positions, float radius,
                              std::span<const std::uint32_t> bodies, std::span<const Appearance> palette,
                              std::span<const Collider> colliders, const Camera& camera) {
  Checks checks;
  check_value("radius", radius, k_positive, checks);
  checks.finish();
  state_->bodies.set_points(positions, radius, bodies, palette);
  return state_->draw(colliders, camera);
}

}  // namespace mallow::render
