// A mesh of the application's own follows a body: it keeps its vertices, and no surface is drawn around
// particles.
#include <mallow/mallow.h>
#include <mallow/skin.h>

#include <algorithm>
#include <iostream>

namespace {

/// A box with `n` x `n` squares a side and a texture coordinate for each vertex.
struct TexturedBox {
  mallow::Mesh mesh;
  std::vector<std::array<float, 2>> texture;
};

TexturedBox textured_box(const mallow::Vec3& low, float side, std::uint32_t n) {
  TexturedBox box;
  const auto part = [&](std::uint32_t k) { return static_cast<float>(k) / static_cast<float>(n); };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      const auto first = static_cast<std::uint32_t>(box.mesh.vertices.size());
      for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
          mallow::Vec3 x(high ? 1.0f : 0.0f, part(i), part(j));
          std::rotate(x.begin(), x.begin() + (3 - axis) % 3, x.end());
          box.mesh.vertices.push_back(low + side * x);
          box.texture.push_back({part(i), part(j)});
          if (i == n || j == n) continue;
          const std::uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
          const std::uint32_t c = high ? b : a + 1, d = high ? a + 1 : b;
          box.mesh.triangles.push_back({a, c, a + n + 2});
          box.mesh.triangles.push_back({a, a + n + 2, d});
        }
      }
    }
  }
  return box;
}

}  // namespace

int main() {
  mallow::Simulation simulation({.support_radius = 2.1f});
  simulation.add_collider({.shape = mallow::Plane{}, .restitution = 0.5f});
  const mallow::Body cube = sample(mallow::Lattice{.count = {10, 10, 10}, .corner = {0, 0, 6}});
  const mallow::BodyId body = simulation.add_body(cube, {.alpha = 0.1f});

  const TexturedBox box = textured_box({0, 0, 6}, 10, 20);
  mallow::Skin skin(simulation, body, box.mesh);
  for (int frame = 0; frame < 60; ++frame) {
    simulation.step();
    skin.update(
        simulation);  // vertices, normals: to the graphics card, with box.texture and box.mesh.triangles
  }
  const std::span<const float> stretch = skin.stretch();
  const float lowest =
      std::ranges::min_element(skin.mesh().vertices, {}, [](const mallow::Vec3& x) { return x.z(); })->z();
  std::cout << box.texture.size() << " vertices, the lowest at " << lowest << ", torn by "
            << *std::ranges::max_element(stretch) << " spacings at the most\n";
  return skin.mesh().vertices.size() == box.texture.size() && lowest > -0.5f ? 0 : 1;
}
