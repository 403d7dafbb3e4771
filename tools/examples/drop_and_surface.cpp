// A ball of jelly falls on the floor, and its surface is drawn frame by frame as a closed mesh.
#include <mallow/mallow.h>
#include <mallow/surface.h>

#include <iostream>

int main() {
  const mallow::Body ball = sample(mallow::sphere_shape({0, 0, 8}, 4), {.spacing = 1.0f});
  mallow::Simulation simulation({.support_radius = 2.0f});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.4f});
  simulation.add_body(ball, {.alpha = 0.3f});

  mallow::Surfacer surfacer({.voxels_per_spacing = 2.7f});  // it keeps its memory from frame to frame
  float lowest = 0, flattest = 8;
  for (int frame = 0; frame < 40; ++frame) {
    simulation.advance(0.3);
    const mallow::Mesh& mesh = surfacer.draw(surface_particles(simulation));
    if (!why_not_closed(mesh).empty()) return 1;
    const mallow::Aabb box = bounds(mesh);
    lowest = std::min(lowest, box.min.z());
    flattest = std::min(flattest, box.max.z() - box.min.z());
    if (frame % 10 == 0)
      std::cout << "frame " << frame << ": " << mesh.triangles.size() << " triangles from z " << box.min.z()
                << " to " << box.max.z() << '\n';
  }
  std::cout << "pressed from 8 to " << flattest << " high\n";
  return lowest > -0.1f && flattest < 7.5f ? 0 : 1;
}
