// Friction between bodies: where one slides from the other.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/cubes.h"

namespace mallow {
namespace friction_test {

using namespace contact_tests;

Material rubbing(float alpha, float friction) {
  Material result = material(alpha);
  result.friction = friction;
  return result;
}
/// How far a cube slides in 10 s on a block that is held, where gravity leans by this tangent.
double slide(const Material& block, const Material& cube, float tangent) {
  SolverConfig config = solver(0);
  config.gravity = Vec3(tangent, 0, -1) * (0.1f / std::sqrt(1 + tangent * tangent));
  Simulation s(config);
  s.add_body(box({24, 12, 4}, {-7, -6, -4}), block);
  s.add_body(box({6, 6, 6}, {-3, -3, 0}), cube);
  s.pin(Aabb{{-100, -100, -5}, {100, 100, -2}}, {0, 0, 0});
  run(s, 20);
  const double before = centers(s)[1].x();
  run(s, 10);
  return centers(s)[1].x() - before;
}

class AtAlpha : public testing::TestWithParam<float> {};

TEST_P(AtAlpha, a_cube_starts_to_slide_at_the_friction_of_both_within_a_tenth) {
  for (const float friction : {0.3f, 0.5f}) {
    const Material m = rubbing(GetParam(), friction);
    EXPECT_LT(std::abs(slide(m, m, 0.9f * friction)), 0.1) << friction;
    EXPECT_GT(slide(m, m, 1.1f * friction), 0.8) << friction;
  }
}
INSTANTIATE_TEST_SUITE_P(friction, AtAlpha, testing::Values(0.0f, 0.3f, 0.5f, 0.7f));

TEST(friction, of_two_materials_is_their_geometric_mean) {
  const Material smooth = rubbing(0, 0.1f), rough = rubbing(0, 0.9f);  // √(0.1 · 0.9) = 0.3
  for (const bool rough_below : {false, true}) {
    const Material &below = rough_below ? rough : smooth, &above = rough_below ? smooth : rough;
    EXPECT_LT(std::abs(slide(below, above, 0.27f)), 0.05) << rough_below;
    EXPECT_GT(slide(below, above, 0.33f), 0.8) << rough_below;
  }
}

}  // namespace friction_test
}  // namespace mallow
