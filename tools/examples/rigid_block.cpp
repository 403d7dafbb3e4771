// A rigid body of another engine and particles push each other: its pose and twist go in, the impulse and
// torque that it took come out, step by step. A block hits a free cube of jelly.
#include <mallow/mallow.h>

#include <algorithm>
#include <iostream>

using Vec = Eigen::Vector3d;

/// What a rigid engine has of a box.
struct RigidBox {
  mallow::ColliderId collider;
  double mass;
  Vec half;  // sides
  Vec velocity{0, 0, 0}, spin{0, 0, 0};

  /// One step of both engines.
  void step(mallow::Simulation& simulation) {
    simulation.set_twist(collider, velocity.cast<float>(), spin.cast<float>());
    simulation.step();
    const mallow::ColliderLoad load = simulation.load(collider);
    const Eigen::Quaterniond turn(Eigen::Vector4d(simulation.collider(collider).pose.rotation));
    const Vec squares = half.cwiseAbs2();
    const Vec inertia = mass / 3 * (Vec::Constant(squares.sum()) - squares);
    const Vec torque = turn.conjugate() * load.torque;
    velocity += load.impulse / mass;  // and time_step times gravity, and what other rigid bodies give
    spin += turn * torque.cwiseQuotient(inertia);
  }
};

mallow::Collider box(const Vec& half, const Vec& center) {
  mallow::Collider collider{.shape = mallow::Box{(-half).cast<float>(), half.cast<float>()},
                            .friction = 0.3f};
  collider.pose.translation = center;
  collider.measure_load = true;
  return collider;
}

/// The largest change of the momentum of both, as a share of what the block came with.
double collision() {
  mallow::Simulation simulation({.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, 0}});
  const mallow::BodyId jelly = simulation.add_body(
      sample(mallow::Lattice{.count = {6, 6, 6}, .corner = {-3, -3, -3}}), {.alpha = 0.1f});
  RigidBox block{simulation.add_collider(box({2, 2, 2}, {-7, 0.5, 0.5})), 100, {2, 2, 2}};
  block.velocity = {1, 0, 0};
  const Vec before = block.mass * block.velocity;
  double most = 0;
  for (int k = 0; k < 200; ++k) {
    block.step(simulation);
    most = std::max(most, (simulation.motion(jelly).momentum + block.mass * block.velocity - before).norm());
  }
  return most / before.norm();
}

int main() {
  const double change = collision();
  std::cout << "momentum of block and jelly kept to " << change << '\n';
  return change < 1e-4 ? 0 : 1;
}
