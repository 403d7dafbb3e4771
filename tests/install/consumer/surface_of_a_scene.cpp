#include <mallow/level_set.h>
#include <mallow/scene.h>

#include <iostream>

int main(int, char** argv) {
  const mallow::Scene scene = mallow::read_scene(argv[1]);
  mallow::Simulation simulation = mallow::build(scene);
  simulation.step();
  const mallow::Mesh mesh =
      mallow::surface(simulation.positions_by_id(), simulation.info().bodies[0].spacing, scene.surface);
  std::cout << mesh.triangles.size() << " triangles\n";
}
