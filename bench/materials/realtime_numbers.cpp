#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "harness/command.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "materials/numbers.h"

namespace mallow::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t k_particles = 10'000;
constexpr int k_frames = 30;  // a second

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

void measure_realtime(int threads, const AddNumber& add) {
  Scene scene =
      read_scene(data_file("scenes/toothpaste.toml"), std::vector<std::string>{"emitter[0].stop=9.0"});
  Simulation simulation = build(scene, threads);
  Surfacer surfacer(scene.surface, threads);
  // The second in the middle of which there are so many.
  const double a_second = 29 * 60;  // particles of a layer, layers that come out
  simulation.advance(static_cast<double>(k_particles) / a_second - 0.5);
  surfacer.draw(surface_particles(simulation));
  PhaseTimes phases{};
  double taken = 0;
  double steps = 0, surfaces = 0;
  for (int frame = 0; frame < k_frames; ++frame) {
    const Clock::time_point start = Clock::now();
    const AdvanceReport report = simulation.advance(1.0 / k_frames);
    steps += since(start);
    taken += static_cast<double>(report.steps);
    for (std::size_t p = 0; p < k_phase_count; ++p) phases[p] += report.seconds[p];
    const Clock::time_point drawn = Clock::now();
    surfacer.draw(surface_particles(simulation));
    surfaces += since(drawn);
  }
  const std::string setting = std::to_string(threads) + (threads == 1 ? " thread" : " threads");
  const auto give = [&](const std::string& quantity, double value, std::optional<double> theory = {}) {
    add("a second of toothpaste", setting, {quantity, value, theory});
  };
  give("particles at the end", static_cast<double>(simulation.particle_count()));
  give("steps", taken);
  for (std::size_t p = 0; p < k_phase_count; ++p)
    give(std::string(name(static_cast<Phase>(p))) + " [s]", phases[p]);
  give("all of the steps [s]", steps);
  give("30 surfaces [s]", surfaces);
  give("all [s]", steps + surfaces, 1.0);
}

}  // namespace mallow::bench
