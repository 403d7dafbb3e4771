// A table for games: bodies are thrown on it, rest and sleep, are picked by a ray and taken away, and what
// leaned on them wakes.
#include <mallow/mallow.h>

#include <iostream>

int main() {
  mallow::Simulation simulation({.time_step = 0.15f, .support_radius = 2.1f});
  const mallow::MaterialId jelly = simulation.add_material({.alpha = 0.1f});
  simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.5f});
  simulation.add_sink({{-50, -50, -10}, {50, 50, 100}}, true);  // what leaves the table is gone

  const auto cube = [&](const mallow::Vec3& corner) {
    return simulation.add_body(sample(mallow::Lattice{.count = {5, 5, 5}, .corner = corner}), jelly);
  };
  const mallow::BodyId lower = cube({0, 0, 0}), upper = cube({0, 0, 5.2f});
  simulation.set_user_data(upper, 42);

  int slept = 0, woke = 0;
  const auto play = [&](double seconds) {
    const double end = simulation.time() + seconds;
    while (simulation.time() < end) {
      simulation.step_towards(end);
      for (const mallow::BodyEvent& event : simulation.events()) {
        slept += event.kind == mallow::BodyEvent::Kind::slept;
        woke += event.kind == mallow::BodyEvent::Kind::woke;
      }
    }
  };
  play(120);
  std::cout << slept << " bodies sleep, and steps cost nothing\n";

  const auto picked = simulation.raycast({2.5f, 2.5f, 50}, {0, 0, -1});
  if (!picked || picked->body != upper || simulation.user_data(picked->body) != 42) return 1;
  simulation.add_impulse(picked->position, 3, {0, 0, 60});
  play(30);
  std::cout << woke << " bodies woke when one was pulled\n";

  simulation.remove_body(lower);
  play(30);
  std::cout << "the upper one lies at " << simulation.motion(upper).center_of_mass.z() << ", "
            << simulation.body_count() << " body is left\n";
  return slept >= 2 && woke >= 2 && simulation.motion(upper).center_of_mass.z() < 4 ? 0 : 1;
}
