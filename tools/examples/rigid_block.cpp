// A rigid body of another engine and particles push each other: its pose and twist go in, the impulse and
// torque that it took come out, step by step. A block hits a free cube of jelly; one of wood floats in a
// tank.
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
  void step(mallow::Simulation& simulation, const Vec& gravity = {0, 0, 0}) {
    simulation.set_twist(collider, velocity.cast<float>(), spin.cast<float>());
    const double seconds = simulation.step().time_step;
    const mallow::ColliderLoad load = simulation.load(collider);
    const Eigen::Quaterniond turn(Eigen::Vector4d(simulation.collider(collider).pose.rotation));
    const Vec squares = half.cwiseAbs2();
    const Vec inertia = mass / 3 * (Vec::Constant(squares.sum()) - squares);
    const Vec torque = turn.conjugate() * load.torque;
    velocity += load.impulse / mass + seconds * gravity;  // and what other rigid bodies give
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

/// How deep a block of half the water's density floats, as a share of what Archimedes says: half its height.
double draft() {
  constexpr int k_side = 20, k_depth = 12;
  const Vec gravity(0, 0, -0.3), half(5, 5, 5);
  mallow::Simulation simulation(
      {.time_step = 0.15f, .support_radius = 2.1f, .gravity = gravity.cast<float>()});
  const float wall = k_side / 2.0f;
  simulation.add_collider({.shape = mallow::Box{{-wall, -wall, 0}, {wall, wall, 30}, true}});
  simulation.add_body(
      sample(mallow::Lattice{.count = {k_side, k_side, k_depth}, .corner = {-wall, -wall, 0}}),
      {.alpha = 1.0f, .particle_mass = 1.0f});
  RigidBox wood{simulation.add_collider(box(half, {0, 0, k_depth + half.z()})), 4 * half.prod(), half};
  // The wood displaces its mass, which raises the level.
  const double level = k_depth + wood.mass / (k_side * k_side);
  double bottom = 0;
  constexpr int k_steps = 500, k_last = 150;
  for (int k = 0; k < k_steps; ++k) {
    wood.step(simulation, gravity);
    if (k >= k_steps - k_last)
      bottom += (simulation.collider(wood.collider).pose.translation.z() - half.z()) / k_last;
  }
  return (level - bottom) / half.z();
}

int main() {
  const double change = collision(), depth = draft();
  std::cout << "momentum of block and jelly kept to " << change << "; wood floats at " << depth
            << " of Archimedes' depth\n";
  return change < 1e-4 && depth > 0.95 && depth < 1.05 ? 0 : 1;
}
