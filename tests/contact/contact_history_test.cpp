// Who touches whom follows from where bodies are now: from no list of an earlier step, whatever calls have
// moved, added or taken away since.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "contact/cubes.h"

namespace mallow {
namespace contact_history_test {

using namespace contact_tests;

/// Cubes that fall into a bin and on each other.
Simulation heap() {
  Simulation s(solver(0.2f));
  const MaterialId jelly = s.add_material(material(0));
  for (int k = 0; k < 12; ++k)
    s.add_body(box({5, 5, 5}, Vec3(5.4f * static_cast<float>(k % 2) + 0.3f * static_cast<float>(k / 4),
                                   5.4f * static_cast<float>(k / 2 % 2), 5.2f * static_cast<float>(k / 4))),
               jelly);
  s.add_collider({.shape = Plane{}, .friction = 0.5f});
  s.add_collider({.shape = Box{{-0.6f, -0.6f, -5}, {11.4f, 11.4f, 100}, true}, .friction = 0.3f});
  return s;
}

/// What a program does between steps, each at a time when bodies touch.
const std::function<void(Simulation&)> k_calls[] = {
    [](Simulation&) {},
    // Onto the top of the heap, and away from all others.
    [](Simulation& s) {
      s.set_position(s.bodies()[0], {5, 5, 22});
    },
    [](Simulation& s) {
      s.set_position(s.bodies()[5], {5, 5, 60});
    },
    [](Simulation& s) {
      s.add_impulse(s.bodies()[7], {0, 0, 500});
    },
    [](Simulation& s) {
      s.add_body(box({4, 6, 3}, {3, 3, 18}), material(0));
    },
    // The rows of all that follow move up.
    [](Simulation& s) { s.remove_body(s.bodies()[2]); },
    [](Simulation& s) {
      s.remove_particles(Aabb{{-1, -1, 0}, {3, 3, 2}});
    },
    [](Simulation& s) { s.enable(s.bodies()[1], false); },
    [](Simulation& s) { s.enable(s.bodies()[1], true); },
    // The walls of the bin, at once.
    [](Simulation& s) {
      s.set_pose(ColliderId{1}, {.translation = {0.4, 0, 0}});
    },
    // Until all have fallen asleep.
    [](Simulation& s) {
      while (s.step().awake_bodies > 0 && s.time() < 400) continue;
    },
    [](Simulation& s) { s.wake(s.bodies()[3]); },
    // One falls onto sleepers, and wakes them.
    [](Simulation& s) {
      s.add_body(box({3, 3, 3}, {4, 4, 24}, {0, 0, -4}), material(0));
    },
};

TEST(contact_history, changes_no_bit_of_a_run_that_calls_interrupt_whatever_the_threads) {
  constexpr int k_threads[] = {1, 2, 3};
  Simulation whole = heap();
  run(whole, 12);
  std::vector<Simulation> parts;
  for (const int threads : k_threads) parts.push_back(Simulation::restore(whole.save(), threads));
  for (std::size_t call = 0; call < std::size(k_calls); ++call) {
    SCOPED_TRACE(call);
    k_calls[call](whole);
    for (Simulation& part : parts) k_calls[call](part);
    for (int step = 0; step < 9; ++step) {
      whole.step();
      for (std::size_t k = 0; k < parts.size(); ++k) {
        // What is restored knows of no step before.
        if (step % 3 == static_cast<int>(k)) parts[k] = Simulation::restore(parts[k].save(), k_threads[k]);
        parts[k].step();
      }
    }
    for (const Simulation& part : parts) ASSERT_EQ(part.state_hash(), whole.state_hash());
  }
}

}  // namespace contact_history_test
}  // namespace mallow
