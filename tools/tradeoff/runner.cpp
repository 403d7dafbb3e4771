#include "tradeoff/runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "program/frame_surface.h"
#include "program/machine.h"

namespace mallow::tradeoff {
namespace {

constexpr int k_moments = 24;
constexpr int k_timed_surfaces = 8;  ///< of a run: all of them would take the time of other settings

/// The one in the middle of its body that no nozzle holds: what is held moves as the nozzle says.
std::optional<std::size_t> free_row(const Simulation& simulation, BodyId body) {
  std::set<ParticleId> held;
  for (const EmitterId emitter : simulation.emitter_ids()) {
    const std::vector<ParticleId> ids = simulation.held(emitter);
    held.insert(ids.begin(), ids.end());
  }
  const auto [begin, end] = simulation.rows(body);
  const std::size_t middle = begin + (end - begin) / 2;
  for (std::size_t k = 0; k < end - begin; ++k) {
    const std::size_t row = middle + k < end ? middle + k : begin + (middle + k - end);
    if (!held.contains(simulation.ids()[row])) return row;
  }
  return std::nullopt;
}

}  // namespace

/// It gets so little speed that the next step moves it by its last bits.
void LastBit::move(Simulation& simulation) {
  const float step = simulation.info().longest_step;
  for (const BodyId body : simulation.bodies()) {
    if (moved_.contains(body)) continue;
    const std::optional<std::size_t> row = free_row(simulation, body);
    if (!row) continue;
    const ParticleId id = simulation.ids()[*row];
    Vec3 velocity = simulation.velocities()[*row];
    const float x = std::max(std::abs(simulation.positions()[*row].x()), simulation.spacing(body));
    velocity.x() += 2 * (std::nextafter(x, std::numeric_limits<float>::infinity()) - x) / step;
    simulation.set_velocity(std::vector<ParticleId>{id}, velocity);
    moved_.insert(body);
    if (!begin_) begin_ = simulation.time();
  }
}

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Runner::Runner(const StudyOptions& options, int frames, double frame_time)
    : options_(options), threads_(program::resolve_threads(options.threads)) {
  plan_.frames = frames;
  plan_.frame_time = frame_time;
  plan_.moments = k_moments;
}

Motion Runner::run(const Scene& scene, const RunHow& how) {
  MotionPlan plan = plan_;
  std::optional<double> built;
  plan.stop = [&] {
    if (options_.stop && options_.stop()) throw Stopped{};
    const double now = wall_clock();
    if (!built) built = now;
    return now > how.deadline || now - *built > how.running;
  };
  // Measures are taken at every moment, the begin too, and may change what they measure.
  if (how.last_bit)
    plan.measures.emplace_back([&](Simulation& simulation) {
      how.last_bit->move(simulation);
      return 0.0;
    });
  std::vector<Skin> skins;
  std::optional<program::FrameSurface> surface;
  const int every = how.show ? 1 : std::max(1, std::min(plan.moments, plan.frames) / k_timed_surfaces);
  int moment = 0;
  std::vector<bool> timed;
  if (how.drawn)
    plan.draw = [&](const Simulation& simulation) {
      timed.push_back(moment++ % every == every / 2);
      if (!timed.back()) return;
      const Mesh mesh = surface->draw(simulation);
      if (how.show) how.show(simulation, mesh);
    };
  Motion motion = record_motion(
      [&] {
        Simulation simulation = build(scene, threads_);
        if (how.drawn) {
          skins = mallow::skins(scene, simulation, threads_);
          surface.emplace(scene.surface, skins, threads_);
        }
        return simulation;
      },
      plan);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < motion.draw_seconds.size(); ++k)
    if (timed[k]) motion.draw_seconds[kept++] = motion.draw_seconds[k];
  motion.draw_seconds.resize(kept);
  return motion;
}

}  // namespace mallow::tradeoff
