// What an application tells a simulation while it runs.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "colliders/collider_checks.h"
#include "config/validation.h"
#include "core/bounds.h"
#include "core/precision.h"
#include "shape_matching/reshape.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"

namespace mallow {
namespace {

void check_finite(const char* field, const Vec3& value) {
  Checks checks;
  checks.vector(field, value);
  checks.finish();
}

/// Throws ConfigError.
void refuse_faster(const Simulation::State& s, const char* field, double speed) {
  Checks checks;
  check_speed(s, field, speed, checks);
  checks.finish();
}

bool is_pinned(const Simulation::State& s, std::size_t row) {
  return !s.store.pin.empty() && s.store.pin[row] != 0;
}

/// Of a body [m], relative to the origin.
Eigen::Vector3d middle_of(const Simulation::State& s, const BodyState& body) {
  Eigen::Vector3d sum(0, 0, 0);
  for (std::size_t row = body.begin; row < body.end; ++row) sum += s.store.position.get(row).cast<double>();
  return sum / static_cast<double>(body.size());
}

/// Calls change(body) with all bodies of a material.
template <class Change>
void for_bodies_of(Simulation::State& s, const MaterialState& material, const Change& change) {
  for (BodyState& body : s.bodies)
    if (body.material == &material) change(body);
}

/// Alpha of its material has changed.
void follow_alpha(Simulation::State& s, BodyState& body) {
  wake_island(s, body);
  ShapeMatching& shape = body.shape;
  if (!body.keeps_reference()) {
    // Rows of fluids are sorted, which a reference shape that is kept would not follow.
    ShapeMatching none;
    none.region_radius = shape.region_radius;
    none.region_stride = shape.region_stride;
    none.flows = shape.flows;
    shape = std::move(none);
  } else if (shape.reference.size() != body.size()) {
    // A fluid that may turn elastic remembers the shape it has now.
    body.grew = true;
    s.prepared = false;
  }
}

/// The regions of its material have changed: they start from the rotations that particles have.
void follow_regions(Simulation::State& s, BodyState& body) {
  const Material& settings = body.material->settings;
  ShapeMatching& shape = body.shape;
  const float radius = region_radius(s.config, settings, body.spacing);
  const bool flows = mallow::flows(settings);
  if (shape.region_radius == radius && shape.region_stride == settings.region_stride && shape.flows == flows)
    return;
  CarriedRegions carried;
  if (shape.built) carried = carry_regions(shape);
  shape.region_radius = radius;
  shape.region_stride = settings.region_stride;
  shape.flows = flows;
  if (!shape.built) return;
  forget_lists(carried);
  build_carried(carried, s.execution, s.region_scratch, shape);
}

}  // namespace

void Simulation::set_force(ForceCallback callback) {
  state_->refuse_in_callback();
  state_->force = std::move(callback);
  if (!state_->force) state_->user_acceleration.release();
}

void Simulation::set_gravity(const Vec3& gravity) {
  state_->refuse_in_callback();
  check_finite("solver.gravity", gravity);
  state_->config.gravity = gravity;
  wake_all(*state_);
}

void Simulation::set_solver(const SolverConfig& config) {
  state_->refuse_in_callback();
  change_solver(*state_, config);
}

void Simulation::set_material(MaterialId id, const Material& settings) {
  state_->refuse_in_callback();
  State& s = *state_;
  MaterialState& material = s.material(id);
  Checks checks;
  check(settings, checks);
  checks.finish();
  check_stiffness(s.config, settings, {}, checks);
  for_bodies_of(s, material, [&](const BodyState& body) { check_modulus(s.config, settings, body, checks); });
  checks.finish();
  material.settings = settings;
  for_bodies_of(s, material, [&](BodyState& body) {
    derive_density(s.config, body);
    follow_regions(s, body);
    follow_alpha(s, body);
  });
  s.prepared = false;
}

const Material& Simulation::material_settings(MaterialId id) const {
  return state_->material(id).settings;
}

void Simulation::set_alpha(MaterialId id, const AlphaSchedule& alpha) {
  state_->refuse_in_callback();
  State& s = *state_;
  MaterialState& material = s.material(id);
  Checks checks;
  check(alpha, checks);
  checks.finish();
  Material changed = material.settings;
  changed.alpha = alpha;
  check_stiffness(s.config, changed, {}, checks);
  for_bodies_of(s, material, [&](const BodyState& body) { check_modulus(s.config, changed, body, checks); });
  checks.finish();
  material.settings.alpha = alpha;
  for_bodies_of(s, material, [&](BodyState& body) {
    follow_alpha(s, body);
    if (body.merges) s.prepared = false;  // whether it touches what it merges with follows from it
  });
}

void Simulation::set_velocity(BodyId id, const Vec3& velocity, const Vec3& angular_velocity) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = s.body(id);
  check_finite("body.velocity", velocity);
  check_finite("body.angular_velocity", angular_velocity);
  const Eigen::Vector3d middle = middle_of(s, body), spin = angular_velocity.cast<double>();
  const auto velocity_of = [&](std::size_t row) {
    const Eigen::Vector3d from = s.store.position.get(row).cast<double>() - middle;
    return Vec3(velocity + spin.cross(from).cast<float>());
  };
  double fastest = 0;
  for (std::size_t row = body.begin; row < body.end; ++row)
    fastest = std::max(fastest, velocity_of(row).cast<double>().norm());
  refuse_faster(s, "body.velocity", fastest);
  wake_island(s, body);
  for (std::size_t row = body.begin; row < body.end; ++row)
    if (!is_pinned(s, row)) s.store.velocity.set(row, velocity_of(row));
  measure_rigid(s, body);
  s.held = false;
}

void Simulation::set_velocity(std::span<const ParticleId> ids, const Vec3& velocity) {
  state_->refuse_in_callback();
  State& s = *state_;
  check_finite("velocity", velocity);
  refuse_faster(s, "velocity", velocity.cast<double>().norm());
  for (const ParticleId id : ids) row(id);
  std::vector<BodyState*> bodies;
  for (const ParticleId id : ids) {
    const std::size_t at = row(id);
    if (!is_pinned(s, at)) s.store.velocity.set(at, velocity);
    BodyState& body = s.body_of(at);
    wake_island(s, body);
    if (bodies.empty() || bodies.back() != &body) bodies.push_back(&body);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  for (BodyState* body : bodies) measure_rigid(s, *body);
  s.held = false;
}

void Simulation::set_position(BodyId id, const Vec3& center) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = s.body(id);
  check_finite("body.center", center);
  const Eigen::Vector3d by = center.cast<double>() - s.origin.cast<double>() - middle_of(s, body);
  const Aabb box = box_around(s.store.position, body.begin, body.end);
  for (const Vec3& corner : {box.min, box.max})
    if (const auto why = why_too_far((corner.cast<double>() + by).cast<float>(), body.spacing))
      throw ConfigError("body.center", *why);
  wake_island(s, body);
  for (std::size_t row = body.begin; row < body.end; ++row)
    s.store.position.set(row, (s.store.position.get(row).cast<double>() + by).cast<float>());
  measure_rigid(s, body);
  s.held = false;
  s.rows_moved();
}

void Simulation::add_impulse(BodyId id, const Vec3& impulse) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = s.body(id);
  check_finite("impulse", impulse);
  std::size_t free = 0;
  for (std::size_t row = body.begin; row < body.end; ++row) free += !is_pinned(s, row);
  const Vec3 kick = impulse / (body.mass * static_cast<float>(std::max(free, std::size_t{1})));
  double fastest = 0;
  for (std::size_t row = body.begin; row < body.end; ++row)
    if (!is_pinned(s, row))
      fastest = std::max(fastest, (s.store.velocity.get(row).cast<double>() + kick.cast<double>()).norm());
  refuse_faster(s, "impulse", fastest);
  wake_island(s, body);
  for (std::size_t row = body.begin; row < body.end; ++row)
    if (!is_pinned(s, row)) s.store.velocity.set(row, s.store.velocity.get(row) + kick);
  measure_rigid(s, body);
  s.held = false;
}

std::size_t Simulation::add_impulse(const Vec3& center, float radius, const Vec3& impulse) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  checks.vector("center", center);
  checks.vector("impulse", impulse);
  checks.number("radius", static_cast<double>(radius), radius > 0, "a finite number above 0");
  checks.finish();
  const Eigen::Vector3d middle = center.cast<double>() - s.origin.cast<double>();
  const auto weight = [&](std::size_t row) {
    const double ratio =
        (s.store.position.get(row).cast<double>() - middle).norm() / static_cast<double>(radius);
    return ratio < 1 && !is_pinned(s, row) ? (1 - ratio * ratio) * (1 - ratio * ratio) : 0.0;
  };
  double sum = 0;
  for (const BodyState& body : s.bodies)
    for (std::size_t row = body.begin; row < body.end && body.enabled; ++row)
      sum += static_cast<double>(body.mass) * weight(row);
  const auto faster = [&](std::size_t row) {
    return Eigen::Vector3d(s.store.velocity.get(row).cast<double>() +
                           weight(row) / sum * impulse.cast<double>());
  };
  double fastest = 0;
  for (const BodyState& body : s.bodies)
    for (std::size_t row = body.begin; row < body.end && body.enabled; ++row)
      if (weight(row) > 0) fastest = std::max(fastest, faster(row).norm());
  refuse_faster(s, "impulse", fastest);
  std::size_t count = 0;
  for (BodyState& body : s.bodies) {
    if (!body.enabled) continue;
    const std::size_t before = count;
    for (std::size_t row = body.begin; row < body.end; ++row) {
      const double share = weight(row);
      if (!(share > 0)) continue;
      ++count;
      s.store.velocity.set(row, s.store.velocity.get(row) + static_cast<float>(share / sum) * impulse);
    }
    if (count == before) continue;
    wake_island(s, body);
    measure_rigid(s, body);
    s.held = false;
  }
  return count;
}

void Simulation::enable(BodyId id, bool enabled) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = s.body(id);
  if (body.enabled == enabled) return;
  wake_island(s, body);
  body.enabled = enabled;
  s.held = false;
  s.sph.kept.forget();
}
bool Simulation::is_enabled(BodyId id) const {
  return state_->body(id).enabled;
}

void Simulation::set_user_data(BodyId id, std::uint64_t data) {
  state_->refuse_in_callback();
  state_->body(id).user_data = data;
}
std::uint64_t Simulation::user_data(BodyId id) const {
  return std::as_const(*state_).body(id).user_data;
}

void Simulation::wake(BodyId id) {
  state_->refuse_in_callback();
  wake_island(*state_, state_->body(id));
}
bool Simulation::is_awake(BodyId id) const {
  return state_->body(id).moves();
}

void Simulation::set_velocity(ColliderId id, const Vec3& velocity) {
  set_twist(id, velocity, collider(id).angular_velocity);
}

void Simulation::set_twist(ColliderId id, const Vec3& velocity, const Vec3& angular_velocity) {
  state_->refuse_in_callback();
  State& s = *state_;
  Collider& changed = s.colliders[s.index(id)];
  Checks checks;
  checks.vector("collider.velocity", velocity);
  checks.vector("collider.angular_velocity", angular_velocity);
  checks.finish();
  changed.velocity = velocity;
  changed.angular_velocity = angular_velocity;
  changed.keyframes.clear();
}

void Simulation::set_pose(ColliderId id, const Pose& pose, double seconds) {
  state_->refuse_in_callback();
  State& s = *state_;
  Collider& changed = s.colliders[s.index(id)];
  Checks checks;
  check_pose("collider.pose", pose, checks);
  checks.number("seconds", seconds, seconds >= 0, "a finite number, 0 or above");
  checks.finish();
  if (seconds == 0) wake_near(s, changed);
  changed.velocity.setZero();
  changed.angular_velocity.setZero();
  changed.keyframes.clear();
  if (seconds > 0)
    changed.keyframes = {{s.time, changed.pose}, {s.time + seconds, pose}};
  else
    changed.pose = pose;
  if (seconds == 0) wake_near(s, changed);
}

void Simulation::set_velocity(PinId id, const Vec3& velocity) {
  state_->refuse_in_callback();
  PinState& pin = state_->pin(id);
  check_finite("pin.velocity", velocity);
  refuse_faster(*state_, "pin.velocity", velocity.cast<double>().norm());
  pin = {.id = id, .velocity = velocity};
  wake_pinned(*state_, id);
}

void Simulation::move_pin(PinId id, const Vec3& way, double seconds) {
  state_->refuse_in_callback();
  PinState& pin = state_->pin(id);
  Checks checks;
  checks.vector("pin.way", way);
  checks.number("pin.seconds", seconds, seconds > 0, "a finite number above 0");
  checks.finish();
  const double shortest = std::max(seconds, static_cast<double>(state_->config.time_step.value_or(0)));
  refuse_faster(*state_, "pin.way", way.cast<double>().norm() / shortest);
  pin = {.id = id, .velocity = {0, 0, 0}, .left = way, .seconds = seconds};
  wake_pinned(*state_, id);
}

}  // namespace mallow
