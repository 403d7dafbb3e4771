#include "textbook/textbook.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "mallow/errors.h"
#include "textbook/plastic.h"
#include "textbook/shape_matching.h"
#include "textbook/sph.h"

namespace mallow::textbook {
namespace {

/// As AlphaSchedule::at(), which rounds to single precision.
double alpha_at(const AlphaSchedule& schedule, double time) {
  const std::vector<ScheduleKey>& keys = schedule.keys();
  if (time <= keys.front().time) return keys.front().value;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const ScheduleKey &a = keys[k - 1], &b = keys[k];
    if (time >= b.time) continue;
    const double passed = (time - a.time) / (double{b.time} - a.time);
    return a.value + (double{b.value} - a.value) * passed;
  }
  return keys.back().value;
}

/// What the material leaves out follows from ρ0 = m Σ W over the lattice.
void derive_density(double support_radius, Group& group) {
  const double sum = lattice_sum(group.spacing, support_radius);
  const Material& material = group.material;
  group.mass = 1;
  if (material.rest_density) group.mass = *material.rest_density / sum;
  if (material.particle_mass) group.mass = *material.particle_mass;
  group.rest_density = material.rest_density ? *material.rest_density : group.mass * sum;
}

/// Mean of x² over the points of a lattice within a radius of one of them, itself included.
double region_moment(double radius, double spacing) {
  const int n = static_cast<int>(radius / spacing) + 1;
  double sum = 0;
  int count = 0;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z)
        if (spacing * std::sqrt(x * x + y * y + z * z) <= radius) {
          sum += spacing * spacing * x * x;
          ++count;
        }
  return sum / count;
}

}  // namespace

std::size_t Textbook::add_group(const Material& material) {
  groups_.push_back(
      {.material = material, .region_radius = material.region_radius.value_or(*config_.support_radius)});
  return groups_.size() - 1;
}

void Textbook::add_body(const Body& body, std::size_t group_index) {
  Group& group = groups_.at(group_index);
  group.spacing = body.spacing;
  derive_density(*config_.support_radius, group);
  for (std::size_t k = 0; k < body.positions.size(); ++k) {
    Vec velocity = body.velocity.cast<double>();
    if (!body.velocities.empty()) velocity += body.velocities[k].cast<double>();
    group.members.push_back(particles_.size());
    particles_.push_back(
        {.group = group_index, .position = body.positions[k].cast<double>(), .velocity = velocity});
  }
  if (group.keeps_reference()) take_reference(group, particles_);
}

void Textbook::pin(const Aabb& box, const Vec3& velocity) {
  const Vec min = box.min.cast<double>(), max = box.max.cast<double>();
  for (Particle& p : particles_) {
    if ((p.position.array() < min.array()).any() || (p.position.array() > max.array()).any()) continue;
    p.pinned = true;
    p.pin_velocity = velocity.cast<double>();
  }
}

void Textbook::paint(std::size_t id, double alpha, double stiffness) {
  particles_.at(id).own_alpha = alpha;
  particles_.at(id).stiffness = stiffness;
}

bool Textbook::is_painted() const {
  return std::ranges::any_of(particles_,
                             [](const Particle& p) { return p.own_alpha >= 0 || p.stiffness != 1; });
}

/// What the configs leave out follows from spacing and gravity, or from the fastest that moves.
void Textbook::settle_defaults() {
  double spacing = groups_.front().spacing, speed = 0;
  for (const Group& group : groups_) spacing = std::min(spacing, group.spacing);
  for (const Particle& p : particles_) {
    speed = std::max(speed, p.velocity.norm());
    if (p.pinned) speed = std::max(speed, p.pin_velocity.norm());
  }
  for (const Obstacle& o : obstacles_) speed = std::max(speed, o.collider.velocity.cast<double>().norm());
  const double gravity = config_.gravity.cast<double>().norm();
  base_step_ = gravity > 0 ? 0.15 * std::sqrt(0.3 * spacing / gravity) : 0.3 * spacing / speed;
  if (config_.time_step) base_step_ = *config_.time_step;
  longest_step_ = config_.time_step_factor * base_step_;
  period_ = 60 * base_step_;
  if (config_.update_interval) period_ = *config_.update_interval * base_step_;
  if (config_.update_period) period_ = *config_.update_period;
  for (Group& group : groups_) {
    group.update_threshold = gravity > 0 ? 40 * gravity : 0.27 * spacing / (base_step_ * base_step_);
    if (group.material.update_threshold) group.update_threshold = *group.material.update_threshold;
    const double kinematic = gravity > 0 ? 0.5 / std::sqrt(0.3) * spacing * std::sqrt(gravity * spacing)
                                         : 0.075 * spacing * spacing / base_step_;
    group.viscosity = kinematic * group.mass / std::pow(group.spacing, 3);
    if (group.material.viscosity) group.viscosity = *group.material.viscosity;
  }
}

/// α now, and k where it is left out: x σ²/(max(α, 0.2) Δt²), whose share α acts between groups; x is 1 where
/// elasticity leaves that.
void Textbook::follow_alpha() {
  const double step = std::max(base_step_, longest_step_), speed = *config_.support_radius / step;
  for (Group& group : groups_) {
    group.alpha = alpha_at(group.material.alpha, time_);
    group.most_alpha = group.most_elasticity = 0;
    for (const std::size_t id : group.members) {
      const double alpha = alpha_of(particles_[id], group);
      group.most_alpha = std::max(group.most_alpha, alpha);
      group.most_elasticity = std::max(group.most_elasticity, (1 - alpha) * particles_[id].stiffness);
    }
    group.cohesion = group.material.cohesion;
    if (group.material.pressure_coefficient) {
      group.pressure_coefficient = *group.material.pressure_coefficient;
    } else {
      group.contact_share = std::max(group.most_alpha, 0.2);
      const double asked = group.most_elasticity * stiffness(group) * step * step;
      const double share = std::min(1.0, (2.6 - std::min(asked, 2.5)) / 2) * std::max(1.0, asked / 2.5);
      group.pressure_coefficient = share * speed * speed / group.contact_share;
      group.cohesion *= std::min(1.0, 0.08 * speed * speed / group.pressure_coefficient);
    }
  }
}

Textbook::Step Textbook::step() {
  if (steps_ == 0) settle_defaults();
  follow_alpha();
  Step step{.updated_references = update_references()};
  for (Particle& p : particles_) {
    p.sph_acceleration = p.blended_acceleration = Vec::Zero();
    p.external_acceleration = config_.gravity.cast<double>();
  }
  if (needs_sph()) {
    find_neighbors(config_, particles_);
    sum_densities(config_, groups_, particles_);
    sum_accelerations(config_, groups_, particles_);
  }
  choose_time_step(step);
  for (const Group& group : groups_) {
    if (!group.keeps_reference()) continue;
    match_shape(group, double{group.material.damping_time}, particles_);
    if (group.material.plastic_yield && group.alpha < 1) flow(group, step.time_step, particles_);
  }
  step.volume_iterations = move_particles(step.time_step);
  for (Obstacle& obstacle : obstacles_) {
    obstacle.moved += step.time_step * obstacle.collider.velocity.cast<double>();
  }
  measure_external(step.time_step);
  last_start_ = time_;
  time_ += step.time_step;
  ++steps_;
  return step;
}

/// Some acceleration of SPH counts: within a group that is not purely elastic, or between groups; or volumes
/// are kept, for which densities are known.
bool Textbook::needs_sph() const {
  return groups_.size() > 1 || groups_.front().most_alpha > 0 || config_.volume_iterations > 0;
}

// Section 6 of the model [TK 3.2, eq. 14].
int Textbook::update_references() {
  const bool check = check_is_due();
  const double look = 2 * base_step_;  // for what tears, at checks too
  const bool tears = check || passed(time_, look) > passed(last_start_, look);
  int updated = 0;
  for (Group& group : groups_) {
    const Material& material = group.material;
    const bool flows = material.plastic_yield && group.alpha < 1 && group.keeps_reference();
    const bool far = flows && has_flowed_too_far(group, particles_);
    const bool due = far || (flows && ((check && reframe_is_due(group, particles_)) ||
                                       (tears && is_torn(group, check ? 0 : 0.1, particles_))));
    if (!check) {
      if (due) updated += reframe(group, !far, particles_);
      continue;
    }
    const double threshold = group.update_threshold * (1 - group.most_alpha);
    const double judged = std::exchange(group.judged_external, 0);
    group.external.clear();
    if (!group.keeps_reference()) continue;
    const bool melts = material.alpha.highest() > 0.9f && material.alpha.lowest() < material.alpha.highest();
    if ((!material.plastic_yield || material.update_threshold || melts) && judged > threshold) {
      kick_by_pull(group, 0.5);
      rest_anew(group, judged, particles_);
      kick_by_pull(group, -0.5);
    } else if (!due || !reframe(group, !far, particles_)) {
      continue;
    }
    ++updated;
  }
  return updated;
}

/// Velocities are those of half a step ago; what the old shape pulled since then goes into them.
void Textbook::kick_by_pull(const Group& group, double share) {
  match_shape(group, 0, particles_);
  for (const std::size_t id : group.members) {
    Particle& p = particles_[id];
    if (!p.pinned) p.velocity += share * (time_ - last_start_) * stiffness(group) * p.pull;
  }
}

/// Of the pull, 1/(Δt0 Δt_SM) [1/s²]; from Young's modulus Y/(ρ m2). [model 2, section 3]
double Textbook::stiffness(const Group& group) const {
  if (group.material.youngs_modulus) {
    const double density = group.mass / std::pow(group.spacing, 3);
    return *group.material.youngs_modulus / (density * region_moment(group.region_radius, group.spacing));
  }
  double elastic_time_step = base_step_;
  if (group.material.elastic_time_step) elastic_time_step = *group.material.elastic_time_step;
  return 1 / (base_step_ * elastic_time_step);
}

/// Multiples of the period, which times may miss by what their sums are off.
double Textbook::passed(double time, double period) const {
  return std::floor((time + 1e-6 * base_step_) / period);
}

bool Textbook::check_is_due() const {
  if (counts_steps()) return steps_ > 0 && steps_ % *config_.update_interval == 0;
  return passed(time_, period_) > passed(last_start_, period_);
}

/// What counts at the next check: the step before it, or the largest mean over a Δt0 since the last one.
void Textbook::measure_external(double time_step) {
  for (Group& group : groups_) {
    if (counts_steps()) {
      if ((steps_ + 1) % *config_.update_interval == 0)
        group.judged_external = mean_external_acceleration(group);
      continue;
    }
    group.external.push_back({time_step, mean_external_acceleration(group)});
    double sum = 0, left = base_step_;
    for (std::size_t k = group.external.size(); k-- > 0 && left > 0;) {
      const double shared = std::min(group.external[k].seconds, left);
      sum += shared * group.external[k].mean;
      left -= shared;
    }
    group.judged_external = std::max(group.judged_external, sum / base_step_);
  }
}

/// Of the step under way, over the particles that are not pinned.
double Textbook::mean_external_acceleration(const Group& group) const {
  double sum = 0;
  int count = 0;
  for (const std::size_t id : group.members) {
    const Particle& p = particles_[id];
    if (p.pinned) continue;
    sum += (p.external_acceleration + p.contact_acceleration).norm();
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// Of the two springs together, 2 x Δt² + a Δt (Δt + 2 τ) = 3.4, less what drags beside damping.
double Textbook::damped_limit(const Group& group, double pressure, double drag) const {
  const double a = group.most_elasticity * stiffness(group);
  const double tau = group.material.damping_time, rate = group.material.deformation_damping.value_or(0.0f);
  const auto root = [&](double most) {
    const double b = tau * a, c = 2 * pressure + a;
    return (std::sqrt(b * b + c * most) - b) / c;
  };
  const double step = std::min(longest_step_, root(3.4));
  const double taken = 1 - std::exp(-rate * step) + std::min(1.0, drag * step);
  return root(tau * a > 0 || rate > 0 ? 3.4 * (1 - taken / 2) : 3.4);
}

// Section 3 of the model [TK eq. 12].
double Textbook::limited_time_step(double max_velocity) const {
  const double sigma = *config_.support_radius;
  double time_step = std::min(longest_step_, 0.999 * sigma / max_velocity);
  if (!config_.acoustic_limit) return time_step;
  for (const Group& group : groups_) {
    time_step = std::min(time_step, sigma * sigma * group.rest_density / (25 * group.viscosity));
    // x of pressure as it acts: x <= 1.4, with shape matching 3.4, and x calmed by viscosity.
    const bool alone = groups_.size() == 1;
    const double push = alone ? group.most_alpha : group.contact_share, drag = alone ? group.most_alpha : 1;
    const double x = push * group.pressure_coefficient / (sigma * sigma);
    if (x == 0) continue;
    const double y = 800 * drag * group.viscosity / group.rest_density / (sigma * sigma);
    time_step = std::min({time_step, (y + std::sqrt(y * y + 0.2 * x)) / (2 * x), std::sqrt(1.4 / x),
                          damped_limit(group, x, 25 * y / 800)});
  }
  return time_step;
}

void Textbook::choose_time_step(Step& step) const {
  step.time_step = longest_step_;
  if (!needs_sph()) return;
  std::size_t fastest = 0;
  for (std::size_t id = 0; id < particles_.size(); ++id) {
    const Particle& p = particles_[id];
    if (p.pinned) continue;
    const Group& group = groups_[p.group];
    // All of it, unless k follows alpha, or particles differ in alpha; nothing where it acts on nobody.
    const bool acts = groups_.size() > 1 || group.most_alpha > 0;
    const bool whole = acts && group.material.pressure_coefficient && !is_painted();
    const Vec& sph = whole ? p.sph_acceleration : p.blended_acceleration;
    const double velocity = (p.velocity + longest_step_ * (sph + p.external_acceleration)).norm();
    // Not `>`: a velocity that is not a number must win, so that it is seen.
    if (velocity <= step.max_velocity || std::isnan(step.max_velocity)) continue;
    step.max_velocity = velocity;
    fastest = id;
  }
  step.time_step = limited_time_step(step.max_velocity);
  if (std::isfinite(step.max_velocity) && step.time_step >= 1e-3 * longest_step_) return;
  throw StepError("particle " + std::to_string(fastest) + " would move at " +
                      std::to_string(step.max_velocity) + " m/s, for which no step above a thousandth of " +
                      "solver.time_step is short enough",
                  static_cast<std::uint32_t>(fastest), Phase::time_step);
}

/// What colliders make of its velocity, which came with `before`.
Vec Textbook::contacted(const Particle& p, const Vec& before, double time_step) const {
  const double spacing = groups_[p.group].spacing;
  const ContactStep contact{
      .time_step = time_step,
      .contact_offset = config_.contact_offset ? double{*config_.contact_offset} : spacing / 2,
      .max_push = *config_.support_radius / (10 * base_step_),
      .gravity = config_.gravity.cast<double>()};
  Vec velocity = p.velocity;
  if (p.pinned) return velocity;
  for (const Obstacle& obstacle : obstacles_)
    velocity = resolve_contact(obstacle, contact, p.position, before, velocity);
  return velocity;
}

/// Velocities go towards the motion of the group as a rigid whole. [model 2, section 4 B]
void Textbook::damp(const Group& group, double time_step) {
  const auto is_elastic = [&](std::size_t id) { return alpha_of(particles_[id], group) < 1; };
  if (group.material.deformation_damping == 0.0f || std::ranges::none_of(group.members, is_elastic)) return;
  const auto n = static_cast<double>(group.members.size());
  Vec center = Vec::Zero(), velocity = Vec::Zero(), spin = Vec::Zero();
  for (const std::size_t id : group.members) {
    center += particles_[id].position / n;
    velocity += particles_[id].velocity / n;
  }
  Matrix inertia = Matrix::Zero();
  for (const std::size_t id : group.members) {
    const Vec arm = particles_[id].position - center;
    spin += arm.cross(particles_[id].velocity - velocity);
    inertia += arm.squaredNorm() * Matrix::Identity() - arm * arm.transpose();
  }
  const Vec turning = inertia.ldlt().solve(spin);
  const auto rigid = [&](const Particle& p) { return Vec(velocity + turning.cross(p.position - center)); };
  double squares = 0;
  for (const std::size_t id : group.members)
    squares += (particles_[id].velocity - rigid(particles_[id])).squaredNorm() / n;
  // Left out: what hardly moves comes to rest.
  const double calm = 0.02 * group.spacing / base_step_;
  const double rate = group.material.deformation_damping ? double{*group.material.deformation_damping}
                                                         : 0.3 / (base_step_ * (1 + squares / (calm * calm)));
  std::vector<Vec> changes;
  for (const std::size_t id : group.members)
    changes.emplace_back((1 - std::exp(-rate * time_step)) *
                         (rigid(particles_[id]) - particles_[id].velocity));
  for (std::size_t k = 0; k < changes.size(); ++k) particles_[group.members[k]].velocity += changes[k];
}

// Section 2 of the second chapter.
int Textbook::keep_volume(double time_step, const std::vector<Vec>& before) {
  std::vector<double> share;
  for (const Group& group : groups_) {
    const double tau = group.material.damping_time, rate = group.material.deformation_damping.value_or(0.0f);
    const double pull = group.most_elasticity * stiffness(group) * time_step * (time_step + 2 * tau);
    const double carried = 2.8 * (1 + std::exp(-rate * time_step)) / 2;
    const double wide = std::min(1.0, 2.5 * group.spacing / double{*config_.support_radius});
    share.push_back(wide * wide * wide * std::clamp((carried - pull) / 2, 0.0, 1.0));
  }
  std::vector<Vec> w(particles_.size());
  for (int iteration = 0; iteration < config_.volume_iterations; ++iteration) {
    for (std::size_t id = 0; id < w.size(); ++id) w[id] = contacted(particles_[id], before[id], time_step);
    const Compression found = find_compression(config_, groups_, time_step, share, w, particles_);
    if (found.mean <= double{config_.volume_tolerance}) return iteration;
    correct_volume(config_, groups_, found.multipliers, particles_);
  }
  return config_.volume_iterations.value_or(0);
}

// Sections 4 and 5 of the model [TK eq. 10, 11, 13].
int Textbook::move_particles(double time_step) {
  // From the middle of the last step to the middle of this one.
  const double last_step = time_ - last_start_;
  const double pull_time = steps_ > 0 ? (last_step + time_step) / 2 : time_step;
  std::vector<Vec> before = velocities();
  for (const Group& group : groups_) damp(group, time_step);
  for (Particle& p : particles_) {
    const Group& group = groups_[p.group];
    if (p.pinned) {
      p.velocity = p.pin_velocity;
      continue;
    }
    p.velocity += time_step * (p.external_acceleration + p.blended_acceleration);
    if (group.keeps_reference()) p.velocity += pull_time * stiffness(group) * p.pull;
  }
  const int iterations = keep_volume(time_step, before);
  for (std::size_t id = 0; id < particles_.size(); ++id) {
    Particle& p = particles_[id];
    const Vec velocity = contacted(p, before[id], time_step);
    p.contact_acceleration = (velocity - p.velocity) / time_step;
    p.velocity = velocity;
    p.position += time_step * velocity;
  }
  return iterations;
}

std::vector<Vec> Textbook::positions() const {
  std::vector<Vec> positions;
  for (const Particle& p : particles_) positions.push_back(p.position);
  return positions;
}

std::vector<Vec> Textbook::velocities() const {
  std::vector<Vec> velocities;
  for (const Particle& p : particles_) velocities.push_back(p.velocity);
  return velocities;
}

std::vector<double> Textbook::densities() const {
  std::vector<double> densities;
  for (const Particle& p : particles_) densities.push_back(p.density);
  return densities;
}

double Textbook::average_neighbors(std::size_t group) const {
  const std::vector<std::size_t>& members = groups_.at(group).members;
  double sum = 0;
  for (const std::size_t id : members) sum += static_cast<double>(particles_[id].region.particles.size());
  return sum / static_cast<double>(members.size());
}

}  // namespace mallow::textbook
