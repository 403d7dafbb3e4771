// A bar of set chocolate with a melted filling and a stiff crust stands on a plate. The plate turns hot, and
// the bar melts from below; it turns cold, and what has melted sets as it lies.
#include <mallow/mallow.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace {

/// Share of the particles that have melted.
double melted(const mallow::Simulation& simulation, float liquidus) {
  const auto kelvins = simulation.temperatures();
  const auto hot =
      std::count_if(kelvins.begin(), kelvins.end(), [&](float kelvin) { return kelvin > liquidus; });
  return static_cast<double>(hot) / static_cast<double>(kelvins.size());
}

double height(const mallow::Simulation& simulation) {
  return static_cast<double>(simulation.positions().eigen().col(2).maxCoeff());
}

}  // namespace

int main() {
  mallow::Simulation simulation({.gravity = {0, 0, -9.81f}});
  const mallow::ColliderId plate = simulation.add_collider({.shape = mallow::Plane{}, .temperature = 290.0f});

  // A material by name; heat goes 300 times as fast as it does, so that seconds show what takes minutes.
  mallow::Material chocolate = mallow::materials::chocolate();
  chocolate.conductivity *= 300;
  const float liquidus = *chocolate.liquidus;

  // What each particle has of its own: here its temperature, which says whether it is melted, and a factor on
  // its modulus.
  mallow::Body bar =
      sample(mallow::Lattice{.count = {10, 6, 8}, .spacing = 0.005f, .corner = {0, 0, 0.0025f}});
  const mallow::Vec3 center{0.0225f, 0.0125f, 0.02f};
  for (const mallow::Vec3& position : bar.positions) {
    const float distance = (position - center).norm();
    bar.temperature.push_back(distance < 0.01f ? 310.0f : 290.0f);
    bar.stiffness.push_back(distance > 0.02f ? 1.5f : 1.0f);
  }
  const mallow::BodyId body = simulation.add_body(bar, chocolate);

  const double filling = melted(simulation, liquidus), before = height(simulation);
  simulation.set_temperature(plate, 370.0f);
  simulation.advance(4);
  const double hot = melted(simulation, liquidus), low = height(simulation), heat = simulation.heat(body);
  std::printf("melted: %.2f at first, %.2f on the hot plate; %.0f and %.0f mm high\n", filling, hot,
              1000 * before, 1000 * low);

  simulation.set_temperature(plate, 270.0f);
  simulation.advance(1.5);
  const double cold = melted(simulation, liquidus);
  std::printf("%.2f on the cold plate, which took %.0f J\n", cold, heat - simulation.heat(body));
  return filling > 0 && hot > 2 * filling && low < 0.9 * before && cold < hot && simulation.heat(body) < heat
             ? 0
             : 1;
}
