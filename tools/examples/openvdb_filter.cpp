// The surface as OpenVDB has it, smoothed and measured by OpenVDB's own tools.
#include <mallow/mallow.h>
#include <mallow/openvdb.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetMeasure.h>

#include <cmath>
#include <iostream>

int main() {
  openvdb::initialize();
  mallow::Simulation simulation({.support_radius = 2.0f});
  simulation.add_body(sample(mallow::sphere_shape({0, 0, 0}, 6), {.spacing = 1.0f}), {.alpha = 0.5f});
  simulation.step();

  mallow::Surfacer surfacer({});
  surfacer.draw(surface_particles(simulation));
  const openvdb::FloatGrid::Ptr grid = mallow::level_set(surfacer);
  const double rough = openvdb::tools::levelSetArea(*grid), before = openvdb::tools::levelSetVolume(*grid);

  openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*grid).gaussian(1);
  const double smooth = openvdb::tools::levelSetArea(*grid), after = openvdb::tools::levelSetVolume(*grid);

  std::cout << "area " << rough << " before and " << smooth << " after the filter, volume " << before
            << " and " << after << '\n';
  return smooth < rough && std::abs(after / before - 1) < 0.03 ? 0 : 1;
}
