// Settings of a session while it runs, and what its place between realtime and accurate makes of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "config/field_tables.h"
#include "program/film_bounds.h"
#include "simulation/settings.h"
#include "view/session.h"

namespace mallow::view {
namespace {

/// Voxels a spacing that surfaces are drawn with while somebody plays: what films ask for is finer than
/// moving pictures show, and takes longer than their steps.
constexpr float k_voxels_to_play = 2.7f;

/// What a running simulation takes over of a scene's settings.
SolverConfig running(const SolverConfig& now, const SolverConfig& wanted) {
  SolverConfig config = now;
  for_fields<SolverConfig>([&](const auto& field) {
    if (changes_while_running(field.name)) config.*field.member = wanted.*field.member;
  });
  return config;
}

}  // namespace

SurfaceConfig with_voxels(const SurfaceConfig& config, float factor) {
  const auto within = [](const Range& range, float value) {
    return std::clamp(value, static_cast<float>(range.lowest), static_cast<float>(range.highest));
  };
  SurfaceConfig result = config;
  result.voxels_per_spacing =
      within(range_of(&SurfaceConfig::voxels_per_spacing), factor * config.voxels_per_spacing);
  if (config.voxels)
    result.voxels = static_cast<int>(
        within(range_of(&SurfaceConfig::voxels), factor * static_cast<float>(*config.voxels)));
  if (config.voxel_size) result.voxel_size = *config.voxel_size / factor;
  return result;
}

MaterialId Session::material_id(std::size_t index) const {
  return materials_.at(index).value();
}

void Session::set_rung(int rung) {
  governor_.set_rung(rung);
  if (simulation_) apply_rung();
}

void Session::apply_rung() {
  const Rung& rung = rungs()[static_cast<std::size_t>(governor_.rung())];
  Rung reached = rung;
  // Springs may carry no longer steps: then the next shorter ones.
  for (const float factor : {rung.time_step, 1.25f, 1.0f}) {
    if (factor > rung.time_step) continue;
    SolverConfig config = running(simulation_->config(), scene_.solver);
    config.time_step_factor *= factor;
    try {
      if (config.time_step_factor != simulation_->config().time_step_factor) simulation_->set_solver(config);
      reached.time_step = factor;
      break;
    } catch (const ConfigError&) {
      reached.time_step = 1;
    }
  }
  for (std::size_t k = 0; k < materials_.size(); ++k) {
    if (!materials_[k]) continue;
    Material material = scene_.materials[k].material;
    material.region_stride *= rung.region_stride;
    if (simulation_->material_settings(*materials_[k]).region_stride != material.region_stride)
      simulation_->set_material(*materials_[k], material);
  }
  simulation_->prepare();
  rung_ = governor_.rung();
  given_up_ = describe(reached);
  if (reached.time_step < rung.time_step)
    given_up_ += std::string(given_up_.empty() ? "" : ", ") + "steps no longer, as springs carry no more";
  make_surface();
  changed_ = true;
}

SurfaceConfig Session::surface_to_play() const {
  const SurfaceConfig& config = scene_.surface;
  if (governor_.rung() < k_as_written || recording_) return config;
  float spacing = std::numeric_limits<float>::max(), size = 0;
  for (const BodyId body : simulation_->bodies()) {
    const Aabb box = simulation_->bounds(body);
    spacing = std::min(spacing, simulation_->spacing(body));
    size = std::max(size, (box.max - box.min).maxCoeff());
  }
  SurfaceConfig coarser = config;
  coarser.voxels_per_spacing = std::min(config.voxels_per_spacing, k_voxels_to_play);
  const float finest = spacing / k_voxels_to_play;
  if (config.voxel_size) coarser.voxel_size = std::max(*config.voxel_size, finest);
  if (config.voxels && size < finest * static_cast<float>(*config.voxels)) coarser.voxels.reset();
  return coarser;
}

void Session::make_surface() {
  const Rung& rung = rungs()[static_cast<std::size_t>(governor_.rung())];
  surface_.emplace(with_voxels(surface_to_play(), rung.voxels), skins_, threads_.threads());
  changed_ = true;
}

void Session::set_solver(const SolverConfig& solver) {
  if (!simulation_) return;
  const SolverConfig before = scene_.solver;
  scene_.solver = running(before, solver);
  try {
    const Rung& rung = rungs()[static_cast<std::size_t>(governor_.rung())];
    SolverConfig config = running(simulation_->config(), solver);
    config.time_step_factor *= rung.time_step;
    simulation_->set_solver(config);
    simulation_->prepare();
  } catch (const ConfigError&) {
    scene_.solver = before;
    throw;
  }
}

void Session::set_material(std::size_t index, const SceneMaterial& material) {
  if (!simulation_ || index >= scene_.materials.size()) return;
  const SceneMaterial before = scene_.materials[index];
  if (materials_[index]) {
    const Rung& rung = rungs()[static_cast<std::size_t>(governor_.rung())];
    Material settings = material.material;
    settings.region_stride *= rung.region_stride;
    const Material kept = simulation_->material_settings(*materials_[index]);
    try {
      simulation_->set_material(*materials_[index], settings);
      simulation_->prepare();
    } catch (const ConfigError&) {
      simulation_->set_material(*materials_[index], kept);
      if (wishes_.contains(index)) wishes_[index] = material;
      throw;
    }
  }
  wishes_.erase(index);
  scene_.materials[index].material = material.material;
  scene_.materials[index].color = material.color;
  scene_.materials[index].finish = material.finish;
  changed_ = true;
}

void Session::take_preset(std::size_t index, const SceneMaterial& material) try {
  set_material(index, material);
} catch (const ConfigError& error) {
  wishes_[index] = material;
  ++settings_number_;
  say("It waits until the scene is built anew, as it cannot change to this while it runs: " +
      std::string(error.what()));
}

void Session::set_render(const RenderConfig& render) {
  if (!simulation_) return;
  if (render.eye && render.target && *render.eye == *render.target)
    throw ConfigError("render.target", "is not allowed where render.eye is: the camera stands at eye");
  const RenderConfig before = std::exchange(scene_.render, render);
  camera_ = render::frame_camera(bounds_, scene_.render, program::visible_colliders(scene_));
  if (render.eye != before.eye || render.target != before.target) ++camera_number_;
  set_speed(speed_);
  changed_ = true;
}

void Session::set_surface(const SurfaceConfig& surface) {
  const SurfaceConfig before = scene_.surface;
  scene_.surface = surface;
  try {
    make_surface();
  } catch (const ConfigError&) {
    scene_.surface = before;
    make_surface();
    throw;
  }
}

void Session::set_run(const RunConfig& run) {
  if (!simulation_) return;
  scene_.run = run;
  const double frame_time_before = frame_time_;
  frame_time_ = frame_time(scene_, simulation_->info());
  if (frame_time_ != frame_time_before) frame_ = frames_until(simulation_->time());
  set_speed(speed_);
}

int Session::frames_until(double time) const {
  // A moment at the end of a frame is not before it by a rounding.
  return static_cast<int>(time / frame_time_ * (1 + 1e-12) + 1e-9);
}

}  // namespace mallow::view
