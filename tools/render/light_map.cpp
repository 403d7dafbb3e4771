#include "render/light_map.h"

#include <algorithm>
#include <cmath>

namespace mallow::render {
namespace {

// Whether the light on one surfel may stand for that on the other: same object, same way to face, same plane
// within `reach`.
bool alike(const Surfel& a, const Surfel& b, float reach) {
  return a.same_object(b) && a.normal.dot(b.normal) > 0.9f &&
         std::abs(a.normal.dot(b.position - a.position)) < reach;
}

// The pixels in which a box can be seen, as {left, top, right, bottom}; all where it reaches behind the eye.
Eigen::Array4i seen_at(const Aabb& box, const Viewport& view) {
  const Eigen::Array4i all(0, 0, static_cast<int>(view.width), static_cast<int>(view.height));
  if (!(box.min.array() <= box.max.array()).all()) return {0, 0, 0, 0};
  Eigen::Array2f lowest = Eigen::Array2f::Constant(k_far), highest = -lowest;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = (corner >> axis & 1 ? box.max : box.min)[axis];
    const std::optional<Eigen::Vector2f> pixel = view.pixel(at);
    if (!pixel) return all;
    lowest = lowest.min(pixel->array());
    highest = highest.max(pixel->array());
  }
  // Within int's range, and a pixel more than rounding takes.
  lowest = (lowest - 2).max(0).min(all.tail<2>().cast<float>());
  highest = (highest + 2).max(0).min(all.tail<2>().cast<float>());
  return {static_cast<int>(lowest.x()), static_cast<int>(lowest.y()),
          static_cast<int>(std::ceil(highest.x())), static_cast<int>(std::ceil(highest.y()))};
}

Ray ray_through(const Viewport& view, int x, int y) {
  return view.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
}

}  // namespace

LightMap::LightMap(const RenderConfig& config, const Threads& threads)
    : width_(config.width),
      height_(config.height),
      samples_(config.samples),
      tiles_x_((config.width + k_tile - 1) / k_tile),
      tiles_y_((config.height + k_tile - 1) / k_tile),
      noise_(config.noise),
      threads_(threads),
      key_points_(config.samples),
      hemisphere_points_(config.samples),
      surfels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      light_(surfels_.size()),
      scratch_(surfels_.size()),
      kinds_(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_)),
      around_(kinds_.size()) {}

void LightMap::trace(const World& world, const Viewport& view) {
  footprint_ = view.footprint();
  Eigen::Array4i seen(0, 0, width_, height_);
  if (world.contents()) seen = seen_at(*world.contents(), view);
  for_tiles([&](const Tile& tile) {
    const bool open =
        tile.right <= seen[0] || tile.left >= seen[2] || tile.bottom <= seen[1] || tile.top >= seen[3];
    trace(world, view, tile, open);
  });
  // Of still tiles only those beside others are read by anyone.
  look_around();
  for_tiles([&](const Tile& tile) {
    if ((kinds_[index(tile)] & k_calm) == 0 || common(around_, tile) == (k_floor | k_calm)) return;
    fill(world, view, tile);
  });
  look_around();
  // Once to gather the interleaved set, once more, wider, against the steps that few directions leave in
  // large gradients.
  for (const int step : {1, 3}) {
    average(light_, scratch_, step, 0);
    average(scratch_, light_, 0, step);
  }
}

// A tile of floor and backdrop is in the open where no pixel of it lacks any light, and every second one has
// been looked at: together these have a whole interleaved set.
bool LightMap::is_open(const World& world, const Viewport& view, const Tile& tile) const {
  constexpr std::size_t k_most = (k_tile / 2) * (k_tile / 2);
  std::array<Surfel, k_most> seen;
  std::array<const Surfel*, k_most> at;
  std::array<Point2, k_most> to_key, around;
  std::size_t count = 0;
  for (int y = tile.top; y < tile.bottom; y += 2) {
    for (int x = tile.left; x < tile.right; x += 2) {
      seen[count] = world.look_past(ray_through(view, x, y));
      if (seen[count].look == Look::none) continue;
      at[count] = &seen[count];
      to_key[count] = key_points_.at(x / 2, y / 2, 0);
      around[count++] = hemisphere_points_.at(y / 2 + 2, x / 2 + 1, 0);
    }
  }
  std::array<float, World::k_batch> key;
  std::array<Vec3, World::k_batch> ambient;
  world.sample_key({at.data(), count}, to_key, key);
  world.sample_ambient({at.data(), count}, around, ambient);
  for (std::size_t i = 0; i < count; ++i)
    if (key[i] != 1 || !ambient[i].isZero(0)) return false;
  return true;
}

LightMap::Pixels LightMap::pixels_of(const Tile& tile) {
  Pixels pixels;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      const std::size_t i = index(x, y);
      light_[i] = {};
      light_[i].scattered() = 1;
      if (surfels_[i].look == Look::none) continue;
      pixels.at[pixels.count] = &surfels_[i];
      pixels.light[pixels.count] = &light_[i];
      pixels.x[pixels.count] = static_cast<std::int16_t>(x);
      pixels.y[pixels.count++] = static_cast<std::int16_t>(y);
    }
  }
  return pixels;
}

void LightMap::look(const World& world, const Viewport& view, const Tile& tile, bool past) {
  std::array<Ray, World::k_batch> rays;
  std::array<Surfel*, World::k_batch> seen;
  std::size_t count = 0;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      seen[count] = &surfels_[index(x, y)];
      rays[count++] = ray_through(view, x, y);
    }
  }
  if (!past) return world.look({rays.data(), count}, seen);
  for (std::size_t i = 0; i < count; ++i) *seen[i] = world.look_past(rays[i]);
}

std::uint8_t LightMap::kind_of(const Tile& tile) const {
  std::uint8_t kind = k_floor | k_calm;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      const Surfel& seen = surfels_[index(x, y)];
      if (seen.look != Look::floor) kind &= k_calm;
      if (seen.look > Look::floor || seen.veil.cover != 0) return 0;
    }
  }
  return kind;
}

void LightMap::trace(const World& world, const Viewport& view, const Tile& tile, bool past) {
  std::uint8_t& kind = kinds_[index(tile)];
  if (!past) look(world, view, tile, past);
  kind = past ? k_calm | k_floor : kind_of(tile);
  if ((kind & k_calm) != 0 && is_open(world, view, tile)) return;  // see fill()
  if (past) look(world, view, tile, past);
  kind = static_cast<std::uint8_t>(kind_of(tile) & k_floor);
  Pixels pixels = pixels_of(tile);
  add_beyond(world, view, pixels);
  for (const From from : {From::key, From::all_around}) {
    add_sample(world, pixels, from, 0);
    if (samples_ == 1 || !is_noisy(world, pixels, from)) continue;
    for (int k = 1; k < samples_; ++k) add_sample(world, pixels, from, k);
    for (std::size_t i = 0; i < pixels.count; ++i) {
      Light& light = *pixels.light[i];
      if (from == From::key)
        light.key() /= static_cast<float>(samples_);
      else
        light.ambient() /= static_cast<float>(samples_);
    }
  }
}

void LightMap::add_sample(const World& world, Pixels& pixels, From from, int k) const {
  const std::span<const Surfel* const> at{pixels.at.data(), pixels.count};
  std::array<Point2, World::k_batch> points;
  std::array<float, World::k_batch> key;
  std::array<Vec3, World::k_batch> ambient;
  // The two sets are turned against each other, so that a pixel's place in one says nothing about the other.
  for (std::size_t i = 0; i < pixels.count; ++i)
    points[i] = from == From::key ? key_points_.at(pixels.x[i], pixels.y[i], k)
                                  : hemisphere_points_.at(pixels.y[i] + 2, pixels.x[i] + 1, k);
  if (from == From::key) {
    world.sample_key(at, points, key);
    for (std::size_t i = 0; i < pixels.count; ++i) pixels.light[i]->key() += key[i];
  } else {
    world.sample_ambient(at, points, ambient);
    for (std::size_t i = 0; i < pixels.count; ++i) pixels.light[i]->ambient() += ambient[i].array();
  }
}

// Of two pixels beside each other that are alike one is enough, as the mean is taken over more.
void LightMap::add_beyond(const World& world, const Viewport& view, Pixels& pixels) const {
  std::array<const Surfel*, World::k_batch> at;
  std::array<Light*, World::k_batch> light;
  std::array<Ray, World::k_batch> rays;
  std::array<bool, World::k_batch> is_copy{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels.count; ++i) {
    if (!optics_of(pixels.at[i]->look).is_coated()) continue;
    is_copy[i] = i > 0 && !is_copy[i - 1] && pixels.y[i] == pixels.y[i - 1] &&
                 pixels.x[i] == pixels.x[i - 1] + 1 &&
                 alike(*pixels.at[i], *pixels.at[i - 1], 4 * footprint_ * pixels.at[i]->distance);
    if (is_copy[i]) continue;
    at[count] = pixels.at[i];
    light[count] = pixels.light[i];
    rays[count++] = ray_through(view, pixels.x[i], pixels.y[i]);
  }
  world.look_beyond({at.data(), count}, rays, light);
  for (std::size_t i = 0; i < pixels.count; ++i)
    if (is_copy[i]) pixels.light[i]->values.tail<4>() = pixels.light[i - 1]->values.tail<4>();
}

// By the variance of the first samples. Where several objects meet, more samples are needed in any case, as
// fewer pixels share theirs.
bool LightMap::is_noisy(const World& world, const Pixels& pixels, From from) const {
  if (noise_ == 0) return true;
  float sum = 0, squares = 0;
  for (std::size_t i = 0; i < pixels.count; ++i) {
    const Surfel& seen = *pixels.at[i];
    if (!seen.same_object(*pixels.at[0])) return true;
    const Light& light = *pixels.light[i];
    const float value = seen.albedo.maxCoeff() *
                        (from == From::key ? world.key_share(seen) * light.key() : light.ambient().mean());
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<float>(std::max<std::size_t>(1, pixels.count));
  const float variance = std::max(0.0f, squares / count - sum / count * (sum / count));
  // Of the mean over an interleaved set of 16. Stratified, it is about twice as good as one by chance.
  return std::sqrt(variance / (InterleavedDisc::k_tile * InterleavedDisc::k_tile)) / 2 > noise_;
}

std::uint8_t LightMap::common(const std::vector<std::uint8_t>& kinds, const Tile& tile) const {
  std::uint8_t kind = k_floor | k_calm;
  for (int y = std::max(0, tile.y - 1); y <= std::min(tiles_y_ - 1, tile.y + 1); ++y)
    for (int x = std::max(0, tile.x - 1); x <= std::min(tiles_x_ - 1, tile.x + 1); ++x)
      kind &= kinds[index(Tile{x, y, 0, 0, 0, 0})];
  return kind;
}

void LightMap::look_around() {
  for_tiles([&](const Tile& tile) { around_[index(tile)] = common(kinds_, tile); });
}

void LightMap::fill(const World& world, const Viewport& view, const Tile& tile) {
  look(world, view, tile, true);
  for (int y = tile.top; y < tile.bottom; ++y)
    for (int x = tile.left; x < tile.right; ++x) light_[index(x, y)] = scratch_[index(x, y)] = Light::open();
  kinds_[index(tile)] = k_calm | (kind_of(tile) & k_floor);
}

// One axis of the mean over the 4 × 4 window in which the interleaved set is whole: five pixels of which the
// outer two count half, so that the window has a middle.
void LightMap::average(const std::vector<Light>& from, std::vector<Light>& to, int step_x, int step_y) const {
  static_assert(3 * k_window <= k_tile, "what is read lies in the tiles around");
  const std::ptrdiff_t step = step_x + static_cast<std::ptrdiff_t>(step_y) * width_;
  // What is seen in a surface and through it has detail that the wide mean would wash out.
  const bool all = step_x + step_y == 1;
  for_tiles([&](const Tile& tile) {
    if (is_still(tile)) return;
    const int margin_x = k_window * step_x, margin_y = k_window * step_y;
    const bool inside = tile.left >= margin_x && tile.right + margin_x <= width_ && tile.top >= margin_y &&
                        tile.bottom + margin_y <= height_;
    const bool flat = inside && is_flat(tile);
    for (int y = tile.top; y < tile.bottom; ++y) {
      for (int x = tile.left; x < tile.right; ++x) {
        const std::size_t i = index(x, y);
        if (flat) {
          const Light* near = &from[i];
          to[i].values = 0.125f * (near[-2 * step].values + near[2 * step].values) +
                         0.25f * (near[-step].values + near[0].values + near[step].values);
        } else if (surfels_[i].look == Look::none) {
          to[i] = from[i];
        } else {
          to[i] = mean_of_alike(from, x, y, step_x, step_y);
          if (!all) to[i].values.tail<4>() = from[i].values.tail<4>();
        }
      }
    }
  });
}

Light LightMap::mean_of_alike(const std::vector<Light>& from, int x, int y, int step_x, int step_y) const {
  const Surfel& here = surfels_[index(x, y)];
  const float reach = 2 * footprint_ * here.distance * static_cast<float>(step_x + step_y);
  Light sum;
  float weights = 0;
  for (int k = -k_window; k <= k_window; ++k) {
    const int nx = x + k * step_x, ny = y + k * step_y;
    if (nx < 0 || ny < 0 || nx >= width_ || ny >= height_) continue;
    const std::size_t j = index(nx, ny);
    if (!alike(here, surfels_[j], reach)) continue;
    const float weight = std::abs(k) == k_window ? 0.5f : 1.0f;
    sum.values += weight * from[j].values;
    weights += weight;
  }
  return {.values = sum.values / weights};
}

bool LightMap::is_edge(int x, int y) const {
  const Surfel& here = surfels_[index(x, y)];
  const auto differs = [&](int nx, int ny) {
    if (nx < 0 || ny < 0 || nx >= width_ || ny >= height_) return false;
    const Surfel& there = surfels_[index(nx, ny)];
    if (here.veil.shape != there.veil.shape || here.veil.light != there.veil.light) return true;
    if (here.look == Look::none && there.look == Look::none) return false;
    return !alike(here, there, 4 * footprint_ * here.distance);
  };
  return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
}

Light LightMap::light_near(const World& world, const Ray& ray, const Surfel& seen, int x, int y) const {
  Light sum;
  float count = 0;
  for (int ny = std::max(0, y - 1); ny <= std::min(height_ - 1, y + 1); ++ny) {
    for (int nx = std::max(0, x - 1); nx <= std::min(width_ - 1, x + 1); ++nx) {
      const std::size_t j = index(nx, ny);
      if (!alike(seen, surfels_[j], 4 * footprint_ * seen.distance)) continue;
      sum.values += light_[j].values;
      count += 1;
    }
  }
  if (count > 0) return {.values = sum.values / count};
  Light light;
  Light* const to = &light;
  const Surfel* const at = &seen;
  std::array<Vec3, 1> ambient;
  world.sample_key({&at, 1}, {&key_points_.at(x, y, 0), 1}, {&light.key(), 1});
  world.sample_ambient({&at, 1}, {&hemisphere_points_.at(y + 2, x + 1, 0), 1}, ambient);
  light.ambient() = ambient[0].array();
  world.look_beyond({&at, 1}, {&ray, 1}, {&to, 1});
  return light;
}

}  // namespace mallow::render
