#include "program/end_warnings.h"

#include <gtest/gtest.h>

#include "mallow/materials.h"
#include "mallow/simulation.h"

namespace mallow::program {
namespace end_warnings_test {

TEST(crushed_share, counts_who_has_a_neighbour_within_three_tenths_of_a_spacing) {
  std::vector<Vec3> positions =
      sample(Lattice{.count = {9, 8, 7}, .spacing = 0.5f, .corner = {-2, 3, 1e3f}}).positions;
  EXPECT_EQ(crushed_share(positions, 0.5f), 0);
  const std::size_t apart = positions.size();
  // Across cells and along each axis, just within and just beyond.
  for (int axis = 0; axis < 3; ++axis)
    for (const float distance : {0.14f, -0.14f, 0.16f}) {
      const Vec3 base(static_cast<float>(20 * axis), 100 * distance, -9.0f);
      positions.push_back(base);
      positions.push_back(base + distance * Vec3::Unit(axis));
    }
  EXPECT_DOUBLE_EQ(crushed_share(positions, 0.5f), 12.0 / static_cast<double>(apart + 18));
  EXPECT_EQ(crushed_share({}, 1), 0);
}

TEST(end_warnings, name_one_elastic_body_of_a_material_that_yielded_to_what_nobody_asked_it_to_bear) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[0].name = "jelly";
  scene.materials[1].name = "paper";
  scene.materials[1].material.update_threshold = 0.3f;
  scene.bodies.resize(3);
  for (std::size_t body = 0; body < 3; ++body) scene.bodies[body].material = body < 2 ? "jelly" : "paper";
  SimulationInfo info;
  info.bodies.resize(3);
  ParticleFrame last;
  for (std::uint32_t body = 0; body < 3; ++body) {
    info.bodies[body].name = std::to_string(body);
    info.bodies[body].spacing = 1;
    info.bodies[body].shape_matching = true;
    for (int i = 0; i < 20; ++i) {  // two of the last eighteen lie on another, or four of the second body
      const bool near = i < (body == 1 ? 4 : 2);
      last.positions.push_back({near ? 0.1f * static_cast<float>(i) : static_cast<float>(i), 0, 0});
      last.bodies.push_back(body);
    }
  }
  const std::vector<std::string> all = end_warnings(scene, info, last);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(
      all[0].find("body '1': 20.0% of its particles ended nearer than 0.3 spacings to another, and so did "
                  "some of 1 more of its material: it was crushed, as what pressed it was more than "
                  "material.update_threshold bears"),
      0u)
      << all[0];
  for (BodyInfo& body : info.bodies) body.alpha = 0.8f;
  EXPECT_TRUE(end_warnings(scene, info, last).empty()) << "what splashes comes near";
}

TEST(end_warnings, name_matter_that_something_closed_on) {
  const auto after = [](float lid, bool mould) {
    RunReport report;
    Simulation s(SolverConfig{.gravity = {0, 0, -9.81f}, .threads = 1});
    s.add_body(sample(Lattice{.count = {6, 6, 6}, .spacing = 0.005f, .corner = {-0.015f, -0.015f, 0}}),
               materials::dough());
    s.add_collider({.shape = Plane{}, .friction = 0.5f});
    if (mould) s.add_collider({.shape = Box{{-0.018f, -0.018f, -1}, {0.018f, 0.018f, 1}, true}});
    const ColliderId press = s.add_collider({.shape = Plane{.normal = {0, 0, -1}}});
    s.set_pose(press, Pose{.translation = {0, 0, 0.035}});
    s.set_pose(press, Pose{.translation = {0, 0, static_cast<double>(lid)}}, 0.3);
    while (s.time() < 0.3) report.add(s.step(), s);
    return pressed_warning(report.compression);
  };
  EXPECT_FALSE(after(0.018f, false)) << "it goes aside";
  const auto warning = after(0.018f, true);
  ASSERT_TRUE(warning) << "where it cannot";
  EXPECT_NE(warning->find("left it less room than it fills"), std::string::npos) << *warning;
  EXPECT_FALSE(pressed_warning({.mean = 0.09, .largest = 3}));
  EXPECT_EQ(pressed_warning({.mean = 0.164, .largest = 1})->substr(0, 38),
            "matter was pressed together by 16% in ");
}

}  // namespace end_warnings_test
}  // namespace mallow::program
