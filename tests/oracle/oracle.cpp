#include "oracle/oracle.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "oracle/kernels.h"
#include "oracle/signed_distance.h"

namespace mallow::oracle {
namespace {

constexpr double k_pi = std::numbers::pi;

}  // namespace

double poly6(double r, double sigma) {
  if (r > sigma) return 0;
  return 315 / (64 * k_pi * std::pow(sigma, 9)) * std::pow(sigma * sigma - r * r, 3);
}

double wendland(double r, double sigma) {
  if (r > sigma) return 0;
  const double q = r / sigma;
  return 21 / (2 * k_pi * std::pow(sigma, 3)) * std::pow(1 - q, 4) * (1 + 4 * q);
}

namespace {

Vec poly6_gradient(const Vec& d, double sigma) {
  const double r = d.norm();
  if (r > sigma) return Vec::Zero();
  return -6 * 315 / (64 * k_pi * std::pow(sigma, 9)) * std::pow(sigma * sigma - r * r, 2) * d;
}

double poly6_laplacian(double r, double sigma) {
  if (r > sigma) return 0;
  const double s = sigma * sigma - r * r;
  return -6 * 315 / (64 * k_pi * std::pow(sigma, 9)) * s * (3 * s - 4 * r * r);
}

// Müller, Charypar, Gross 2003. Coincident points have no direction.
Vec spiky_gradient(const Vec& d, double sigma) {
  const double r = d.norm();
  if (r > sigma || r == 0) return Vec::Zero();
  return -45 / (k_pi * std::pow(sigma, 6)) * std::pow(sigma - r, 2) * (d / r);
}

double viscosity_laplacian(double r, double sigma) {
  if (r > sigma) return 0;
  return 45 / (k_pi * std::pow(sigma, 6)) * (sigma - r);
}

bool is_always_fluid(const Group& group) {
  const auto& keys = group.material.alpha.keys();
  return std::all_of(keys.begin(), keys.end(), [](const ScheduleKey& key) { return key.value == 1; });
}

bool yields(const Material& material) {
  return material.plastic_yield || material.plastic_yield_by_temperature;
}
bool flows(const Group& group) {
  return yields(group.material) && group.least_alpha < 1;
}

// What changes its alpha and is once held by nothing.
bool melts(const Group& group) {
  const Schedule alpha = group.material.alpha_by_temperature.value_or(group.material.alpha);
  const auto& keys = alpha.keys();
  const auto less = [](const auto& a, const auto& b) { return a.value < b.value; };
  const auto [least, most] = std::minmax_element(keys.begin(), keys.end(), less);
  return most->value > 0.9f && least->value < most->value;
}

}  // namespace

void set_mass_and_rest_density(Group& group, double sigma) {
  const double sum = lattice_sum(group.spacing, sigma);
  const Material& material = group.material;
  group.mass = material.particle_mass  ? *material.particle_mass
               : material.rest_density ? *material.rest_density / sum
                                       : 1.0;
  group.rest_density = material.rest_density ? *material.rest_density : group.mass * sum;
  group.wendland_volume = group.mass / group.rest_density * sum / lattice_sum(group.spacing, sigma, wendland);
}

double alpha_at(const AlphaSchedule& schedule, double time) {
  const auto& keys = schedule.keys();
  if (time <= keys.front().time) return keys.front().value;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const double t0 = keys[k - 1].time, a0 = keys[k - 1].value;
    const double t1 = keys[k].time, a1 = keys[k].value;
    if (time < t1) return a0 + (a1 - a0) * (time - t0) / (t1 - t0);
  }
  return keys.back().value;
}

double lattice_sum(double spacing, double support_radius, double (*kernel)(double, double)) {
  const int n = static_cast<int>(support_radius / spacing) + 1;
  double sum = 0;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) sum += kernel(spacing * Vec(x, y, z).norm(), support_radius);
  return sum;
}

Matrix polar_rotation(const Matrix& a, const Matrix& last, double scale) {
  Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Two directions and det +1 fix a rotation. With fewer, a trace of the last rotation decides what A leaves
  // open, as the rotation sought is the one that maximises tr(Rᵀ A).
  const double silence = 1e-12 * scale;
  if (svd.singularValues()[1] <= silence) svd.compute(a + silence * last);
  Matrix sign = Matrix::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

std::size_t Oracle::add_group(const Material& material) {
  groups_.push_back({.material = material});
  return groups_.size() - 1;
}

void Oracle::add_body(const std::vector<Vec>& positions, const std::vector<Vec>& velocities, double spacing,
                      std::size_t group) {
  groups_[group].spacing = spacing;
  set_mass_and_rest_density(groups_[group], *config_.support_radius);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    particles_.push_back({.group = group, .id = born_++, .x = positions[i], .v = velocities[i]});
    particles_.back().temperature = groups_[group].material.temperature.value_or(0.0f);
  }
  rebuild_regions(group);
}

void Oracle::pin(const Aabb& box, const Vec& velocity) {
  const Vec min = box.min.cast<double>();
  const Vec max = box.max.cast<double>();
  for (Particle& p : particles_) {
    if ((p.x.array() < min.array()).any() || (p.x.array() > max.array()).any()) continue;
    p.pinned = true;
    p.pin_velocity = velocity;
  }
}

void Oracle::set_positions(const std::vector<Vec>& positions) {
  for (std::size_t i = 0; i < particles_.size(); ++i) particles_[i].x = positions[i];
}

std::vector<Vec> Oracle::positions() const {
  std::vector<Vec> positions;
  for (const Particle& p : particles_) positions.push_back(p.x);
  return positions;
}

std::vector<Vec> Oracle::velocities() const {
  std::vector<Vec> velocities;
  for (const Particle& p : particles_) velocities.push_back(p.v);
  return velocities;
}

// What is left out: model 2, sections 0 and 1.
void Oracle::settle() {
  double h = INFINITY, fastest = 0;
  for (const Group& group : groups_) h = std::min(h, group.spacing);
  for (const Particle& p : particles_) {
    fastest = std::max({fastest, p.v.norm(), p.pinned ? p.pin_velocity.norm() : 0.0});
  }
  for (const Obstacle& o : obstacles_) fastest = std::max(fastest, double{o.collider.velocity.norm()});
  const double g = config_.gravity.cast<double>().norm();
  dt0_ = config_.time_step ? double{*config_.time_step}
         : g > 0           ? 0.15 * std::sqrt(0.3 * h / g)
                           : 0.3 * h / fastest;
  longest_ = config_.time_step_factor * dt0_;
  period_ = config_.update_period     ? double{*config_.update_period}
            : config_.update_interval ? *config_.update_interval * dt0_
                                      : 60 * dt0_;
  for (Group& group : groups_) {
    const std::optional<float>& given = group.material.update_threshold;
    group.update_threshold = given ? double{*given} : g > 0 ? 40 * g : 0.27 * h / (dt0_ * dt0_);
    const double nu = g > 0 ? 0.5 / std::sqrt(0.3) * h * std::sqrt(g * h) : 0.075 * h * h / dt0_;
    group.viscosity = group.material.viscosity ? double{*group.material.viscosity}
                                               : nu * group.mass / std::pow(group.spacing, 3);
  }
}

void Oracle::follow_alpha() {
  follow_temperatures();
  for (Group& group : groups_) {
    group.alpha = alpha_at(group.material.alpha, time_);
    group.most_alpha = group.most_elasticity = 0;
    group.least_alpha = 1;
    const bool thins = group.material.temperature && group.material.viscosity_by_temperature;
    if (thins) group.viscosity = 0;
    for (const Particle& p : particles_) {
      if (&groups_[p.group] != &group) continue;
      group.most_alpha = std::max(group.most_alpha, alpha_of(p));
      group.least_alpha = std::min(group.least_alpha, alpha_of(p));
      group.most_elasticity = std::max(group.most_elasticity, (1 - alpha_of(p)) * p.stiffness);
      if (thins) group.viscosity = std::max(group.viscosity, viscosity_of(p));
    }
    const std::optional<float>& given = group.material.pressure_coefficient;
    group.contact_share = given ? 1 : std::max(group.most_alpha, 0.2);
    const double dt = std::max(dt0_, longest_), speed = *config_.support_radius / dt;
    // Where a step of that length does not carry the springs, k is that of one that does.
    const double asked = group.most_elasticity * stiffness(group) * dt * dt, pull = std::min(asked, 2.5);
    const double x = std::min(1.0, (2.6 - pull) / 2) * (asked > 2.5 ? asked / 2.5 : 1);
    group.pressure_coefficient = given ? double{*given} : x * speed * speed / group.contact_share;
    const double soft = given ? 1 : std::min(1.0, 0.08 * speed * speed / group.pressure_coefficient);
    group.cohesion = soft * group.material.cohesion;
  }
}

Step Oracle::step() {
  if (steps_ == 0) settle();
  split_torn();
  flow_out();
  drain();
  follow_alpha();
  Step step;
  step.updated_groups = update_references();
  sum_densities();
  sum_accelerations();
  step.max_velocity = has_limits() ? max_velocity() : 0;
  step.time_step = time_step(step.max_velocity);
  match_shapes(true);
  conduct(step.time_step);
  drive(step.time_step);
  step.volume_iterations = move(step.time_step);
  flow(step.time_step);
  for (Obstacle& obstacle : obstacles_) {
    obstacle.moved += step.time_step * obstacle.collider.velocity.cast<double>();
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].external.push_back({time_, time_ + step.time_step, mean_external_acceleration(g)});
  }
  last_start_ = time_;
  time_ += step.time_step;
  ++steps_;
  return step;
}

// Section 6: x̄ ← x, and N from it.
void Oracle::rebuild_regions(std::size_t group) {
  for (Particle& i : particles_) {
    if (i.group != group) continue;
    i.reference = i.x;
    i.rotation = Matrix::Identity();
    i.stretch = Matrix::Identity();
    i.flow = 0;
  }
  list_regions(group);
}

void Oracle::list_regions(std::size_t group) {
  const double radius = groups_[group].material.region_radius.value_or(*config_.support_radius);
  for (Particle& i : particles_) {
    if (i.group != group) continue;
    i.region.clear();
    for (std::size_t j = 0; j < particles_.size(); ++j) {
      if (particles_[j].group == group && (particles_[j].reference - i.reference).norm() <= radius)
        i.region.push_back(j);
    }
  }
}

// Section 7 of the second chapter: those whose own threshold is exceeded rest beside the nearest that holds,
// or that rests beside such a one.
void Oracle::rest_anew(std::size_t group, double mean) {
  const double radius = groups_[group].material.region_radius.value_or(*config_.support_radius);
  std::vector<Particle*> placed, left;
  for (Particle& p : particles_)
    if (p.group == group)
      (mean > groups_[group].update_threshold * (1 - alpha_of(p)) ? left : placed).push_back(&p);
  if (placed.empty()) return rebuild_regions(group);
  while (!left.empty()) {
    std::vector<std::pair<Particle*, Particle*>> found;
    for (Particle* p : left) {
      const auto nearer = [&](const Particle* a, const Particle* b) {
        return (a->x - p->x).norm() < (b->x - p->x).norm();
      };
      Particle* const beside = *std::min_element(placed.begin(), placed.end(), nearer);
      if ((beside->x - p->x).norm() <= radius) found.emplace_back(p, beside);
    }
    if (found.empty()) throw std::runtime_error("some particle is near none that holds");
    for (const auto& [p, beside] : found) {
      const Matrix deformed = beside->rotation * beside->stretch;
      p->reference = beside->reference + deformed.inverse() * (p->x - beside->x);
      p->rotation = beside->rotation;
      p->stretch = beside->stretch;
      p->flow = 0;
      placed.push_back(p);
      std::erase(left, p);
    }
  }
  list_regions(group);
}

// Velocities are those of half a step ago: what the old shape pulled since then is part of them.
void Oracle::kick_by_pull(std::size_t group, double share) {
  match_shapes(false);
  for (Particle& p : particles_)
    if (p.group == group && !p.pinned)
      p.v += share * (time_ - last_start_) * stiffness(groups_[group]) * p.pull;
}

double Oracle::mean_external_acceleration(std::size_t group) const {
  double sum = 0;
  int count = 0;
  for (const Particle& p : particles_) {
    if (p.group != group || p.pinned) continue;
    sum += (p.external + p.contact).norm();
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

namespace {

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

// Of the pull [TK eq. 13; the second chapter, section 3].
double Oracle::stiffness(const Group& group) const {
  if (group.material.youngs_modulus) {
    const double radius = group.material.region_radius.value_or(*config_.support_radius);
    const double density = group.mass / std::pow(group.spacing, 3);
    return *group.material.youngs_modulus / (density * region_moment(radius, group.spacing));
  }
  const std::optional<float>& given = group.material.elastic_time_step;
  return 1 / (dt0_ * (given ? double{*given} : dt0_));
}

double Oracle::alpha_of(const Particle& p) const {
  return p.own_alpha < 0 ? groups_[p.group].alpha : p.own_alpha;
}

double Oracle::yield_of(const Particle& p) const {
  return p.own_yield < 0 ? groups_[p.group].material.plastic_yield.value_or(0.0f) : p.own_yield;
}

bool Oracle::is_painted() const {
  return std::any_of(particles_.begin(), particles_.end(),
                     [](const Particle& p) { return p.own_alpha >= 0 || p.stiffness != 1; });
}

double Oracle::passed(double time, double period) const {
  return std::floor((time + 1e-6 * dt0_) / period);
}

// The step before, where checks are counted in steps; else the largest mean over a Δt0 since the last check.
double Oracle::judged_acceleration(std::size_t group) const {
  if (counts_steps()) return groups_[group].external.back().mean;
  double largest = 0;
  for (const Group::External& last : groups_[group].external) {
    double sum = 0;
    for (const Group::External& e : groups_[group].external)
      if (e.start >= last_check_)
        sum += std::max(0.0, std::min(e.end, last.end) - std::max(e.start, last.end - dt0_)) * e.mean;
    largest = std::max(largest, sum / dt0_);
  }
  return largest;
}

bool Oracle::check_is_due() const {
  return counts_steps() ? steps_ > 0 && steps_ % *config_.update_interval == 0
                        : passed(time_, period_) > passed(last_start_, period_);
}

// What tears is looked for every 2 Δt0, and at checks.
bool Oracle::tears_are_looked_for() const {
  return check_is_due() || passed(time_, 2 * dt0_) > passed(last_start_, 2 * dt0_);
}

std::vector<std::size_t> Oracle::update_references() {
  std::vector<std::size_t> updated;
  const bool check = check_is_due();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const bool far = has_flowed_too_far(g);
    const bool due = far || (check && reframe_is_due(g)) || (tears_are_looked_for() && is_torn(g));
    if (!check) {
      if (due && reframe(g, !far)) updated.push_back(g);
      continue;
    }
    const double threshold = groups_[g].update_threshold * (1 - groups_[g].most_alpha);
    const Material& material = groups_[g].material;
    const bool follows = !yields(material) || material.update_threshold || melts(groups_[g]);
    if (is_always_fluid(groups_[g]) || !follows || judged_acceleration(g) <= threshold) {
      if (due && reframe(g, !far)) updated.push_back(g);
      continue;
    }
    kick_by_pull(g, 0.5);
    rest_anew(g, judged_acceleration(g));
    kick_by_pull(g, -0.5);
    updated.push_back(g);
  }
  if (check) last_check_ = time_;
  for (const std::size_t g : updated) groups_[g].may_be_torn = true;
  return updated;
}

/// S of poly6 and of Wendland's kernel, and B of the spiky one, of a half space at distance d.
double wendland_half_space_share(double d, double sigma) {
  const double t = 1 - d / sigma;
  return 3.5 * std::pow(t, 6) - 4.5 * std::pow(t, 7) + 1.5 * std::pow(t, 8);
}
double half_space_share(double d, double sigma) {
  const double q = d / sigma;
  return 0.5 - 315.0 / 256 *
                   (q - 4 * std::pow(q, 3) / 3 + 6 * std::pow(q, 5) / 5 - 4 * std::pow(q, 7) / 7 +
                    std::pow(q, 9) / 9);
}
double half_space_gradient(double d, double sigma) {
  const double t = 1 - d / sigma;
  return (7.5 * std::pow(t, 4) - 6 * std::pow(t, 5)) / sigma;
}

// Colliders as filled with the matter that meets them: engine/sph/walls.h.
void Oracle::find_walls(Particle& p) const {
  p.walls.clear();
  p.wall_share = 0;
  const Group& group = groups_[p.group];
  if (!config_.wall_pressure || config_.formulation == Formulation::printed || group.most_alpha == 0) return;
  const double sigma = *config_.support_radius;
  const double offset = config_.contact_offset.value_or(group.spacing / 2);
  for (const Obstacle& obstacle : obstacles_) {
    for (const Primitive& part : parts_of(obstacle.collider)) {
      const auto [phi, n] = distance(part, p.x - obstacle.moved);
      const double d = std::max(0.0, phi - offset + group.spacing / 2);
      if (d >= sigma) continue;
      const double share =
          volume_iterations() > 0 ? wendland_half_space_share(d, sigma) : half_space_share(d, sigma);
      Vec pushed = Vec::Zero();
      for (const Particle::Wall& wall : p.walls) pushed += wall.gradient * wall.normal;
      const double along = pushed.norm() > 0 ? pushed.normalized().dot(n) : 0, alike = std::max(along, 0.0);
      const double across = p.walls.empty() ? 0 : 1 - std::abs(along);
      const bool farther = share <= p.wall_share;
      for (Particle::Wall& wall : p.walls) {
        wall.share *= 1 - across * share - (farther ? 0 : alike);
        wall.gradient *= 1 - across * share - (farther ? 0 : alike);
        wall.left *= 1 - across * share - (farther ? 0 : alike);
      }
      const double left = 1 - across * p.wall_share - (farther ? alike : 0);
      p.walls.push_back({left * share, left * half_space_gradient(d, sigma), n, d, left,
                         obstacle.collider.velocity.cast<double>(), obstacle.collider.friction});
      p.wall_share += share - across * share * p.wall_share - alike * std::min(share, p.wall_share);
    }
  }
}

/// What a wall adds along it to what neighbours do, of which a particle sees S of all walls too little: at
/// most what gravity would take along it.
Vec pushed_along(const Particle::Wall& wall, double alpha, double all, const Vec& by_neighbors,
                 const Vec& weight) {
  const auto tangential = [&](const Vec& v) { return Vec(v - v.dot(wall.normal) * wall.normal); };
  const Vec push = wall.share / std::max(0.5, 1 - all) * tangential(by_neighbors);
  const double most = wall.share * tangential(weight).norm();
  return alpha < 1 && push.norm() > most ? Vec(most * push.normalized()) : push;
}

Vec Oracle::wall_acceleration(const Particle& p) const {
  const Group& group = groups_[p.group];
  const double pressure = group.pressure_coefficient * std::max(0.0, p.density - group.rest_density);
  Vec sum = Vec::Zero();
  for (const Particle::Wall& wall : p.walls)
    sum += alpha_of(p) * pressure / p.density * wall.gradient * wall.normal +
           pushed_along(wall, alpha_of(p), p.wall_share, p.blended, config_.gravity.cast<double>());
  return sum;
}

// Section 1: densities and pressures.
void Oracle::sum_densities() {
  for (Particle& i : particles_) {
    const Group& group = groups_[i.group];
    find_walls(i);
    double sum = i.wall_share;
    for (const Particle& j : particles_) {
      const Group& other = groups_[j.group];
      if (!act_on_each_other(i, j)) continue;
      const double r = (i.x - j.x).norm(), sigma = *config_.support_radius;
      sum += volume_iterations() > 0 ? other.wendland_volume * wendland(r, sigma)
                                     : other.mass / other.rest_density * poly6(r, sigma);
    }
    i.density = group.rest_density * sum;
    i.pressure = group.pressure_coefficient * (i.density - group.rest_density);
    if (i.pressure < 0) i.pressure *= group.cohesion;
  }
}

/// What j adds to the acceleration of i [TK eq. 1, 2, 4]. The conservative sums leave out j = i, and their
/// formula is zero there; the printed ones do not leave it out.
Vec Oracle::pair_acceleration(const Particle& i, const Particle& j) const {
  const double sigma = *config_.support_radius;
  const Vec d = i.x - j.x;
  const Group& group_i = groups_[i.group];
  const Group& group_j = groups_[j.group];
  const double mu = (viscosity_of(i) + viscosity_of(j)) / 2;
  const double volume = group_j.mass / j.density;
  // In the viscous term densities are at least those at rest.
  const double thick =
      std::min(1.0, i.density / group_i.rest_density) * std::min(1.0, j.density / group_j.rest_density);
  const bool touching = i.group != j.group;
  const double p_i = i.pressure * (touching ? group_i.contact_share : 1);
  const double p_j = j.pressure * (touching ? group_j.contact_share : 1);
  Vec force;
  if (config_.formulation == Formulation::printed) {
    force = -p_j * poly6_gradient(d, sigma) + mu * poly6_laplacian(d.norm(), sigma) * j.v;
  } else {
    // Viscosity along the pair alone (section 0 of the second chapter); no pair is along 0.
    const Vec along = d.norm() > 0 ? Vec(d.normalized()) : Vec::Zero();
    force = -(p_i + p_j) / 2 * spiky_gradient(d, sigma) +
            5 * thick * mu * viscosity_laplacian(d.norm(), sigma) * (j.v - i.v).dot(along) * along;
  }
  return volume / i.density * force;
}

void Oracle::sum_accelerations() {
  for (Particle& i : particles_) {
    i.sph = i.blended = Vec::Zero();
    i.crossing = Vec::Zero();
    for (const Particle& j : particles_) {
      if ((i.x - j.x).norm() > *config_.support_radius || !act_on_each_other(i, j)) continue;
      const Vec a = pair_acceleration(i, j);
      (j.group == i.group ? i.sph : i.crossing) += a;
      if (j.group == i.group) i.blended += (alpha_of(i) + alpha_of(j)) / 2 * a;
    }
    i.external = config_.gravity.cast<double>() + i.crossing + wall_acceleration(i);
    if (force_) i.external += force_(time_, i.id, i.x, i.v);
  }
}

// Section 3.
bool Oracle::needs_sph() const {
  const bool presses = groups_.size() > 1 && !bodies_touch();
  return presses || carries_heat() ||
         std::any_of(groups_.begin(), groups_.end(), [](const Group& g) { return g.most_alpha > 0; });
}

bool Oracle::has_limits() const {
  return needs_sph() || volume_iterations() > 0 || bodies_touch();
}

double Oracle::max_velocity() const {
  double max = 0;
  for (const Particle& p : particles_) {
    const Group& group = groups_[p.group];
    const bool whole = needs_sph() && group.material.pressure_coefficient && !is_painted();
    if (!p.pinned) max = std::max(max, (p.v + longest_ * ((whole ? p.sph : p.blended) + p.external)).norm());
  }
  return max;
}

// Of the two springs together: 2 a Δt² + pull Δt (Δt + 2 τ) = 3.4, less what drags beside damping.
double Oracle::damped_limit(const Group& group, double a, double drag, double pull) const {
  const double tau = group.material.damping_time, rate = group.material.deformation_damping.value_or(0.0f);
  const auto root = [&](double most) {
    const double b = tau * pull, c = 2 * a + pull;
    return (std::sqrt(b * b + c * most) - b) / c;
  };
  const double step = std::min(longest_, root(3.4));
  const double taken = 1 - std::exp(-rate * step) + std::min(1.0, 25 * drag * step);
  return root(tau * pull > 0 || rate > 0 ? 3.4 * (1 - taken / 2) : 3.4);
}

double Oracle::time_step(double max_velocity) const {
  const double longest = longest_;
  if (!has_limits()) return longest;
  const double sigma = *config_.support_radius;
  double widest = 0;
  for (const Group& group : groups_) widest = std::max(widest, group.spacing);
  const double farthest = bodies_touch() ? sigma - widest / 2 : sigma;
  double dt = std::min(longest, 0.999 * farthest / max_velocity);
  if (config_.acoustic_limit) {
    for (const Group& group : groups_) {
      dt = std::min(dt, sigma * sigma * group.rest_density / (25 * group.viscosity));
      const bool alone = groups_.size() == 1 || bodies_touch();
      const double push = alone ? group.most_alpha : group.contact_share, drag = alone ? group.most_alpha : 1;
      const double a = push * group.pressure_coefficient / (sigma * sigma);
      const double b = 800 * drag * group.viscosity / group.rest_density / (sigma * sigma);
      const double pull = group.most_elasticity * stiffness(group);
      if (a > 0)
        dt = std::min({dt, (b + std::sqrt(b * b + 0.2 * a)) / (2 * a), std::sqrt(1.4 / a),
                       damped_limit(group, a, b / 800, pull)});
    }
  }
  if (!(dt >= longest / 1000)) throw std::runtime_error("the time step would fall below a thousandth");
  return dt;
}

// Section 2. Reads x̄, x and the last rotations; writes rotations and goals. Where `leads`, both stages are on
// x + τ v. [section 4 B of the second chapter]
void Oracle::match_shapes(bool leads) {
  const auto weight = [&](const Particle& p) {
    return groups_[p.group].mass / static_cast<double>(p.region.size());
  };
  const auto place = [&](const Particle& p) {
    return Vec(p.x + (leads ? double{groups_[p.group].material.damping_time} : 0.0) * p.v);
  };
  std::vector<Vec> centers(particles_.size());
  std::vector<Vec> reference_centers(particles_.size());
  for (std::size_t id = 0; id < particles_.size(); ++id) {
    Particle& j = particles_[id];
    double w = 0;
    Vec c = Vec::Zero();
    Vec c_ref = Vec::Zero();
    for (std::size_t i : j.region) {
      w += weight(particles_[i]);
      c += weight(particles_[i]) * place(particles_[i]);
      c_ref += weight(particles_[i]) * particles_[i].reference;
    }
    c /= w;
    c_ref /= w;
    Matrix a = Matrix::Zero();
    for (std::size_t i : j.region) {
      a += weight(particles_[i]) * (place(particles_[i]) - c) * (particles_[i].reference - c_ref).transpose();
    }
    const double radius = groups_[j.group].material.region_radius.value_or(*config_.support_radius);
    j.rotation = polar_rotation(a * j.stretch.transpose(), j.rotation, w * radius * radius);
    j.moment = a;
    j.rest_moment = Matrix::Zero();
    for (std::size_t i : j.region) {
      const Vec r = particles_[i].reference - c_ref;
      j.rest_moment += weight(particles_[i]) * r * r.transpose();
    }
    centers[id] = c;
    reference_centers[id] = c_ref;
    j.outward =
        groups_[j.group].least_alpha == 1 ? Vec(Vec::Zero()) : Vec(j.rotation * (j.reference - c_ref));
  }
  for (Particle& i : particles_) {
    const auto count = static_cast<double>(i.region.size());
    i.goal = i.pull = Vec::Zero();
    for (std::size_t j : i.region) {
      const Vec goal =
          particles_[j].rotation * particles_[j].stretch * (i.reference - reference_centers[j]) + centers[j];
      i.goal += goal / count;
      i.pull += (1 - alpha_of(particles_[j])) * particles_[j].stiffness * (goal - place(i)) / count;
    }
  }
}

namespace {

/// Of the stretched reference shape.
bool is_thin(const Particle& j) {
  const Matrix p = j.stretch * j.rest_moment * j.stretch.transpose();
  return !(p.determinant() > 1e-4 * std::pow(p.trace() / 3, 3));
}

/// Such as a layer of particles, which says nothing of strain across it.
bool is_single_layer(const Particle& j) {
  return !(j.rest_moment.determinant() > 0.1 * std::pow(j.rest_moment.trace() / 3, 3));
}

/// E of a region.
Matrix elastic_strain(const Particle& j) {
  const Matrix f = j.moment * j.rest_moment.inverse() * j.stretch.inverse();
  const Matrix turned = j.rotation.transpose() * f;
  return (turned + turned.transpose()) / 2;
}

}  // namespace

// Section 5 of the second chapter.
void Oracle::flow(double dt) {
  for (Particle& j : particles_) {
    const Material& material = groups_[j.group].material;
    if (!flows(groups_[j.group]) || is_thin(j) || is_single_layer(j)) continue;
    const Matrix e = elastic_strain(j);
    if (Eigen::SelfAdjointEigenSolver<Matrix>(e).eigenvalues().minCoeff() <= 0) continue;
    const Matrix strain = e / std::cbrt(e.determinant()) - Matrix::Identity();
    const double yield = yield_of(j);
    if (strain.norm() <= yield) continue;
    const double share = material.plastic_creep ? 1 - std::exp(-*material.plastic_creep * dt) : 1;
    const double y = std::min((1 - yield / strain.norm()) * share, 0.5 / strain.norm());
    Matrix g = Matrix::Identity() + y * strain;
    g /= std::cbrt(g.determinant());
    // None that adds to elastic energy of what is crushed or comes apart.
    const bool is_whole = e.determinant() > 0.42 && e.determinant() < 2;
    const Matrix stretched = j.stretch * j.rest_moment * j.stretch.transpose();
    const auto energy = [&](const Matrix& goal) { return ((e - goal) * stretched * (e - goal)).trace(); };
    if (!is_whole && energy(g) > energy(Matrix::Identity())) continue;
    j.stretch = g * j.stretch;
    j.flow += (g - Matrix::Identity()).norm();
  }
}

bool Oracle::reframe_is_due(std::size_t group) const {
  const Group& g = groups_[group];
  if (!flows(g)) return false;
  const double radius = g.material.region_radius.value_or(*config_.support_radius);
  for (const Particle& i : particles_) {
    if (i.group != group) continue;
    if (i.flow > 0.5) return true;
    for (const Particle& j : particles_) {
      if (j.group != group) continue;
      const double flow = std::min(i.flow, j.flow);
      const double now = (i.x - j.x).norm(), rest = (i.reference - j.reference).norm();
      if (flow > double{g.material.merge_flow} && rest > radius && now < g.spacing) return true;
    }
  }
  return false;
}

bool Oracle::is_torn(std::size_t group) const {
  const Group& g = groups_[group];
  if (!flows(g)) return false;
  const double radius = g.material.region_radius.value_or(*config_.support_radius);
  const double least = check_is_due() ? 0 : 0.1;
  for (const Particle& i : particles_)
    for (const Particle& j : particles_) {
      if (i.group != group || j.group != group || !(std::min(i.flow, j.flow) > least)) continue;
      const double now = (i.x - j.x).norm(), rest = (i.reference - j.reference).norm();
      if (rest <= radius && now > (1 + double{g.material.tear_strain}) * radius) return true;
    }
  return false;
}

/// Half of it has.
bool Oracle::has_flowed_too_far(std::size_t group) const {
  const Group& g = groups_[group];
  if (!flows(g)) return false;
  int all = 0, far = 0;
  for (const Particle& i : particles_) {
    if (i.group != group) continue;
    ++all;
    far += i.flow > 1.2;
  }
  return 2 * far > all;
}

/// Of all regions as they are turned and stretched, by unit stiffness.
double Oracle::strain_energy(std::size_t group) const {
  double energy = 0;
  for (const Particle& j : particles_) {
    if (j.group != group) continue;
    double w = 0;
    Vec c = Vec::Zero(), c_ref = Vec::Zero();
    const auto weight = [&](std::size_t i) { return 1 / static_cast<double>(particles_[i].region.size()); };
    for (const std::size_t i : j.region) {
      w += weight(i);
      c += weight(i) * particles_[i].x;
      c_ref += weight(i) * particles_[i].reference;
    }
    for (const std::size_t i : j.region) {
      const Vec goal = j.rotation * j.stretch * (particles_[i].reference - c_ref / w) + c / w;
      energy += 0.5 * weight(i) * (goal - particles_[i].x).squaredNorm();
    }
  }
  return energy;
}

// Elastic strain stays, but for what would add to its energy; all else is as after an update. None where it
// waits for a blow to end.
bool Oracle::reframe(std::size_t group, bool waits) {
  match_shapes(false);
  int all = 0, strained = 0;
  std::vector<Matrix> stretches;
  for (const Particle& j : particles_) {
    stretches.push_back(Matrix::Identity());
    all += j.group == group;
    if (j.group != group || is_thin(j)) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(elastic_strain(j));
    const Vec found = solver.eigenvalues();
    const double size = found.minCoeff() > 0 ? std::clamp(std::cbrt(found.prod()), 0.3, 1.25) : 1;
    strained += (found / size - Vec::Ones()).norm() > std::max(0.25, 2 * yield_of(j));
    const Vec clipped = size * (found / size).cwiseMax(0.8).cwiseMin(1.25);
    const Matrix axes = j.rotation * solver.eigenvectors();
    stretches.back() = axes * clipped.cwiseInverse().asDiagonal() * axes.transpose();
  }
  if (waits && 2 * strained > all) return false;
  const double before = strain_energy(group);
  rebuild_regions(group);
  for (std::size_t i = 0; i < particles_.size(); ++i)
    if (particles_[i].group == group) particles_[i].stretch = stretches[i];
  const double after = strain_energy(group), share = after > before ? std::sqrt(before / after) : 1;
  for (Particle& i : particles_)
    if (i.group == group) i.stretch = share * i.stretch + (1 - share) * Matrix::Identity();
  return true;
}

// Section 4 A of the second chapter, one obstacle: its parts one after the other.
void Oracle::touch(const Obstacle& obstacle, const Particle& particle, const Vec& before, double dt,
                   Vec& v) const {
  const Collider& collider = obstacle.collider;
  const double offset = config_.contact_offset.value_or(groups_[particle.group].spacing / 2);
  const Vec u = collider.velocity.cast<double>();
  const Vec gravity = config_.gravity.cast<double>();
  for (const Primitive& part : parts_of(collider)) {
    const auto [phi, n] = distance_on_the_way(part, particle.x - obstacle.moved, dt * (v - u), offset);
    const double d = phi - offset;
    const Vec w = v - u;
    const double w_n = w.dot(n);
    if (d + dt * w_n >= 0) continue;

    const double gentle = *config_.support_radius / (10 * dt0_);
    double new_w_n = d >= 0 ? -d / dt : std::min(-d / dt, gentle);
    const Vec came = before - u;
    const double q = came.dot(n), e = collider.restitution;
    if (e > 0 && q < -2 * gravity.norm() * dt) {
      const double g_n = std::max(0.0, -gravity.dot(n)), gamma = g_n * dt / 2;
      const double s = e * e * std::pow(std::abs(q) + gamma, 2) - 2 * (1 - e * e) * g_n * std::max(d, 0.0);
      if (s > 0) new_w_n = std::max(new_w_n, std::min(std::sqrt(s) - gamma, std::abs(q)));
    }
    const Vec w_t = w - w_n * n, v_t = came - q * n;
    const double sliding = w_t.norm();
    double c = sliding > 0 ? std::min(1.0, collider.friction * (new_w_n - w_n) / sliding) : 1;
    if (w_t.dot(v_t) < 0) c = std::min(c, std::max(0.0, 1 + w_t.dot(v_t) / w_t.squaredNorm()));
    v = u + new_w_n * n + (1 - c) * w_t;
  }
}

/// Friction of what walls have pushed with, which contact does not see.
void Oracle::rub(const Vec& before, Particle& p) {
  for (const Particle::Wall& wall : p.walls) {
    const auto along = [&](const Vec& w) { return Vec(w - w.dot(wall.normal) * wall.normal); };
    const Vec w_t = along(p.v - wall.velocity), v_t = along(before - wall.velocity);
    if (w_t.norm() == 0) continue;
    double c = std::min(1.0, wall.friction * wall.push / w_t.norm());
    if (w_t.dot(v_t) < 0) c = std::min(c, std::max(0.0, 1 + w_t.dot(v_t) / w_t.squaredNorm()));
    p.v -= c * w_t;
  }
}

// Section 4.
int Oracle::move(double dt) {
  // The pull's: from the middle of the last step to the middle of this one.
  const double pull_time = steps_ > 0 ? (time_ - last_start_ + dt) / 2 : dt;
  std::vector<Vec> before;
  for (const Particle& p : particles_) before.push_back(p.v);
  damp(dt);
  for (Particle& p : particles_) {
    const Group& group = groups_[p.group];
    p.contact = Vec::Zero();
    if (p.pinned) {
      p.v = p.pin_velocity;
      continue;
    }
    p.v += dt * p.external + dt * p.blended;
    const double pressure = group.pressure_coefficient * std::max(0.0, p.density - group.rest_density);
    for (Particle::Wall& wall : p.walls) wall.push = dt * alpha_of(p) * pressure / p.density * wall.gradient;
    if (!is_always_fluid(group)) p.v += pull_time * stiffness(group) * p.pull;
  }
  const int iterations = keep_volume(dt, before);
  const std::vector<Vec> free = velocities();
  std::vector<Vec> touched = free;
  touch_bodies(dt, touched);
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    Particle& p = particles_[k];
    p.v = touched[k];
    if (!p.pinned) rub(before[k], p);
    for (const Obstacle& obstacle : obstacles_)
      if (!p.pinned) touch(obstacle, p, before[k], dt, p.v);
    p.contact = (p.v - free[k]) / dt;
    p.x += dt * p.v;
  }
  return iterations;
}

}  // namespace mallow::oracle
