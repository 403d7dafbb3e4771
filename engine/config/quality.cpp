#include "mallow/quality.h"

#include <algorithm>
#include <cmath>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "config/validation.h"

namespace mallow {
namespace {

void check_factor(float factor) {
  Checks checks;
  check_value("factor", factor, k_positive, checks);
  checks.finish();
}

/// What a quality does to the settings of a scene: points on the fronts of bench/RESULTS.md.
struct Preset {
  float time_step;       ///< factor
  int region_stride;     ///< at least
  float neighbor_slack;  ///< at least
  float voxels;          ///< factor
};

const Preset& preset(Quality quality) {
  static constexpr Preset k_realtime{1.5f, 3, 0.0f, 0.5f};
  static constexpr Preset k_balanced{1.0f, 2, 0.0f, 1.0f};
  static constexpr Preset k_accurate{0.5f, 1, 0.1f, 1.5f};
  return quality == Quality::realtime ? k_realtime : quality == Quality::balanced ? k_balanced : k_accurate;
}

/// The nearest number in a range of both bounds.
float within(const Range& range, float value) {
  return std::clamp(value, static_cast<float>(range.lowest), static_cast<float>(range.highest));
}

}  // namespace

SolverConfig at_time_step(const SolverConfig& config, float factor) {
  check_factor(factor);
  SolverConfig result = config;
  result.time_step_factor *= factor;
  return result;
}

SurfaceConfig at_voxels(const SurfaceConfig& config, float factor) {
  check_factor(factor);
  SurfaceConfig result = config;
  result.voxels_per_spacing =
      within(range_of(&SurfaceConfig::voxels_per_spacing), factor * config.voxels_per_spacing);
  if (config.voxels)
    result.voxels = static_cast<int>(
        std::lround(within(range_of(&SurfaceConfig::voxels), factor * static_cast<float>(*config.voxels))));
  if (config.voxel_size) result.voxel_size = *config.voxel_size / factor;
  return result;
}

const char* name(Quality quality) {
  return quality == Quality::realtime ? "realtime" : quality == Quality::balanced ? "balanced" : "accurate";
}

std::span<const Quality> qualities() {
  static constexpr Quality k_all[] = {Quality::realtime, Quality::balanced, Quality::accurate};
  return k_all;
}

SolverConfig with_quality(const SolverConfig& config, Quality quality) {
  const Preset& p = preset(quality);
  SolverConfig result = at_time_step(config, p.time_step);
  // Elasticity carries no more where it follows from the time step.
  if (p.time_step > 1)
    result.time_step_factor =
        std::max(config.time_step_factor, std::min(result.time_step_factor, p.time_step));
  result.neighbor_slack = std::max(config.neighbor_slack, p.neighbor_slack);
  return result;
}

Material with_quality(const Material& material, const SolverConfig& config, Quality quality) {
  const Preset& p = preset(quality);
  Material result = material;
  if (p.time_step > 1 && config.time_step && material.elastic_time_step) {
    // Rather softer than unstable.
    const float factor = with_quality(config, quality).time_step_factor;
    const float softest =
        (1 - material.alpha.lowest()) * factor * factor * *config.time_step / most_pull(material);
    result.elastic_time_step = std::max(*material.elastic_time_step, softest);
  }
  result.region_stride = std::max(material.region_stride, p.region_stride);
  return result;
}

SurfaceConfig with_quality(const SurfaceConfig& config, Quality quality) {
  return at_voxels(config, preset(quality).voxels);
}

}  // namespace mallow
