// A whirl of air turns a falling cube about the z axis: a force of the application's own, called once a step.
#include <mallow/mallow.h>

#include <iostream>

namespace {

constexpr float k_drag = 0.2f;  // [1/s]
constexpr float k_turn = 0.5f;  // [rad/s]

/// Drags particles along with air that turns about the z axis.
void blow(const mallow::ForceInput& particles, mallow::VectorSpan accelerations) {
  for (std::size_t row = 0; row < particles.ids.size(); ++row) {
    const mallow::Vec3 x = particles.positions[row], v = particles.velocities[row];
    accelerations.x()[row] += k_drag * (-k_turn * x.y() - v.x());
    accelerations.y()[row] += k_drag * (k_turn * x.x() - v.y());
  }
}

}  // namespace

int main() {
  mallow::Simulation simulation({.support_radius = 2.0f});
  simulation.add_collider({.shape = mallow::Plane{}});
  simulation.add_body(sample(mallow::Lattice{.count = {6, 6, 6}, .corner = {-3, -3, 2}}), {.alpha = 0.3f});
  simulation.set_force(blow);
  simulation.advance(20);

  // The mean of x v_y - y v_x over that of x² + y² is how fast it turns.
  const auto x = simulation.positions().eigen(), v = simulation.velocities().eigen();
  const float spin = (x.col(0).cwiseProduct(v.col(1)) - x.col(1).cwiseProduct(v.col(0))).sum();
  const float turn = spin / x.leftCols<2>().squaredNorm();
  std::cout << "the cube turns by " << turn << " rad/s, the air by " << k_turn << '\n';
  return turn > 0.5f * k_turn && turn < 1.2f * k_turn ? 0 : 1;
}
