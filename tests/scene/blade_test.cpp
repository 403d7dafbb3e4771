// The scenes blade.toml, pastry_wheel.toml and filled_shell.toml of data/scenes: colliders that cut what
// flows.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace blade_test {

Scene scene_of(const char* name) {
  return read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes" / name);
}

Scene blade_scene() {
  Scene scene = scene_of("blade.toml");
  EXPECT_EQ(scene.colliders[0].sources.size(), 1u) << "the blade is a mesh";
  return scene;
}

/// What events of a run told.
struct Told {
  int torn = 0, merged = 0, split = 0;
  std::size_t parts = 1;
};
Told run(Simulation& s, double until) {
  Told told;
  while (s.time() < until) {
    s.step();
    for (const BodyEvent& event : s.events()) {
      told.torn += event.kind == BodyEvent::Kind::torn;
      told.merged += event.kind == BodyEvent::Kind::merged;
      told.split += event.kind == BodyEvent::Kind::split;
      if (event.parts > 0) told.parts = event.parts;
    }
  }
  return told;
}

TEST(mesh_blade, cuts_a_small_lump_in_two_that_stay_apart_where_it_has_been) {
  Scene scene = blade_scene();
  auto& lump = std::get<SphereSource>(scene.bodies[0].source);
  lump.radius = 0.03f;
  lump.center.z() = 0.032f;
  Simulation s = build(scene, 2);
  s.prepare();
  const std::vector<Vec3> start = s.positions_by_id();
  const Told told = run(s, 1.3);  // cut, pushed aside, and the blade has risen
  EXPECT_EQ(told.torn, 1);
  EXPECT_EQ(told.merged, 0);
  EXPECT_EQ(told.parts, 2u);
  const std::vector<Vec3> x = s.positions_by_id();
  float left = -1, right = 1;
  std::size_t near = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (start[i].y() < 0)
      left = std::max(left, x[i].y());
    else
      right = std::min(right, x[i].y()), ++near;
  }
  EXPECT_NEAR(static_cast<double>(near) / static_cast<double>(x.size()), 0.5, 0.02);
  EXPECT_GT(right - left, 0.03f) << "one half was pushed by 3 cm";
}

TEST(mesh_blade, cuts_the_lump_of_its_scene_in_three) {
  const Scene scene = blade_scene();
  Simulation s = build(scene, 2);
  const Told told = run(s, scene.run.frames * *scene.run.frame_time);
  EXPECT_EQ(told.torn, 2);
  EXPECT_EQ(told.merged, 0);
  EXPECT_EQ(told.parts, 3u);
}

constexpr double k_turned = 200 * std::numbers::pi / 180;  ///< of the wheel when it is half way [rad]

TEST(pastry_wheel, turns_as_it_rolls_and_cuts_the_sheet_of_its_scene_in_two) {
  const Scene scene = scene_of("pastry_wheel.toml");
  Simulation s = build(scene, 2);
  EXPECT_TRUE(warnings(scene, s.info()).empty());
  const std::vector<Vec3> start = s.positions_by_id();
  const Eigen::Vector4d first = s.colliders()[0].pose.rotation;
  const Told told = run(s, 0.7);
  EXPECT_NEAR(std::abs(first.dot(s.colliders()[0].pose.rotation)), std::abs(std::cos(k_turned / 2)), 1e-2);
  EXPECT_EQ(told.torn, 0) << "it is half way";
  const Told end = run(s, scene.run.frames * *scene.run.frame_time);
  EXPECT_EQ(end.torn, 1);
  EXPECT_EQ(end.merged, 0);
  EXPECT_EQ(end.parts, 2u);
  std::size_t stayed = 0;
  const std::vector<Vec3> x = s.positions_by_id();
  for (std::size_t i = 0; i < start.size(); ++i) stayed += start[i].y() * x[i].y() > 0;
  EXPECT_GT(static_cast<double>(stayed), 0.97 * static_cast<double>(start.size())) << "each half on its side";
}

/// What of a half of the praline is shell and filling, and where along y.
struct Half {
  double shell = 0, filling = 0;
  float shell_from = 1, shell_to = -1, filling_from = 1, filling_to = -1;
};

TEST(praline, is_halved_and_its_filling_bulges_out_of_the_halves) {
  Simulation s = build(scene_of("filled_shell.toml"), 2);
  s.prepare();
  const double half_of_all = 0.5 * static_cast<double>(s.particle_count());
  const Told told = run(s, 1.45);  // cut, and pushed aside
  EXPECT_EQ(told.torn, 1);
  EXPECT_EQ(told.merged, 0);
  EXPECT_EQ(told.split, 1);
  ASSERT_EQ(s.info().bodies.size(), 2u);
  std::array<Half, 2> halves;
  for (std::size_t k = 0; k < 2; ++k) {
    const Simulation::Rows rows = s.rows(s.bodies()[k]);
    for (std::size_t i = rows.begin; i < rows.end; ++i) {
      const float y = s.positions()[i].y();
      const bool is_filling = s.alphas()[i] == 1;
      Half& half = halves[k];
      (is_filling ? half.filling : half.shell) += 1 / half_of_all;
      float& from = is_filling ? half.filling_from : half.shell_from;
      float& to = is_filling ? half.filling_to : half.shell_to;
      from = std::min(from, y);
      to = std::max(to, y);
    }
  }
  for (const Half& half : halves) {
    EXPECT_NEAR(half.shell + half.filling, 1, 0.05);
    EXPECT_NEAR(half.filling, 0.7, 0.05) << "0.9 cubed is the filling's share";
  }
  const auto& [left, right] =
      halves[0].shell_to < halves[1].shell_to ? halves : std::array{halves[1], halves[0]};
  EXPECT_GT(right.shell_from - left.shell_to, 0.015f);
  EXPECT_GT(left.filling_to, left.shell_to + 0.005f) << "it bulges out";
  EXPECT_LT(left.filling_to, std::min(right.shell_from, right.filling_from)) << "and not into the other half";
}

}  // namespace blade_test
}  // namespace mallow
