#include <mallow/mallow.h>
#include <mallow/surface.h>

#include <iostream>

int main() {
  mallow::Simulation simulation({.support_radius = 2.9f});
  simulation.add_body(sample(mallow::Lattice{.count = {8, 8, 8}, .spacing = 1.5f}), {.alpha = 0.7f});
  mallow::Surfacer surfacer({});  // keeps its memory between frames; .voxels_per_spacing, .kind, .joined, ...
  for (int frame = 0; frame < 10; ++frame) {
    simulation.step();
    const mallow::Mesh& mesh = surfacer.draw(surface_particles(simulation));  // reads particles in place
    std::cout << mesh.triangles.size() << " triangles\n";
  }
}
