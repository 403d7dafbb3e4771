// A heap of jelly cubes that fall one layer after the other: bodies may be added while a simulation runs.
#include <mallow/mallow.h>

#include <algorithm>
#include <iostream>

int main() {
  mallow::Simulation simulation({.support_radius = 2.9f});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.5f});
  simulation.add_collider({.shape = mallow::Box{{-8, -8, 0}, {8, 8, 200}, true}, .friction = 0.5f});

  int layers = 0;
  for (int frame = 0; frame < 400; ++frame) {
    if (frame % 50 == 0 && frame < 200) {  // four more fall from the same height
      for (const float x : {-4.0f, 4.0f})
        for (const float y : {-4.0f, 4.0f})
          simulation.add_body(
              sample(mallow::Lattice{.count = {3, 3, 3}, .spacing = 1.5f, .corner = {x - 2, y - 2, 30}}),
              {.alpha = 0.1f});
      ++layers;
    }
    simulation.advance(0.15);
  }

  const auto heights = simulation.positions().z();
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  std::cout << 4 * layers << " cubes of " << simulation.particle_count() << " particles lie between heights "
            << *low << " and " << *high << '\n';
  return *low > 0 && *high < 25 ? 0 : 1;
}
