// Contact between bodies: section 4 C of the second chapter, with what engine/REFERENCES.md departs in: N,
// the share of an overlap that a step takes away, rounds that end early, pairs farther apart than σ,
// adhesion.
#include <algorithm>
#include <cmath>
#include <optional>

#include "oracle/oracle.h"

namespace mallow::oracle {
namespace {

constexpr int k_least_rounds = 4, k_most_rounds = 8;

/// How far a normal turns from the line between two points to the way out of a body, β. along: cosine between
/// the two.
double turn(double along, double depth, double d0) {
  const double t = std::clamp((along - 0.6) / 0.3, 0.0, 1.0);
  return t * t * (3 - 2 * t) * std::clamp((depth / d0 - 0.1) / 0.15, 0.0, 1.0);
}

struct Meeting {
  Vec normal;
  double gap;
};

/// r: from j to i. Nothing where they pass each other by.
std::optional<Meeting> meeting_of(const Vec& r, const Vec& out_i, const Vec& out_j, double d0) {
  const Vec line = r.normalized();
  const auto direction = [](const Vec& out) { return out.norm() > 0 ? out.normalized() : Vec(Vec::Zero()); };
  const Vec way_i = direction(out_i), way_j = direction(out_j);
  const double beta_i = turn(-way_i.dot(line), out_i.norm(), d0);
  const double beta_j = turn(way_j.dot(line), out_j.norm(), d0), beta = std::max(beta_i, beta_j);
  if (beta == 0) return Meeting{line, r.norm() - d0};
  const double p_i = beta_i > 0 ? beta_i * std::pow(d0 / out_i.norm(), 3) : 0;
  const double p_j = beta_j > 0 ? beta_j * std::pow(d0 / out_j.norm(), 3) : 0;
  const Vec out = (-p_i * way_i + p_j * way_j) / (p_i + p_j);
  const Vec n = ((1 - beta) * line + beta * out).normalized();
  if ((r - r.dot(n) * n).norm() > 0.75 * d0) return {};
  return Meeting{n, r.dot(n) - d0};
}

struct Pair {
  std::size_t i, j;
  Vec normal;
  double target;    ///< t
  double friction;  ///< μ
  double sticks;    ///< impulse by which it may still be held [N s]
};

}  // namespace

bool Oracle::bodies_touch() const {
  return config_.contact == BodyContact::constraint && groups_.size() > 1;
}

bool Oracle::act_on_each_other(const Particle& i, const Particle& j) const {
  return i.group == j.group || !bodies_touch();
}

// v: predicted, of all particles.
void Oracle::touch_bodies(double dt, std::vector<Vec>& v) const {
  if (!bodies_touch()) return;
  const auto inverse_mass = [&](std::size_t i) {
    return particles_[i].pinned ? 0 : 1 / groups_[particles_[i].group].mass;
  };
  const double gentle = *config_.support_radius / (10 * dt0_);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < particles_.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Particle &a = particles_[i], &b = particles_[j];
      if (a.group == b.group || inverse_mass(i) + inverse_mass(j) == 0) continue;
      const Group &own = groups_[a.group], &other = groups_[b.group];
      const double d0 = (own.spacing + other.spacing) / 2;
      const Vec r = a.x - b.x;
      if (r.norm() > 2 * *config_.support_radius) continue;
      const std::optional<Meeting> met = meeting_of(r, a.outward, b.outward, d0);
      if (!met) continue;
      const double closes = -met->gap / dt;
      const double target = met->gap < 0 ? std::clamp(0.3 * (closes - 0.02 * d0 / dt), 0.0, gentle) : closes;
      const double stress =
          met->gap < 0.1 * d0 ? std::sqrt(double{own.material.adhesion} * other.material.adhesion) : 0;
      pairs.push_back({i, j, met->normal, target,
                       std::sqrt(double{own.material.friction} * other.material.friction),
                       stress * d0 * d0 * dt});
    }
  double least = INFINITY;
  for (const Group& group : groups_) least = std::min(least, group.spacing);
  for (int round = 0; round < k_most_rounds; ++round) {
    std::vector<Pair*> active;
    std::vector<int> count(particles_.size(), 0);
    double miss = 0;
    for (Pair& pair : pairs) {
      const double along = (v[pair.i] - v[pair.j]).dot(pair.normal);
      if (along >= pair.target && pair.sticks <= 0) continue;
      active.push_back(&pair);
      ++count[pair.i];
      ++count[pair.j];
      miss = std::max(miss, std::abs(pair.target - along));
    }
    if (miss == 0 || (round >= k_least_rounds && dt * miss < 0.01 * least)) break;
    std::vector<Vec> given(particles_.size(), Vec::Zero());
    for (Pair* pair : active) {
      const auto& [i, j, n, target, friction, sticks] = *pair;
      const double mass = 1 / (count[i] * inverse_mass(i) + count[j] * inverse_mass(j));
      const Vec w = v[i] - v[j], w_t = w - w.dot(n) * n;
      const double push = std::max(mass * (target - w.dot(n)), -sticks);
      const double rub = std::min(friction * (std::max(push, 0.0) + sticks), mass * w_t.norm());
      const Vec impulse = push * n - (w_t.norm() > 0 ? Vec(rub * w_t.normalized()) : Vec(Vec::Zero()));
      given[i] += impulse;
      given[j] -= impulse;
      pair->sticks = std::max(0.0, sticks - std::max(-push, 0.0));
    }
    for (std::size_t i = 0; i < particles_.size(); ++i) v[i] += inverse_mass(i) * given[i];
  }
}

}  // namespace mallow::oracle
