#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr float k_yield = 0.1f;

SolverConfig solver(int threads, std::optional<int> volume_iterations = {}) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, 0},
          .update_period = 9.0f,
          .volume_iterations = volume_iterations,
          .sleep_speed = 0.0f,
          .threads = threads};
}
Material dough(float yield) {
  return {.alpha = 0.0f, .plastic_yield = yield, .damping_time = 0.1f, .deformation_damping = 0.0f};
}
std::string setting(const char* key, double value) {
  std::ostringstream text;
  text << key << ' ' << value;
  return text.str();
}
int run(Simulation& s, int steps) {
  int updates = 0;
  for (int k = 0; k < steps; ++k) updates += s.step().updated_references;
  return updates;
}

/// Strain along one axis at which |Ê − I| is this.
double uniaxial(double yield) {
  const auto size = [](double e) {
    const double along = std::pow(1 + e, 2.0 / 3) - 1, across = std::pow(1 + e, -1.0 / 3) - 1;
    return std::sqrt(along * along + 2 * across * across);
  };
  double strain = 0;
  while (size(strain) < yield) strain += 1e-6;
  return strain;
}

/// Stretch of the middle of a bar along x, least squares.
double stretch(const Simulation& s, const Body& rest) {
  const std::vector<Vec3> x = s.positions_by_id();
  double n = 0, a = 0, b = 0, aa = 0, ab = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = static_cast<double>(rest.positions[i].x()), now = static_cast<double>(x[i].x());
    if (std::abs(r - 18) > 7) continue;
    n += 1, a += r, b += now, aa += r * r, ab += r * now;
  }
  return (n * ab - a * b) / (n * aa - a * a);
}

/// A bar that is held at both ends, stretched until its middle is as long, and let go.
void pull_bar(double to, int threads, const AddNumber& add) {
  Simulation s(solver(threads));
  Material material = dough(k_yield);
  const Body bar = sample(Lattice{.count = {36, 6, 6}});
  s.add_body(bar, material);
  const PinId left = s.pin(Aabb{{-1, -9, -9}, {3, 9, 9}}, {0, 0, 0});
  const PinId right = s.pin(Aabb{{33, -9, -9}, {37, 9, 9}}, {0, 0, 0});
  for (int k = 0; k < 30 && stretch(s, bar) < to; ++k) {
    const double way = std::max(0.02, 0.9 * 30 * (to - stretch(s, bar)));
    const int steps = static_cast<int>(way / 0.003) + 1;
    s.move_pin(right, {static_cast<float>(way), 0, 0}, 0.15 * steps);
    run(s, steps);
  }
  run(s, 100);
  const double held = stretch(s, bar);
  material.deformation_damping = 2.0f;
  s.set_material(MaterialId{0}, material);
  s.unpin(left);
  s.unpin(right);
  run(s, 1500);
  add("stretched", setting("yield 0.1, to", to),
      {"set", stretch(s, bar) - 1, held / (1 + uniaxial(static_cast<double>(k_yield))) - 1});
}

/// A ball pressed 2.5 h into a block of 12³ that is held below, and lifted.
void dent(const std::string& name, const Material& material, int threads, const AddNumber& add) {
  Simulation s(solver(threads));
  const Body body = sample(Lattice{.count = {12, 12, 12}});
  s.add_body(body, material);
  s.pin(Aabb{{-1, -1, -1}, {13, 13, 1}}, {0, 0, 0});
  const ColliderId ball = s.add_collider({.shape = Sphere{{0, 0, 0}, 4.0f}, .friction = 0.3f});
  s.set_pose(ball, Pose{.translation = {6, 6, 16}});
  s.set_pose(ball, Pose{.translation = {6, 6, 13.5}}, 30);
  run(s, 300);
  s.set_pose(ball, Pose{.translation = {6, 6, 19}}, 60);
  run(s, 1200);
  const std::vector<Vec3> x = s.positions_by_id();
  double kept = 0, far = 0;
  int top = 0, low = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 rest = body.positions[i];
    const double sunk = static_cast<double>(rest.z() - x[i].z());
    if (rest.z() > 11 && std::hypot(rest.x() - 6, rest.y() - 6) < 1.2f) kept += sunk, ++top;
    if (rest.z() > 1 && rest.z() < 2) far += sunk, ++low;
  }
  add("dent of 2.5 h", name, {"kept [h]", kept / top});
  add("dent of 2.5 h", name, {"far side moved [h]", std::abs(far / low)});
}

/// A short bar that is pulled and pressed by turns, ends and all that swings beside within four fifths of its
/// yield, and let go.
void reverse_loads(int threads, const AddNumber& add) {
  constexpr int k_reversals = 10'000, k_steps = 12;
  Simulation s(solver(threads, 0));
  const Body body = sample(Lattice{.count = {8, 4, 4}, .jitter = 0});
  Material material = dough(k_yield);
  s.add_body(body, material);
  const PinId left = s.pin(Aabb{{-1, -1, -1}, {2, 5, 5}}, {0, 0, 0});
  const PinId right = s.pin(Aabb{{6, -1, -1}, {9, 5, 5}}, {0, 0, 0});
  const auto way = static_cast<float>(0.68 * uniaxial(static_cast<double>(k_yield)) * 5);
  for (int k = 0; k <= k_reversals; ++k) {
    const float by = k == 0 ? way : k % 2 == 1 ? -2 * way : 2 * way;
    s.move_pin(right, {by, 0, 0}, 0.15 * k_steps);
    run(s, k_steps);
  }
  s.unpin(left);
  s.unpin(right);
  material.deformation_damping = 2.0f;
  s.set_material(MaterialId{0}, material);
  run(s, 2000);
  const std::vector<Vec3> x = s.positions_by_id();
  float most = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    most = std::max(most, (x[i] - x[0] - (body.positions[i] - body.positions[0])).norm());
  add("10,000 loads to 0.8 of yield", setting("yield", static_cast<double>(k_yield)),
      {"largest way left of a particle [h]", static_cast<double>(most)});
}

/// A free bar that is bent and twisted so fast that it flows and gets new frames.
void pop(int threads, const AddNumber& add) {
  SolverConfig config = solver(threads, 0);
  config.update_period = 1.5f;
  Simulation s(config);
  Body body = sample(Lattice{.count = {12, 5, 5}, .corner = {-6, -2.5f, -2.5f}});
  for (const Vec3& x : body.positions)
    body.velocities.push_back(4 * Vec3(0, 0.6f * std::sin(0.3f * x.x()), 0.025f * x.x() * x.x()));
  Material material = dough(0.02f);
  material.damping_time = 0;
  s.add_body(body, material);
  s.prepare();
  double most = 0, gained = 0;
  int frames = 0;
  for (int k = 0; k < 150; ++k) {
    const Energy last = s.energy();
    if (s.step().updated_references == 0) continue;
    ++frames;
    most = std::max(most, std::abs(s.energy().kinetic / last.kinetic - 1));
    gained = std::max(gained, s.energy().conserved / last.conserved - 1);
  }
  const auto give = [&](const char* quantity, double value) {
    add("new frames of a bar that is thrown", "yield 0.02", {quantity, value});
  };
  give("new frames", frames);
  give("largest change of kinetic energy over one", most);
  give("largest gain of energy over one", gained);
}

/// Pressed to four fifths between plates and let go: the volume is that of the mean deformation.
void press(std::optional<int> iterations, int threads, const AddNumber& add) {
  Simulation s(solver(threads, iterations));
  const Body body = sample(Lattice{.count = {10, 10, 10}});
  s.add_body(body, dough(0.05f));
  s.add_collider({.shape = Plane{}});
  const ColliderId lid = s.add_collider({.shape = Plane{.normal = {0, 0, -1}}});
  s.set_pose(lid, Pose{.translation = {0, 0, 10}});
  s.set_pose(lid, Pose{.translation = {0, 0, 8}}, 30);
  run(s, 300);
  s.set_pose(lid, Pose{.translation = {0, 0, 14}}, 30);
  run(s, 600);
  const std::vector<Vec3> x = s.positions_by_id();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), rest = middle;
  for (std::size_t i = 0; i < x.size(); ++i) {
    middle += x[i].cast<double>() / static_cast<double>(x.size());
    rest += body.positions[i].cast<double>() / static_cast<double>(x.size());
  }
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero(), b = a;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector3d r = body.positions[i].cast<double>() - rest;
    a += (x[i].cast<double>() - middle) * r.transpose();
    b += r * r.transpose();
  }
  add("pressed by a fifth, let go", iterations ? "no volume iterations" : "2 volume iterations",
      {"volume", (a * b.inverse()).determinant(), 1.0});
}

/// What yields as a whole, by the paper's rule: twice the height of its centre in the end.
double fallen(float drop, int threads) {
  SolverConfig config = solver(threads, 0);
  config.gravity = {0, 0, -0.3f};
  Simulation s(config);
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_body(sample(Lattice{.count = {8, 8, 8}, .corner = {0, 0, drop}, .jitter = 0.1f}),
             {.alpha = 0.7f, .update_threshold = 6.0f});
  run(s, 600);
  double height = 0;
  for (const float z : s.positions().z()) height += 2 * static_cast<double>(z) / 512;
  return height;
}

void drop_by_the_papers_rule(int threads, const AddNumber& add) {
  const double reference = fallen(10.5f, threads);
  for (const float drop : {10.0f, 10.2f, 10.4f, 10.6f, 10.8f, 11.0f})
    add("height after a drop, by the paper's rule", setting("of 10.5 h and", static_cast<double>(drop)),
        {"height [h]", fallen(drop, threads), reference});
}

}  // namespace

void measure_yield(int threads, const AddNumber& add) {
  for (const double to : {1.3, 1.6, 2.0}) pull_bar(to, threads, add);
  Material elastic = dough(0);
  elastic.plastic_yield.reset();
  elastic.update_threshold = 1e30f;
  dent("elastic", elastic, threads, add);
  for (const float yield : {0.05f, 0.1f, 0.15f, 0.2f})
    dent(setting("yield", static_cast<double>(yield)), dough(yield), threads, add);
  reverse_loads(threads, add);
  pop(threads, add);
  for (const std::optional<int> iterations : {std::optional<int>{0}, std::optional<int>{}})
    press(iterations, threads, add);
  drop_by_the_papers_rule(threads, add);
}

}  // namespace mallow::bench
