#include "drift/flight.h"

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "textbook/textbook.h"

namespace mallow::bench {
namespace {

/// Velocities that twist and stretch.
void stir(Body& body, float velocity) {
  const Vec3 corner = body.positions.front();
  for (const Vec3& x : body.positions) {
    const auto wave = [&](int axis) {
      return std::sin(0.4f * std::numbers::pi_v<float> * (x - corner)[axis]);
    };
    body.velocities.push_back(velocity * Vec3(wave(1), wave(2), wave(0)));
  }
}

/// What is there at the start and after each of `steps`.
std::vector<Snapshot> record(const std::vector<int>& steps, const std::function<void()>& step,
                             const std::function<Snapshot()>& now) {
  std::vector<Snapshot> snapshots = {now()};
  int taken = 0;
  for (const int at : steps) {
    for (; taken < at; ++taken) step();
    snapshots.push_back(now());
  }
  return snapshots;
}

}  // namespace

std::vector<DriftScene> drift_scenes() {
  struct Kind {
    const char* name;
    float alpha;
  };
  std::vector<DriftScene> scenes;
  const auto add = [&](const std::string& name, float alpha, bool falls, const Vec3& corner) {
    DriftScene scene;
    scene.name = name;
    // The paper's numbers, the same with gravity and without.
    scene.config = {
        .time_step = 0.15f, .support_radius = 2.1f, .update_interval = 60, .sleep_speed = 0.0f, .threads = 1};
    scene.config.wall_pressure = false;  // the textbook has none
    scene.material = {.alpha = alpha,
                      .update_threshold = 12.0f,
                      .pressure_coefficient = 16.0f,
                      .viscosity = 0.5f,
                      .deformation_damping = 0.0f};
    scene.body = sample(Lattice{.count = {5, 5, 5}, .corner = corner, .jitter = 0});
    if (falls)
      scene.colliders = {{.shape = Plane{}, .friction = 0.3f}};
    else
      scene.config.gravity = Vec3::Zero();
    if (!falls) stir(scene.body, 0.2f);
    scenes.push_back(scene);
  };
  for (const Kind& kind : {Kind{"solid", 0}, Kind{"paste", 0.5f}, Kind{"fluid", 1}}) {
    add(std::string(kind.name) + ", in free flight", kind.alpha, false, {0, 0, 1});
    add(std::string(kind.name) + ", fallen", kind.alpha, true, {0, 0, 1});
  }
  add("paste, fallen, at 1e5", 0.5f, true, {1e5f, -1e5f, 1});
  return scenes;
}

DriftScene nudged(DriftScene scene) {
  constexpr float k_nudge = 1e-6f;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> component(-k_nudge, k_nudge);
  scene.body.velocities.resize(scene.body.positions.size(), Vec3::Zero());
  for (Vec3& v : scene.body.velocities)
    for (int axis = 0; axis < 3; ++axis) v[axis] += component(random);
  return scene;
}

std::vector<Snapshot> fly(const DriftScene& scene, const std::vector<int>& steps) {
  Simulation simulation(scene.config);
  for (const Collider& collider : scene.colliders) simulation.add_collider(collider);
  simulation.add_body(scene.body, scene.material);
  const auto now = [&] {
    Snapshot snapshot;
    for (const Vec3& x : simulation.positions_by_id()) snapshot.positions.push_back(x.cast<double>());
    for (const Vec3& v : simulation.velocities_by_id()) snapshot.velocities.push_back(v.cast<double>());
    return snapshot;
  };
  return record(
      steps, [&] { simulation.step(); }, now);
}

std::vector<Snapshot> fly_in_double(const DriftScene& scene, const std::vector<int>& steps) {
  textbook::Textbook textbook(scene.config);
  for (const Collider& collider : scene.colliders) textbook.add_collider(collider);
  textbook.add_body(scene.body, textbook.add_group(scene.material));
  return record(
      steps, [&] { textbook.step(); },
      [&] {
        return Snapshot{textbook.positions(), textbook.velocities()};
      });
}

double distance(const Snapshot& a, const Snapshot& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) sum += (a.positions[i] - b.positions[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.positions.size()));
}

Balance balance(const Snapshot& snapshot, const Eigen::Vector3d& from, const Eigen::Vector3d& gravity) {
  Balance sum;
  const double share = 1.0 / static_cast<double>(snapshot.positions.size());
  for (std::size_t i = 0; i < snapshot.positions.size(); ++i) {
    const Eigen::Vector3d x = snapshot.positions[i] - from, v = snapshot.velocities[i];
    sum.center += share * snapshot.positions[i];
    sum.momentum += share * v;
    sum.spin += share * x.cross(v);
    sum.speed += share * v.norm();
    sum.moment += share * x.norm() * v.norm();
    sum.energy += share * (0.5 * v.squaredNorm() - gravity.z() * snapshot.positions[i].z());
  }
  return sum;
}

}  // namespace mallow::bench
