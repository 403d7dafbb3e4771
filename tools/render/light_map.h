#pragma once

#include <array>
#include <vector>

#include "core/parallel.h"
#include "render/sampling.h"
#include "render/viewport.h"
#include "render/world.h"

namespace mallow::render {

/// What is seen through the middle of each pixel, and the light there, with little noise: neighbours take
/// different samples and share them. Work goes by tiles of 8 × 8 pixels, each by itself, so that the number
/// of threads cannot matter.
class LightMap {
 public:
  LightMap(const RenderConfig& config, const Threads& threads);

  void trace(const World& world, const Viewport& view);

  const Surfel& surfel(int x, int y) const { return surfels_[index(x, y)]; }
  const Light& light(int x, int y) const { return light_[index(x, y)]; }
  /// Whether objects, or parts of one that look elsewhere, meet at a pixel.
  bool is_edge(int x, int y) const;
  /// The light on what another ray of a pixel sees: that of the pixels around, or one sample where none of
  /// them is like it.
  Light light_near(const World& world, const Ray& ray, const Surfel& seen, int x, int y) const;

  static constexpr int k_tile = 8;
  struct Tile {
    int x, y;  // in tiles
    int left, top, right, bottom;
  };
  template <class Body>
  void for_tiles(const Body& body) const;
  /// Whether a tile and those around it are floor in the open, and backdrop: of such a tile nothing is kept.
  bool is_still(const Tile& tile) const { return (around_[index(tile)] & k_calm) != 0; }
  /// Whether a tile and those around it are all floor: nothing is an edge there.
  bool is_flat(const Tile& tile) const { return (around_[index(tile)] & k_floor) != 0; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  std::size_t index(const Tile& tile) const {
    return static_cast<std::size_t>(tile.y) * static_cast<std::size_t>(tiles_x_) +
           static_cast<std::size_t>(tile.x);
  }
  std::uint8_t common(const std::vector<std::uint8_t>& kinds, const Tile& tile) const;
  void look_around();
  /// Makes up for what was left out of a calm tile.
  void fill(const World& world, const Viewport& view, const Tile& tile);
  /// The pixels of a tile that see something.
  struct Pixels {
    std::array<const Surfel*, World::k_batch> at;
    std::array<Light*, World::k_batch> light;
    std::array<std::int16_t, World::k_batch> x, y;
    std::size_t count = 0;
  };
  enum class From : std::uint8_t { key, all_around };
  Pixels pixels_of(const Tile& tile);
  /// Finds what is seen in a tile. past: only floor and backdrop can be.
  void look(const World& world, const Viewport& view, const Tile& tile, bool past);
  std::uint8_t kind_of(const Tile& tile) const;
  bool is_open(const World& world, const Viewport& view, const Tile& tile) const;
  bool is_noisy(const World& world, const Pixels& pixels, From from) const;
  /// Adds sample k of the light to that of the pixels.
  void add_sample(const World& world, Pixels& pixels, From from, int k) const;
  void add_beyond(const World& world, const Viewport& view, Pixels& pixels) const;
  void trace(const World& world, const Viewport& view, const Tile& tile, bool past);
  void average(const std::vector<Light>& from, std::vector<Light>& to, int step_x, int step_y) const;
  Light mean_of_alike(const std::vector<Light>& from, int x, int y, int step_x, int step_y) const;
  static constexpr int k_window = InterleavedDisc::k_tile / 2;

  int width_, height_, samples_, tiles_x_, tiles_y_;
  float noise_;
  const Threads& threads_;
  float footprint_ = 0;
  InterleavedDisc key_points_;
  InterleavedDisc hemisphere_points_;
  std::vector<Surfel> surfels_;
  std::vector<Light> light_;
  std::vector<Light> scratch_;
  // Of tiles: all is floor, without a veil; only floor in the open and backdrop, which need no smoothing.
  static constexpr std::uint8_t k_floor = 1, k_calm = 2;
  std::vector<std::uint8_t> kinds_;
  std::vector<std::uint8_t> around_;  // what a tile and those around it have in common
};

template <class Body>
void LightMap::for_tiles(const Body& body) const {
  parallel_for(
      threads_, static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const int x = static_cast<int>(i) % tiles_x_, y = static_cast<int>(i) / tiles_x_;
          body(Tile{x, y, x * k_tile, y * k_tile, std::min(width_, (x + 1) * k_tile),
                    std::min(height_, (y + 1) * k_tile)});
        }
      },
      4);
}

}  // namespace mallow::render
