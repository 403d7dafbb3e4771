#include "tradeoff/runner.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "program/frame_surface.h"
#include "program/machine.h"

namespace mallow::tradeoff {
namespace {

constexpr int k_moments = 24;

/// One particle of each body gets so little speed that the first step moves it by its last bits.
void move_by_last_bit(Simulation& simulation) {
  simulation.prepare();
  const float step = simulation.info().longest_step;
  for (const BodyId body : simulation.bodies()) {
    const auto [begin, end] = simulation.rows(body);
    if (begin == end) continue;
    const std::size_t row = begin + (end - begin) / 2;
    const ParticleId id = simulation.ids()[row];
    Vec3 velocity = simulation.velocities()[row];
    const float x = std::max(std::abs(simulation.positions()[row].x()), simulation.spacing(body));
    velocity.x() += 2 * (std::nextafter(x, std::numeric_limits<float>::infinity()) - x) / step;
    simulation.set_velocity(std::vector<ParticleId>{id}, velocity);
  }
}

}  // namespace

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Runner::Runner(const StudyOptions& options, int frames, double frame_time)
    : options_(options), threads_(program::resolve_threads(options.threads)) {
  plan_.frames = frames;
  plan_.frame_time = frame_time;
  plan_.moments = k_moments;
}

Motion Runner::run(const Scene& scene, double deadline, bool drawn, bool last_bit) {
  MotionPlan plan = plan_;
  plan.stop = [&] {
    if (options_.stop && options_.stop()) throw Stopped{};
    return wall_clock() > deadline;
  };
  std::vector<Skin> skins;
  std::optional<program::FrameSurface> surface;
  if (drawn) plan.draw = [&](const Simulation& simulation) { surface->draw(simulation); };
  return record_motion(
      [&] {
        Simulation simulation = build(scene, threads_);
        if (drawn) {
          skins = mallow::skins(scene, simulation, threads_);
          surface.emplace(scene.surface, skins, threads_);
        }
        if (last_bit) move_by_last_bit(simulation);
        return simulation;
      },
      plan);
}

}  // namespace mallow::tradeoff
