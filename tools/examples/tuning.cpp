// How fast may a game step its jelly? It finds out while it loads: the scene is run in ever longer steps and
// compared with one in far shorter ones, and the cheapest that is near enough is taken.
#include <mallow/quality.h>
#include <mallow/tuning.h>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  // The scene of the game, in steps of `factor` times its own.
  const auto jelly = [](float factor) {
    const mallow::SolverConfig config{.gravity = {0, 0, -9.81f}, .threads = 1};
    mallow::Simulation simulation(at_time_step(config, factor));
    simulation.add_collider({.shape = mallow::Plane{}, .friction = 0.5f});
    const mallow::Lattice block{.count = {6, 6, 5}, .spacing = 0.02f, .corner = {0, 0, 0.05f}};
    simulation.add_body(sample(block),
                        mallow::Material{.alpha = 0.1f, .youngs_modulus = 5e3f, .rest_density = 1000});
    return simulation;
  };
  const mallow::MotionPlan plan{.frames = 20, .frame_time = 1 / 30.0};
  const auto run = [&](float factor) { return mallow::record_motion([&] { return jelly(factor); }, plan); };

  const mallow::Motion reference = run(0.125f);
  const std::vector<float> factors{0.5f, 1, 1.5f, 2};
  std::vector<mallow::Trade> trades;  // a frame [s], off in spacings h
  for (const float factor : factors) {
    const mallow::Motion motion = run(factor);
    const mallow::MotionError error = motion_error(motion, reference);
    trades.push_back({motion.seconds_per_frame(), motion.failure.empty() ? error.rms : NAN});
    std::cout << "steps of " << factor << ": " << 1e3 * trades.back().cost << " ms a frame, "
              << trades.back().error << " h off\n";
  }
  std::cout << "worth a look:";
  for (const std::size_t i : mallow::pareto_front(trades)) std::cout << ' ' << factors[i];
  const auto pick = mallow::pick_by_error(trades, 0.1);
  if (!pick) return 1;
  std::cout << "\ntaken: " << factors[pick->index] << (pick->holds ? "\n" : ", though it is farther off\n");
  return pick->holds && trades.front().error < trades.back().error ? 0 : 1;
}
