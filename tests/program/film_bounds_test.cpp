#include "program/film_bounds.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/renderer.h"
#include "render/viewport.h"

namespace mallow::program {
namespace film_bounds_test {

/// A ground at 0 under 9.81 m/s², and more.
Scene scene_of(const std::string& more) {
  return parse_scene(
      "[solver]\ngravity = [0, 0, -9.81]\n[[material]]\nname = \"paste\"\nalpha = 0.5\n"
      "rest_density = 1000\n[[collider]]\nplane = {}\n" +
          more,
      "scene.toml");
}

Aabb bounds_of(const std::string& more) {
  const Scene scene = scene_of(more);
  return FilmBounds(snapshot(build(scene, 1))).box(scene, 0.01f);
}

bool holds(const Aabb& box, const Vec3& x) {
  return (x.array() >= box.min.array()).all() && (x.array() <= box.max.array()).all();
}

const std::string k_cube =
    "[[body]]\nmaterial = \"paste\"\nbox = { count = [10, 10, 10], spacing = 0.01, corner = [-0.05, -0.05, "
    "0] "
    "}\n";
TEST(film_bounds, hold_a_tool_at_all_of_its_keyframes) {
  const std::string tool = k_cube + "[[collider]]\nsphere = { radius = 0.02 }\n";
  const Aabb moved =
      bounds_of(tool +
                "keyframes = [{ time = 0.1, translate = [0, 0, 0.2] }, { time = 1, translate = "
                "[0, 0.15, 0.15] }]\n");
  EXPECT_TRUE(holds(moved, {0, 0, 0.22f}));
  EXPECT_TRUE(holds(moved, {0, 0.17f, 0.15f}));
  EXPECT_FALSE(holds(bounds_of(tool + "translate = [0, 0, 0.2]\n"), {0, 0.17f, 0.15f}));
  const Aabb room = bounds_of(k_cube +
                              "[[collider]]\nsphere = { radius = 50, inside = true }\nkeyframes = [{ "
                              "time = 0 }, { time = 1, translate = [9, 0, 0] }]\n");
  EXPECT_FALSE(holds(room, {9, 0, 0})) << "a room is not a tool";
}

/// A puddle that spreads from a drop to so many times its width.
std::vector<ParticleFrame> puddle(float spread) {
  std::vector<ParticleFrame> frames(5);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const float t = static_cast<float>(f) / 4, width = 0.1f * (1 + t * (spread - 1)),
                height = 0.3f * (1 - t) + 0.01f;
    for (int i = 0; i < 1000; ++i)
      frames[f].positions.push_back({width * (static_cast<float>(i % 10) / 9 - 0.5f),
                                     width * (static_cast<float>(i / 10 % 10) / 9 - 0.5f),
                                     height + 0.01f * static_cast<float>(i / 100)});
    frames[f].bodies.assign(1000, 0);
    frames[f].time = static_cast<double>(t);
  }
  return frames;
}

TEST(film_bounds, give_a_picture_that_what_the_film_shows_fills_and_never_leaves) {
  for (const std::string& more :
       {k_cube, k_cube + "[[collider]]\nbox = { min = [-0.3, -0.3, 0], max = [0.3, 0.3, "
                         "0.4], inside = true }\n"}) {
    const Scene scene = scene_of(more);
    for (const float spread : {1.0f, 3.0f, 8.0f}) {
      FilmBounds bounds;
      std::vector<ParticleFrame> frames = puddle(spread);
      frames[2].positions[7] = {90, 0, 1};  // flies off alone
      for (const ParticleFrame& frame : frames) bounds.add(frame);
      const render::Camera camera =
          render::frame_camera(bounds.box(scene, 0.01f), scene.render, visible_colliders(scene));
      const render::Viewport view(camera, scene.render.width, scene.render.height);
      frames[2].positions[7] = frames[2].positions[8];
      Eigen::Array2f lowest(1e9f, 1e9f), highest = -lowest;
      for (const ParticleFrame& frame : frames)
        for (const Vec3& x : frame.positions) {
          lowest = lowest.min(view.pixel(x)->array());
          highest = highest.max(view.pixel(x)->array());
        }
      const Eigen::Array2f sides(view.width, view.height);
      EXPECT_TRUE((lowest > 0.02f * sides).all() && (highest < 0.98f * sides).all()) << "cropped";
      EXPECT_GT(((highest - lowest) / sides).maxCoeff(), 0.4f) << "too small, spread " << spread;
    }
  }
}

}  // namespace film_bounds_test
}  // namespace mallow::program
