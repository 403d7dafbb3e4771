#include <gtest/gtest.h>

#include <limits>

#include "config/field_tables.h"
#include "mallow/errors.h"
#include "mallow/quality.h"

namespace mallow {
namespace voxels_test {

TEST(at_voxels, multiplies_voxels_along_a_length_however_they_are_given) {
  const SurfaceConfig config{.voxels_per_spacing = 2, .voxel_size = 0.3f, .voxels = 100};
  const SurfaceConfig finer = at_voxels(config, 1.5f);
  EXPECT_EQ(finer.voxels_per_spacing, 3);
  EXPECT_EQ(finer.voxel_size, 0.2f);
  EXPECT_EQ(finer.voxels, 150);
  EXPECT_EQ(finer.kernel_radius, config.kernel_radius);
  EXPECT_FALSE(at_voxels({}, 2).voxel_size || at_voxels({}, 2).voxels) << "what is left out stays so";
}

TEST(at_voxels, stays_in_the_ranges_of_settings) {
  for (const float factor : {1e-6f, 1e6f}) {
    const SurfaceConfig config = at_voxels({.voxels = 100}, factor);
    EXPECT_TRUE(range_of(&SurfaceConfig::voxels_per_spacing).holds(config.voxels_per_spacing));
    EXPECT_TRUE(range_of(&SurfaceConfig::voxels).holds(*config.voxels));
  }
  for (const float factor : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_THROW(at_voxels({}, factor), ConfigError);
}

}  // namespace voxels_test
}  // namespace mallow
