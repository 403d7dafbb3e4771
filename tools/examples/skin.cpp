#include <mallow/mallow.h>
#include <mallow/skin.h>

#include <iostream>

int main() {
  mallow::Simulation simulation({.support_radius = 2.1f});
  simulation.add_collider({.shape = mallow::Plane{}, .restitution = 0.5f});
  const mallow::Body cube = sample(mallow::Lattice{.count = {10, 10, 10}, .corner = {0, 0, 6}});
  const mallow::BodyId body = simulation.add_body(cube, {.alpha = 0.1f});

  mallow::Mesh mesh;  // your own; here the top of the cube
  mesh.vertices = {{0, 0, 16}, {10, 0, 16}, {10, 10, 16}, {0, 10, 16}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mallow::Skin skin(simulation, body, mesh);
  for (int frame = 0; frame < 60; ++frame) {
    simulation.step();
    const mallow::Mesh& drawn = skin.update(simulation);  // your vertices in your order, with normals
    std::cout << "height " << drawn.vertices[0].z() << '\n';
  }
}
