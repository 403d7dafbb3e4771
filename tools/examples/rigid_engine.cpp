// Balls of another engine, Bullet, and dough push each other: Bullet has their masses, spins and what they do
// to each other; mallow gets their velocities and says what matter did to them, step by step. Two steel balls
// fall, one on the other, into a slab of dough and leave a dent.
#include <mallow/mallow.h>
#include <mallow/materials.h>

#include <BulletDynamics/btBulletDynamicsCommon.h>

#include <iostream>
#include <memory>
#include <vector>

namespace {

constexpr double k_gravity = 9.81;

btVector3 bullet(const Eigen::Vector3d& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
mallow::Vec3 mallow_vector(const btVector3& v) {
  return mallow::Vec3(v.x(), v.y(), v.z());
}

/// Bullet's world, without contact between its bodies and what only mallow has.
class Balls {
 public:
  Balls() { world_.setGravity({0, 0, static_cast<btScalar>(-k_gravity)}); }
  ~Balls() {
    for (Ball& ball : balls_) world_.removeRigidBody(ball.body.get());
  }

  void add(mallow::Simulation& simulation, double radius, double density, const Eigen::Vector3d& center) {
    const double mass = density * 4 / 3 * 3.14159265 * radius * radius * radius;
    Ball& ball = balls_.emplace_back();
    ball.shape = std::make_unique<btSphereShape>(static_cast<btScalar>(radius));
    btVector3 inertia;
    ball.shape->calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    ball.body =
        std::make_unique<btRigidBody>(static_cast<btScalar>(mass), nullptr, ball.shape.get(), inertia);
    ball.body->setWorldTransform(btTransform(btQuaternion::getIdentity(), bullet(center)));
    ball.body->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(ball.body.get());
    mallow::Collider collider{.shape = mallow::Sphere{.radius = static_cast<float>(radius)},
                              .friction = 0.5f};
    collider.pose.translation = center;
    collider.measure_load = true;
    ball.collider = simulation.add_collider(collider);
  }

  /// What matter did to the balls in a step of mallow, then the same time in Bullet, then how they move in
  /// the next step of mallow.
  void step(mallow::Simulation& simulation, double seconds) {
    for (const Ball& ball : balls_) {
      const mallow::ColliderLoad load = simulation.load(ball.collider);
      ball.body->applyCentralImpulse(bullet(load.impulse));
      ball.body->applyTorqueImpulse(bullet(load.torque));
    }
    world_.stepSimulation(static_cast<btScalar>(seconds), 0);
    for (const Ball& ball : balls_)
      simulation.set_twist(ball.collider, mallow_vector(ball.body->getLinearVelocity()),
                           mallow_vector(ball.body->getAngularVelocity()));
  }

  double mass() const {
    double sum = 0;
    for (const Ball& ball : balls_) sum += static_cast<double>(ball.body->getMass());
    return sum;
  }
  Eigen::Vector3d momentum() const {
    Eigen::Vector3d sum(0, 0, 0);
    for (const Ball& ball : balls_)
      sum += static_cast<double>(ball.body->getMass()) *
             mallow_vector(ball.body->getLinearVelocity()).cast<double>();
    return sum;
  }
  void take_away(mallow::Simulation& simulation) const {
    for (const Ball& ball : balls_) simulation.remove_collider(ball.collider);
  }

 private:
  struct Ball {
    std::unique_ptr<btSphereShape> shape;
    std::unique_ptr<btRigidBody> body;
    mallow::ColliderId collider;
  };
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<Ball> balls_;
};

}  // namespace

int main() {
  mallow::Simulation simulation({.gravity = {0, 0, static_cast<float>(-k_gravity)}});
  const mallow::ColliderId floor =
      simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.7f, .measure_load = true});
  const float h = 0.01f, side = 0.2f;
  const mallow::BodyId dough = simulation.add_body(
      sample(mallow::Lattice{.count = {20, 20, 7}, .spacing = h, .corner = {-side / 2, -side / 2, 0}}),
      mallow::materials::dough());
  Balls balls;
  balls.add(simulation, 0.03, 7800, {0, 0, 0.13});
  balls.add(simulation, 0.02, 7800, {0.01, 0, 0.22});

  const auto surface = [&] { return simulation.raycast({0, 0, 0.1f}, {0, 0, -1}).value().position.z(); };
  const double top = static_cast<double>(surface());
  const double mass = balls.mass() + simulation.motion(dough).mass;
  Eigen::Vector3d given(0, 0, 0);  // by gravity and the floor
  double most = 0;
  while (simulation.time() < 0.6) {
    const double seconds = simulation.step().time_step;
    balls.step(simulation, seconds);
    given += -simulation.load(floor).impulse - Eigen::Vector3d(0, 0, mass * k_gravity * seconds);
    most = std::max(most, (balls.momentum() + simulation.motion(dough).momentum - given).norm());
  }
  balls.take_away(simulation);
  simulation.advance(0.5);

  const double dent = top - static_cast<double>(surface());
  const double share = most / (mass * k_gravity * 0.6);
  std::cout << "momentum of balls and dough kept to " << share
            << " of what gravity gave; the dent that is left is " << 100 * dent << " cm deep\n";
  return share < 1e-4 && dent > 0.01 ? 0 : 1;
}
