// The scene of cost.py from C++, a cube of so many particles along a side: prints the seconds of 100 steps,
// and the hash of the state after them.
#include <mallow/mallow.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

int main(int, char** arguments) {
  const int side = std::atoi(arguments[1]);
  mallow::Simulation simulation({.time_step = 0.15f, .support_radius = 2.9f, .threads = 1});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.3f});
  const mallow::Lattice cube{.count = {side, side, side},
                             .spacing = static_cast<float>(22.0 / 15),
                             .corner = {-11, -11, 10},
                             .jitter = 0};
  simulation.add_body(sample(cube), {.alpha = 0.3f});
  simulation.step();
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < 100; ++step) {
    simulation.step();
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  std::printf("%.9f %llu\n", seconds.count(), static_cast<unsigned long long>(simulation.state_hash()));
  return 0;
}
