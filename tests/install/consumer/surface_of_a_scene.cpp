#include <mallow/openvdb.h>
#include <mallow/scene.h>

#include <iostream>

int main(int, char** argv) {
  const mallow::Scene scene = mallow::read_scene(argv[1]);
  mallow::Simulation simulation = mallow::build(scene);
  simulation.step();
  mallow::Surfacer surfacer(scene.surface);
  const mallow::Mesh& mesh = surfacer.draw(surface_particles(simulation));
  const openvdb::FloatGrid::Ptr grid = mallow::level_set(surfacer);
  std::cout << mesh.triangles.size() << " triangles, " << grid->activeVoxelCount() << " voxels\n";
}
