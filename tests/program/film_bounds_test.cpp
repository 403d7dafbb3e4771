#include "program/film_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "program/large_pieces.h"
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

constexpr std::array k_spacings = {0.01f};

Aabb bounds_of(const std::string& more) {
  const Scene scene = scene_of(more);
  return FilmBounds(k_spacings, snapshot(build(scene, 1))).box(scene);
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

TEST(film_bounds, hold_all_particles_as_they_begin_and_later_not_what_flew_off_alone) {
  ParticleFrame frame;
  for (int i = 0; i < 1000; ++i)
    frame.positions.push_back(0.01f * Vec3(static_cast<float>(i % 10), static_cast<float>(i / 10 % 10),
                                           static_cast<float>(i / 100)));
  frame.positions.push_back({4, 0, 0});
  frame.bodies.assign(1001, 0);
  const Scene scene = scene_of(k_cube);
  EXPECT_TRUE(holds(FilmBounds(k_spacings, frame).box(scene), {4, 0, 0}));
  frame.time = 1;
  EXPECT_FALSE(holds(FilmBounds(k_spacings, frame).box(scene), {4, 0, 0}));
}

TEST(film_bounds, hold_a_plate_whole_that_is_a_few_times_as_wide_as_what_moves) {
  const auto plate = [](const std::string& half) {
    return bounds_of(k_cube + "[[collider]]\nbox = { min = [-" + half + ", -" + half + ", -0.01], max = [" +
                     half + ", " + half + ", 0] }\n");
  };
  EXPECT_TRUE(holds(plate("0.24"), {0.24f, -0.24f, 0}));
  EXPECT_FALSE(holds(plate("9"), {0.24f, -0.24f, 0})) << "a table as large as a room";
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
      FilmBounds bounds(std::array{spread * 0.1f / 9});  // it does not come apart
      std::vector<ParticleFrame> frames = puddle(spread);
      frames[2].positions[7] = {90, 0, 1};  // flies off alone
      for (const ParticleFrame& frame : frames) bounds.add(frame);
      const render::Camera camera =
          render::frame_camera(bounds.boxes(scene), scene.render, visible_colliders(scene));
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

/// Where particles are seen: a part of the picture from 0 to 1 along each of its sides.
struct Seen {
  Eigen::Array2f lowest = Eigen::Array2f::Constant(1e9f), highest = -lowest;
  bool whole = true;  ///< whether all of them are in the picture
  void add(const render::Viewport& view, const Vec3& x) {
    const auto pixel = view.pixel(x);
    whole = whole && pixel && (*pixel).x() >= 0 && (*pixel).y() >= 0 && (*pixel).x() <= view.width &&
            (*pixel).y() <= view.height;
    if (!pixel) return;
    const Eigen::Array2f at = pixel->array() / Eigen::Array2f(view.width, view.height);
    lowest = lowest.min(at.max(0).min(1));
    highest = highest.max(at.max(0).min(1));
  }
  float width() const { return highest.x() - lowest.x(); }
};

TEST(film_bounds, of_a_splash_crop_drops_alone_and_show_water_a_quarter_wide_in_most_frames) {
  const Scene scene = parse_scene(
      "[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = \"water\"\nbox = { count = [10, 10, 10], "
      "spacing = 0.01, corner = [-0.05, -0.05, 0.3] }\n[[collider]]\nplane = {}\n",
      "scene.toml");
  Simulation simulation = build(scene, 1);
  std::vector<ParticleFrame> frames{snapshot(simulation)};
  FilmBounds bounds(k_spacings, frames.front());
  while (frames.size() < 26) {
    simulation.advance(1.0 / 30);
    bounds.add(frames.emplace_back(snapshot(simulation)));
  }
  const render::Viewport view(
      render::frame_camera(bounds.boxes(scene), scene.render, visible_colliders(scene)), 960, 540);
  std::size_t wide = 0;
  for (const ParticleFrame& frame : frames) {
    const std::vector<bool> large = in_large_pieces(frame, k_spacings);
    Seen all, pieces;
    for (std::size_t i = 0; i < frame.positions.size(); ++i) {
      all.add(view, frame.positions[i]);
      if (large[i]) pieces.add(view, frame.positions[i]);
    }
    EXPECT_TRUE(pieces.whole) << frame.time;
    EXPECT_GT(all.width(), 0.07f) << frame.time;
    wide += all.width() > 0.25f ? 1 : 0;
  }
  EXPECT_GT(2 * wide, frames.size()) << wide;
}

TEST(film_bounds, of_what_drips_hold_the_drops_that_all_of_it_became) {
  FilmBounds bounds(k_spacings);
  ParticleFrame frame;
  for (int drop = 0; drop < 40; ++drop) {
    frame.positions.push_back({0.05f * static_cast<float>(drop), 0, 0});
    frame.bodies.push_back(0);
    frame.time += 0.1;
    bounds.add(frame);
  }
  const Scene scene = scene_of(k_cube);
  EXPECT_TRUE(holds(bounds.box(scene), {1.95f, 0, 0}));
}

TEST(film_bounds, leave_out_what_a_nozzle_holds_once_something_has_left_it) {
  const Scene scene = scene_of(
      "[[emitter]]\nmaterial = \"paste\"\nradius = 0.02\nspacing = 0.01\ntranslate = [0, 0, 0.3]\n"
      "rotate = [180.0, 0.0, 0.0]\nvelocity = [0.1, 0.0, 0.0]\nspeed = 0.5\n");
  Simulation simulation = build(scene, 1);
  FilmBounds bounds(k_spacings, snapshot(simulation), scene.emitters);
  EXPECT_TRUE(holds(bounds.box(scene), {0, 0, 0.4f})) << "there is nothing else";
  for (int frame = 1; frame <= 6; ++frame) {
    simulation.advance(0.04);
    bounds.add(snapshot(simulation));
    for (const EmitterId nozzle : simulation.emitter_ids()) {
      const std::vector<ParticleId> held = simulation.held(nozzle);
      for (std::size_t row = 0; row < simulation.particle_count(); ++row)
        if (std::ranges::find(held, simulation.ids()[row]) == held.end()) {
          EXPECT_TRUE(holds(bounds.box(scene), simulation.positions()[row])) << frame << ' ' << row;
        }
    }
  }
  EXPECT_LT(bounds.box(scene).max.z(), 0.33f);
}

/// So many particles in a row, from a place on.
void add_row(float x, int count, std::uint32_t body, ParticleFrame& frame) {
  for (int i = 0; i < count; ++i) {
    frame.positions.push_back({x + 0.011f * static_cast<float>(i), -0.3f, 0.2f});
    frame.bodies.push_back(body);
  }
}

TEST(large_pieces, are_those_with_a_twentieth_of_their_body) {
  ParticleFrame frame;
  add_row(0, 89, 0, frame);    // x up to 0.97
  add_row(1.1f, 4, 0, frame);  // 4 of 100: a drop
  add_row(-1, 7, 0, frame);    // large
  add_row(1.2f, 3, 1, frame);  // all of another body
  add_row(9, 1, 2, frame);     // of a body whose spacing is not known
  add_row(90, 99, 2, frame);
  const std::vector<bool> large = in_large_pieces(frame, std::array{0.01f, 0.01f});
  for (std::size_t i = 0; i < frame.positions.size(); ++i) EXPECT_EQ(large[i], i < 89 || i >= 93) << i;
  EXPECT_TRUE(in_large_pieces({}, {}).empty());
}

/// A blob joined by nothing but diagonals, and to within one and a half spacings.
TEST(large_pieces, hang_together_along_every_direction) {
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz) {
        if (dx == 0 && dy == 0 && dz == 0) continue;
        const Vec3 way =
            Vec3(static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(dz)).normalized();
        ParticleFrame frame;
        for (int i = 0; i < 60; ++i)
          frame.positions.push_back(Vec3(3, -5, 0) + 0.0149f * static_cast<float>(i) * way);
        frame.bodies.assign(60, 0);
        const std::vector<bool> large = in_large_pieces(frame, k_spacings);
        EXPECT_EQ(std::ranges::count(large, true), 60) << way.transpose();
      }
}

}  // namespace film_bounds_test
}  // namespace mallow::program
