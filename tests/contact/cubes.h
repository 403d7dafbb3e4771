// Bodies that touch, and what tests ask of them: spacing 1, steps of 0.15 s.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::contact_tests {

using Vec = Eigen::Vector3d;

inline SolverConfig solver(float gravity) {
  return {.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -gravity}, .threads = 2};
}
inline Body box(const std::array<int, 3>& count, const Vec3& corner, const Vec3& velocity = {0, 0, 0}) {
  Body body = sample(Lattice{.count = count, .spacing = 1, .corner = corner, .jitter = 0.02f});
  body.velocity = velocity;
  return body;
}
inline Material material(float alpha) {
  return {.alpha = alpha, .update_threshold = 1e9f};
}
inline void run(Simulation& s, double seconds) {
  const double end = s.time() + seconds;
  while (s.time() < end) s.step();
}

inline std::vector<Vec> centers(const Simulation& s) {
  const std::vector<Vec3> x = s.positions_by_id();
  const std::vector<std::uint32_t> body = s.bodies_by_id();
  std::vector<Vec> sum;
  std::vector<double> count;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (body[i] >= sum.size()) {
      sum.resize(body[i] + 1, Vec::Zero());
      count.resize(body[i] + 1, 0);
    }
    sum[body[i]] += x[i].cast<double>();
    count[body[i]] += 1;
  }
  for (std::size_t b = 0; b < sum.size(); ++b) sum[b] /= count[b];
  return sum;
}
/// The smallest distance between particles of two bodies.
inline double nearest(const Simulation& s, std::size_t first_of_other) {
  const std::vector<Vec3> x = s.positions_by_id();
  double least = 1e9;
  for (std::size_t i = 0; i < first_of_other; ++i)
    for (std::size_t j = first_of_other; j < x.size(); ++j)
      least = std::min(least, static_cast<double>((x[i] - x[j]).norm()));
  return least;
}
inline double fastest(const Simulation& s) {
  float most = 0;
  for (const Vec3& v : s.velocities_by_id()) most = std::max(most, v.norm());
  return static_cast<double>(most);
}

}  // namespace mallow::contact_tests
