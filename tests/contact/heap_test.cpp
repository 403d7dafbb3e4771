// Many bodies in a bin.
#include <gtest/gtest.h>

#include "contact/cubes.h"

namespace mallow {
namespace heap_test {

using namespace contact_tests;

/// Twice the mean height of all particles: the height of a heap as high everywhere.
double height(const Simulation& s) {
  double sum = 0;
  for (const Vec3& x : s.positions_by_id()) sum += static_cast<double>(x.z());
  return 2 * sum / static_cast<double>(s.positions().size());
}

// At this gravity their weight presses a pile of that height together by a twentieth, and the default yield
// takes another sixth. Three times that makes it lower than its volume packed perfectly.
TEST(heap, of_200_cubes_in_a_bin_falls_asleep_higher_than_its_volume_packed_perfectly_and_stays) {
  constexpr float width = 26, pitch = (width - 1) / 4;
  Simulation s(solver(0.1f));
  for (int k = 0; k < 200; ++k) {
    const int across = k % 4, along = k / 4 % 4, layer = k / 16;
    const Vec3 corner(
        0.6f - width / 2 + pitch * static_cast<float>(across) + 0.2f * static_cast<float>(layer % 2),
        0.6f - width / 2 + pitch * static_cast<float>(along) + 0.1f * static_cast<float>(layer % 3),
        0.6f + 5.4f * static_cast<float>(layer));
    s.add_body(box({5, 5, 5}, corner), Material{});
  }
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  s.add_collider(
      {.shape = Box{{-width / 2, -width / 2, -5}, {width / 2, width / 2, 100}, true}, .friction = 0.3f});
  int awake = 200;
  while (s.time() < 160 && awake > 0) awake = static_cast<int>(s.step().awake_bodies);
  EXPECT_EQ(awake, 0);
  const double packed = 200 * 125 / static_cast<double>(width * width), rests = height(s);
  EXPECT_GT(rests, 1.03 * packed);
  run(s, 60);
  EXPECT_EQ(s.step().awake_bodies, 0u);
  EXPECT_EQ(height(s), rests);
}

}  // namespace heap_test
}  // namespace mallow
