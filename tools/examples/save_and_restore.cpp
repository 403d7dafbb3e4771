// A game saves in the middle of a fall, goes on, and later goes back: both futures are the same to the last
// bit.
#include <mallow/mallow.h>

#include <iostream>
#include <string>

int main() {
  mallow::Simulation game({.support_radius = 2.0f});
  game.add_collider({.shape = mallow::Plane{}, .friction = 0.3f});
  game.add_body(sample(mallow::Lattice{.count = {8, 8, 8}, .corner = {0, 0, 4}}), {.alpha = 0.8f});
  game.advance(5);

  mallow::SavedState saved = game.save();
  saved.chunks.push_back(
      {.name = "game.score", .bytes = "1200"});  // the application's own, kept with the rest
  game.advance(5);

  mallow::Simulation again = mallow::Simulation::restore(saved, /*threads=*/1);
  again.advance(5);

  std::cout << "time " << again.time() << " s, score " << *saved.find("game.score") << ", hashes " << std::hex
            << game.state_hash() << " and " << again.state_hash() << '\n';
  return game.state_hash() == again.state_hash() ? 0 : 1;
}
