// A collider that goes where a function of the application says, as a callback would have it: a rod stirs
// syrup on an ellipse.
#include <mallow/mallow.h>

#include <cmath>
#include <iostream>

namespace {

constexpr double k_frame = 1.0 / 60;  // [s]
constexpr double k_turn = 3;          // [rad/s]

/// Where the rod is at a time [s].
mallow::Pose rod_at(double time) {
  return {.translation = {0.06 * std::cos(k_turn * time), 0.03 * std::sin(k_turn * time), 0}};
}

}  // namespace

int main() {
  mallow::Simulation simulation({.support_radius = 0.021f, .gravity = {0, 0, -9.81f}});
  const mallow::Box pot{.min = {-0.12f, -0.12f, 0}, .max = {0.12f, 0.12f, 1}, .inside = true};
  simulation.add_collider({.shape = pot});
  const mallow::Capsule rod{.start = {0, 0, 0.01f}, .end = {0, 0, 0.2f}, .radius = 0.015f};
  const mallow::ColliderId stirrer =
      simulation.add_collider({.shape = rod, .pose = rod_at(0), .measure_load = true});
  simulation.add_body(
      sample(mallow::Lattice{.count = {20, 20, 5}, .spacing = 0.01f, .corner = {-0.1f, -0.1f, 0.005f}}),
      {.alpha = 1.0f, .rest_density = 1000.0f}, "syrup");
  for (int frame = 0; frame < 120; ++frame) {
    // Before each frame: where the rod is after it. On the way it goes evenly.
    simulation.set_pose(stirrer, rod_at(simulation.time() + k_frame), k_frame);
    simulation.advance(k_frame);
  }

  const Eigen::Vector3d off =
      simulation.collider(stirrer).pose.translation - rod_at(simulation.time()).translation;
  const auto x = simulation.positions().eigen(), v = simulation.velocities().eigen();
  const float spin = (x.col(0).cwiseProduct(v.col(1)) - x.col(1).cwiseProduct(v.col(0))).sum();
  std::cout << "the rod is " << off.norm() << " m off its way; the syrup goes round with it: " << (spin > 0)
            << '\n';
  return off.norm() < 1e-9 && spin > 0 ? 0 : 1;
}
