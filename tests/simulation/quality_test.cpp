#include "mallow/quality.h"

#include <gtest/gtest.h>

#include <limits>

#include "mallow/simulation.h"

namespace mallow {
namespace quality_test {

TEST(time_step, at_another_one_everything_but_its_factor_stays) {
  const SolverConfig config{
      .time_step = 0.15f, .time_step_factor = 0.5f, .support_radius = 2, .update_interval = 20};
  for (const float factor : {0.5f, 0.25f, 1.0f, 2.0f}) {
    const SolverConfig there = at_time_step(config, factor);
    EXPECT_EQ(there.time_step_factor, 0.5f * factor);
    EXPECT_EQ(there.time_step, config.time_step);
    EXPECT_EQ(there.update_interval, config.update_interval);
  }
}

TEST(time_step, factors_that_make_no_sense_are_refused) {
  const SolverConfig config{.support_radius = 2};
  for (const float factor :
       {0.0f, -1.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    EXPECT_THROW(at_time_step(config, factor), ConfigError);
}

TEST(time_step, a_body_swings_the_same_at_half_the_step) {
  // A stretched elastic cube in free flight: its width over time is that of the material, not of the step.
  const auto width_at = [](float factor, double time) {
    SolverConfig config{.time_step = 0.02f, .support_radius = 2.5f, .gravity = {0, 0, 0}, .threads = 1};
    const Material material{.alpha = 0.0f, .elastic_time_step = 0.2f};
    config = at_time_step(config, factor);
    Body body = sample(Lattice{.count = {5, 5, 5}, .spacing = 1, .jitter = 0});
    for (const Vec3& x : body.positions) body.velocities.push_back(Vec3((x.x() - 2.5f) * 0.5f, 0, 0));
    Simulation simulation(config);
    simulation.add_body(body, material);
    while (simulation.time() < time - 1e-6) simulation.step();
    const auto x = simulation.positions().eigen().col(0);
    return x.maxCoeff() - x.minCoeff();
  };
  const float swung = width_at(1, 0.2), half = width_at(0.5f, 0.2), quarter = width_at(0.25f, 0.2);
  EXPECT_GT(swung, 4.02f) << "it has stretched";
  EXPECT_NEAR(half, quarter, 0.6f * std::abs(swung - half)) << "and the step's error halves with it";
  EXPECT_NEAR(swung, half, 0.02f);
}

/// Mean height of the top of a cube of six spacings, 0.6 m, that stands on a floor for two seconds: of the
/// second. threshold, period: left out where 0.
double height_at_rest(bool accurate, float alpha, float threshold, float period, int& updates) {
  SolverConfig config{.support_radius = 0.21f, .gravity = {0, 0, -9.81f}, .threads = 1};
  Material material{.alpha = alpha, .rest_density = 1000.0f, .deformation_damping = 0.0f};
  if (period > 0) config.update_period = period;
  if (threshold > 0) material.update_threshold = threshold;
  if (accurate) {
    material = with_quality(material, config, Quality::accurate);
    config = with_quality(config, Quality::accurate);
  }
  Simulation simulation(config);
  simulation.add_body(sample(Lattice{.count = {6, 6, 6}, .spacing = 0.1f, .corner = {-0.3f, -0.3f, 0}}),
                      material);
  simulation.add_collider({.shape = Plane{}, .friction = 0.3f});
  double sum = 0, seconds = 0;
  updates = 0;
  while (simulation.time() < 2) {
    const StepReport report = simulation.step();
    updates += report.updated_references;
    if (simulation.time() < 1) continue;
    sum += report.time_step * static_cast<double>(simulation.positions().eigen().col(2).maxCoeff());
    seconds += report.time_step;
  }
  return sum / seconds;
}

TEST(quality, accurate_rests_at_the_height_of_the_scene_as_written) {
  for (const float alpha : {0.0f, 0.3f, 0.7f, 0.9f}) {
    int updates = 0;
    const double written = height_at_rest(false, alpha, 0, 0, updates);
    EXPECT_NEAR(height_at_rest(true, alpha, 0, 0, updates) / written, 1, 0.01) << "alpha " << alpha;
    EXPECT_EQ(updates, 0);
  }
}

TEST(quality, accurate_rests_at_the_height_of_the_scene_as_written_where_its_weight_reshapes_it) {
  // At a threshold near what rest makes, 1.5 to 2 times gravity, whether a check fires is a toss-up.
  for (const float alpha : {0.0f, 0.3f, 0.7f, 0.9f})
    for (const float period : {0.05f, 0.2f}) {
      const float threshold = 1.2f * 9.81f / (1 - alpha);
      int updates = 0, accurate_updates = 0;
      const double written = height_at_rest(false, alpha, threshold, period, updates);
      const double accurate = height_at_rest(true, alpha, threshold, period, accurate_updates);
      EXPECT_NEAR(accurate / written, 1, 0.04) << "alpha " << alpha << ", checks every " << period << " s";
      EXPECT_GE(updates, 4);
      EXPECT_NEAR(accurate_updates, updates, 0.15 * updates);
    }
}

TEST(quality, names_are_those_that_people_type) {
  ASSERT_EQ(qualities().size(), 3u);
  EXPECT_STREQ(name(qualities()[0]), "realtime");
  EXPECT_STREQ(name(qualities()[1]), "balanced");
  EXPECT_STREQ(name(qualities()[2]), "accurate");
}

TEST(quality, never_makes_a_setting_worse_than_the_user_asked_for_speed_or_finer_than_for_accuracy) {
  SolverConfig config{.support_radius = 2};
  config.neighbor_slack = 0.5f;
  Material material;
  material.region_stride = 16;
  for (const Quality quality : qualities()) {
    EXPECT_EQ(with_quality(config, quality).neighbor_slack, 0.5f);
    EXPECT_EQ(with_quality(material, config, quality).region_stride, 16);
  }
}

TEST(quality, softens_a_material_rather_than_let_it_run_away) {
  for (const float factor : {1.0f, 0.5f, 1.2f})
    for (const float elastic : {0.15f, 0.1f, 0.06f}) {
      const SolverConfig config{.time_step = 0.15f, .time_step_factor = factor, .support_radius = 2};
      const Material material{.alpha = 0.0f, .elastic_time_step = elastic};
      const float there = with_quality(config, Quality::realtime).time_step_factor;
      EXPECT_LE(there, 1.5f);
      const float pull =
          there * there * 0.15f / *with_quality(material, config, Quality::realtime).elastic_time_step;
      EXPECT_LE(pull, 2.5001f) << elastic << ", factor " << factor;
    }
}

TEST(quality, of_a_surface_keeps_voxels_within_what_is_allowed) {
  EXPECT_EQ(with_quality(SurfaceConfig{.voxels = 8}, Quality::realtime).voxels, 8);
  EXPECT_EQ(with_quality(SurfaceConfig{.voxels = 1024}, Quality::accurate).voxels, 1024);
  EXPECT_EQ(with_quality(SurfaceConfig{.voxels = 128}, Quality::balanced).voxels, 128);
  for (const Quality quality : qualities()) {
    const float finer = static_cast<float>(*with_quality(SurfaceConfig{.voxels = 128}, quality).voxels) / 128;
    const SurfaceConfig turned = with_quality(SurfaceConfig{}, quality);
    EXPECT_EQ(turned.voxels_per_spacing, finer * SurfaceConfig{}.voxels_per_spacing);
    EXPECT_FALSE(turned.voxels || turned.voxel_size);
  }
  EXPECT_EQ(with_quality(SurfaceConfig{.voxels_per_spacing = 16}, Quality::accurate).voxels_per_spacing, 16);
  EXPECT_EQ(with_quality(SurfaceConfig{.voxels_per_spacing = 0.5f}, Quality::realtime).voxels_per_spacing,
            0.5f);
  const float coarse = *with_quality(SurfaceConfig{.voxel_size = 0.3f}, Quality::realtime).voxel_size;
  EXPECT_GT(coarse, 0.3f);
}

}  // namespace quality_test
}  // namespace mallow
