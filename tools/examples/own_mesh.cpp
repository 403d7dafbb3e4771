// A mesh that the application made, here a torus, becomes a body: links mallow::level_set.
#include <mallow/level_set.h>
#include <mallow/mallow.h>

#include <cmath>
#include <iostream>
#include <numbers>

namespace {

/// A ring of radius `ring` around the z axis, as thick as a tube of radius `tube`; counter-clockwise from
/// outside.
mallow::Mesh torus(float ring, float tube, std::uint32_t around = 48, std::uint32_t across = 24) {
  mallow::Mesh mesh;
  constexpr float turn = 2 * std::numbers::pi_v<float>;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const float u = turn * static_cast<float>(i) / static_cast<float>(around);
      const float v = turn * static_cast<float>(j) / static_cast<float>(across);
      const float r = ring + tube * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
      const std::uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = next_i * across + j;
      const std::uint32_t c = next_i * across + next_j, d = i * across + next_j;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

}  // namespace

int main() {
  const mallow::ImplicitShape shape =
      place(mallow::mesh_shape(torus(6, 2)), {.rotate = {90, 0, 0}, .center = mallow::Vec3{0, 0, 12}});
  const mallow::Body body = sample(shape, {.spacing = 0.5f});
  for (const std::string& note : body.notes) std::cout << "note: " << note << '\n';

  mallow::Simulation simulation({.support_radius = 1.0f});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.5f});
  simulation.add_body(body, {.alpha = 0.2f});
  simulation.advance(10);

  const float volume = 0.125f * static_cast<float>(body.positions.size());  // a cube of side 0.5 for each
  const float exact = 2 * std::numbers::pi_v<float> * std::numbers::pi_v<float> * 6 * 2 * 2;
  std::cout << "a torus of " << body.positions.size() << " particles, " << volume / exact
            << " of its volume, is now " << simulation.positions().eigen().col(2).maxCoeff() << " high\n";
  return std::abs(volume / exact - 1) < 0.05f ? 0 : 1;
}
