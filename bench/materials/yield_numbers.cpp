#include <cmath>
#include <sstream>
#include <vector>

#include "mallow/simulation.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

constexpr float k_yield = 0.1f;

SolverConfig solver(int threads) {
  return {.time_step = 0.15f,
          .support_radius = 2.1f,
          .gravity = {0, 0, 0},
          .update_period = 9.0f,
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
void run(Simulation& s, int steps) {
  for (int k = 0; k < steps; ++k) s.step();
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

}  // namespace

void measure_yield(int threads, const AddNumber& add) {
  for (const double to : {1.3, 1.6, 2.0}) pull_bar(to, threads, add);
  Material elastic = dough(0);
  elastic.plastic_yield.reset();
  elastic.update_threshold = 1e30f;
  dent("elastic", elastic, threads, add);
  for (const float yield : {0.05f, 0.1f, 0.15f, 0.2f})
    dent(setting("yield", static_cast<double>(yield)), dough(yield), threads, add);
}

}  // namespace mallow::bench
