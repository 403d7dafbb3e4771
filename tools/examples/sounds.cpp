// Sounds as a game would make them: what lands takes several steps to stop, so a blow is all that one body
// gets from a thing in steps on end. It sounds once it is over, as loud as its impulse.
#include <mallow/mallow.h>

#include <iostream>
#include <map>
#include <string>

int main() {
  mallow::Simulation simulation({.support_radius = 0.042f, .gravity = {0, 0, -9.81f}});
  simulation.add_collider({.shape = mallow::Plane{}, .restitution = 0.3f, .friction = 0.5f});
  const auto cube = [&](float x, float height, const char* name) {
    const mallow::Lattice lattice{.count = {6, 6, 6}, .spacing = 0.02f, .corner = {x, 0, height}};
    return simulation.add_body(sample(lattice), mallow::Material{.alpha = 0.2f, .particle_mass = 0.008f},
                               name);
  };
  cube(0, 0.3f, "lower");
  cube(0.03f, 0.7f, "upper");
  simulation.report_contacts(0.15);  // [N s] in a step; at rest a cube gets 0.06 from the floor

  struct Blow {
    float impulse = 0, speed = 0;
    bool goes_on = false;
  };
  std::map<std::string, Blow> blows;
  int sounds = 0;
  while (simulation.time() < 1) {
    simulation.step_towards(1);
    for (const mallow::BodyEvent& event : simulation.events()) {
      if (event.kind != mallow::BodyEvent::Kind::hit) continue;
      Blow& blow = blows[simulation.name(event.body) + " on " +
                         (event.other ? simulation.name(*event.other) : std::string("the floor"))];
      if (blow.impulse == 0) blow.speed = event.speed;
      blow.impulse += event.impulse.norm();
      blow.goes_on = true;
    }
    for (auto& [who, blow] : blows) {
      if (blow.impulse > 0 && !blow.goes_on) {
        std::cout << simulation.time() << " s: " << who << ", " << blow.speed << " m/s, " << blow.impulse
                  << " N s\n";
        ++sounds;
        blow = {};
      }
      blow.goes_on = false;
    }
  }
  return sounds >= 3 ? 0 : 1;
}
