#include <mallow/mallow.h>

#include <iostream>

int main() {
  mallow::Simulation simulation({.support_radius = 2.9f});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.3f});
  simulation.add_body(sample(mallow::Lattice{.count = {8, 8, 8}, .spacing = 1.5f, .corner = {0, 0, 5}}),
                      {.alpha = 0.7f});
  for (int frame = 0; frame < 100; ++frame) simulation.step();
  std::cout << "height " << simulation.positions().eigen().col(2).maxCoeff() << '\n';
}
