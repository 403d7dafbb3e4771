// The scene data/scenes/blade.toml: a collider of a mesh that cuts what flows.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace blade_test {

Scene blade_scene() {
  Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/blade.toml");
  EXPECT_EQ(scene.colliders[0].sources.size(), 1u) << "the blade is a mesh";
  return scene;
}

/// What events of a run told.
struct Told {
  int torn = 0, merged = 0;
  std::size_t parts = 1;
};
Told run(Simulation& s, double until) {
  Told told;
  while (s.time() < until) {
    s.step();
    for (const BodyEvent& event : s.events()) {
      told.torn += event.kind == BodyEvent::Kind::torn;
      told.merged += event.kind == BodyEvent::Kind::merged;
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

}  // namespace blade_test
}  // namespace mallow
