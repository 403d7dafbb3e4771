#include "textbook/from_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "refusal.h"

namespace mallow::textbook {
namespace from_scene_test {

Scene cube_3375() {
  return read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/table1/cube_3375.toml");
}

/// [h]
double largest_deviation(const Textbook& textbook, const Simulation& engine) {
  const std::vector<Vec3> positions = engine.positions_by_id();
  double largest = 0;
  for (std::size_t id = 0; id < textbook.size(); ++id) {
    const Particle& p = textbook.particles()[id];
    const double deviation = (p.position - positions[id].cast<double>()).norm();
    largest = std::max(largest, deviation / textbook.groups()[p.group].spacing);
  }
  return largest;
}

TEST(from_scene, makes_the_particles_that_build_makes) {
  const Textbook textbook = from_scene(cube_3375());
  Simulation engine = build(cube_3375());
  ASSERT_EQ(textbook.size(), 3375u);
  ASSERT_EQ(textbook.size(), engine.particle_count());
  EXPECT_EQ(largest_deviation(textbook, engine), 0);
  const SimulationInfo info = engine.info();
  ASSERT_EQ(textbook.groups().size(), info.bodies.size());
  EXPECT_DOUBLE_EQ(textbook.average_neighbors(0), info.bodies[0].average_neighbors);
  EXPECT_FLOAT_EQ(static_cast<float>(textbook.groups()[0].rest_density), info.bodies[0].rest_density);
  EXPECT_FLOAT_EQ(static_cast<float>(textbook.groups()[0].mass), info.bodies[0].particle_mass);
}

TEST(from_scene, moves_as_build_does) {
  Textbook textbook = from_scene(cube_3375());
  Simulation engine = build(cube_3375());
  for (int c = 0; c < 20; ++c) {
    textbook.step();
    engine.step();
  }
  EXPECT_LE(largest_deviation(textbook, engine), 1e-3);
}

TEST(from_scene, puts_bodies_that_name_one_group_together_and_no_others) {
  Scene scene;
  scene.solver.support_radius = 2.2f;
  scene.materials = {{.name = "clay", .material = {.alpha = 0.5f}},
                     {.name = "milk", .material = {.alpha = 1.0f}}};
  const auto body = [](const char* material, const char* group, float x) {
    return SceneBody{.material = material, .group = group, .source = Lattice{{2, 2, 2}, 1.0f, {x, 0, 0}, 0}};
  };
  scene.bodies = {body("clay", "heap", 0), body("clay", "", 4), body("milk", "", 8), body("clay", "heap", 12),
                  body("clay", "", 16)};
  scene.pins = {{.box = {{7, -9, -9}, {11, 9, 9}}, .velocity = {0, 0, 1}}};
  const Textbook textbook = from_scene(scene);
  Simulation engine = build(scene);
  const std::vector<std::uint32_t> groups = engine.bodies_by_id();
  ASSERT_EQ(textbook.size(), groups.size());
  EXPECT_EQ(textbook.groups().size(), 4u);
  EXPECT_EQ(largest_deviation(textbook, engine), 0);
  for (std::size_t id = 0; id < textbook.size(); ++id) {
    const Particle& p = textbook.particles()[id];
    EXPECT_EQ(p.group, groups[id]) << "particle " << id;
    EXPECT_EQ(p.pinned, p.group == 2) << "particle " << id;
  }
}

TEST(from_scene, refuses_what_the_textbook_does_not_know) {
  const auto refused = [](const char* field, auto change) {
    Scene scene = cube_3375();
    change(scene);
    EXPECT_EQ(test::refusal([&] { from_scene(scene); }),
              std::string(field) + ": is not known to the textbook implementation");
  };
  refused("emitter[0]", [](Scene& s) { s.emitters.emplace_back(); });
  refused("sink[0]", [](Scene& s) { s.sinks.emplace_back(); });
  refused("material[0].temperature", [](Scene& s) { s.materials[0].material.temperature = 300.0f; });
  refused("material[0].adhesion", [](Scene& s) { s.materials[0].material.adhesion = 1; });
  refused("solver.wall_pressure", [](Scene& s) { s.solver.wall_pressure = true; });
  refused("body[0].paint", [](Scene& s) { s.bodies[0].paint.emplace_back(); });
  refused("body[0].merges", [](Scene& s) { s.bodies[0].merges = true; });
  refused("body[0].splits", [](Scene& s) { s.bodies[0].splits = true; });
}

}  // namespace from_scene_test
}  // namespace mallow::textbook
