#include "mallow/quality.h"

#include <gtest/gtest.h>

#include <limits>

#include "mallow/simulation.h"

namespace mallow {
namespace {

TEST(time_step, at_another_one_the_elastic_pull_per_second_and_the_time_between_checks_stay) {
  const SolverConfig config{.time_step = 0.15f, .support_radius = 2, .update_interval = 20};
  const Material plain{}, stiff{.elastic_time_step = 0.05f};
  for (const float factor : {0.5f, 0.25f, 1.0f, 2.0f}) {
    const SolverConfig there = at_time_step(config, factor);
    EXPECT_FLOAT_EQ(there.time_step, 0.15f * factor);
    EXPECT_FLOAT_EQ(static_cast<float>(there.update_interval) * there.time_step, 20 * 0.15f);
    EXPECT_FLOAT_EQ(there.time_step * *at_time_step(plain, config, factor).elastic_time_step, 0.15f * 0.15f);
    EXPECT_FLOAT_EQ(there.time_step * *at_time_step(stiff, config, factor).elastic_time_step, 0.15f * 0.05f);
  }
}

TEST(time_step, factors_that_make_no_sense_are_refused) {
  const SolverConfig config{.support_radius = 2};
  for (const float factor :
       {0.0f, -1.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THROW(at_time_step(config, factor), ConfigError);
    EXPECT_THROW(at_time_step(Material{}, config, factor), ConfigError);
  }
  EXPECT_EQ(at_time_step({.support_radius = 2, .update_interval = 1}, 4).update_interval, 1);
}

TEST(time_step, a_body_swings_the_same_at_half_the_step) {
  // A stretched elastic cube in free flight: its width over time is that of the material, not of the step.
  const auto width_at = [](float factor, double time) {
    SolverConfig config{.time_step = 0.02f, .support_radius = 2.5f, .gravity = {0, 0, 0}, .threads = 1};
    Material material{.alpha = 0.0f, .elastic_time_step = 0.2f};
    material = at_time_step(material, config, factor);
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
  const SolverConfig config{.time_step = 0.15f, .support_radius = 2};
  for (const float elastic : {0.15f, 0.1f, 0.06f}) {
    const Material material{.alpha = 0.0f, .elastic_time_step = elastic};
    const SolverConfig there = with_quality(config, Quality::realtime);
    const float written = config.time_step / elastic;
    const float pull = there.time_step / *with_quality(material, config, Quality::realtime).elastic_time_step;
    EXPECT_LE(pull, 2.5001f) << elastic;
    EXPECT_GE(pull, std::min(2.4999f, written)) << elastic;
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

}  // namespace
}  // namespace mallow
