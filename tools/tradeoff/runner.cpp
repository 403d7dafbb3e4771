#include "tradeoff/runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "mallow/errors.h"
#include "program/frame_surface.h"
#include "program/machine.h"
#include "tradeoff/surface_error.h"

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

/// What is drawn of a run.
struct Drawn {
  std::vector<Skin> skins = {};
  std::optional<program::FrameSurface> surface = {}, fine = {};
};

/// Compares surfaces in the middle of a run and at its end; outside of what is timed.
class SurfaceChecker {
 public:
  SurfaceChecker(const MotionPlan& plan, int threads, Drawn& drawn, SurfaceCheck& check)
      : moments_(std::min(plan.moments, plan.frames)), threads_(threads), drawn_(drawn), check_(check) {}

  void look(Simulation& simulation) {
    const int moment = moment_++;
    if (moment == 0 || failed_ || (moment != moments_ && moment != (moments_ + 1) / 2)) return;
    float spacing = std::numeric_limits<float>::max();
    for (const BodyId body : simulation.bodies()) spacing = std::min(spacing, simulation.spacing(body));
    try {
      const double error =
          surface_error(drawn_.surface->draw(simulation), drawn_.fine->draw(simulation), spacing, threads_);
      squares_ += error * error;
      check_.error = std::sqrt(squares_ / ++looks_);
    } catch (const Error&) {  // as where it takes more memory than it may
      failed_ = true;
      check_.error.reset();
    }
  }

 private:
  int moments_, threads_;
  Drawn& drawn_;
  SurfaceCheck& check_;
  int moment_ = 0, looks_ = 0;
  bool failed_ = false;
  double squares_ = 0;
};

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
  Drawn drawn;
  std::optional<SurfaceChecker> checker;
  if (how.drawn && how.surface) {
    checker.emplace(plan, threads_, drawn, *how.surface);
    plan.measures.emplace_back([&](Simulation& simulation) {
      checker->look(simulation);
      return 0.0;
    });
  }
  const int every = how.show ? 1 : std::max(1, std::min(plan.moments, plan.frames) / k_timed_surfaces);
  int moment = 0;
  std::vector<bool> timed;
  if (how.drawn)
    plan.draw = [&](const Simulation& simulation) {
      timed.push_back(moment++ % every == every / 2);
      if (!timed.back()) return;
      const Mesh mesh = drawn.surface->draw(simulation);
      if (how.show) how.show(simulation, mesh);
    };
  Motion motion = record_motion(
      [&] {
        Simulation simulation = build(scene, threads_);
        if (how.drawn) {
          drawn.skins = skins(scene, simulation, threads_);
          drawn.surface.emplace(scene.surface, drawn.skins, threads_);
          if (how.surface) drawn.fine.emplace(how.surface->fine, drawn.skins, threads_);
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
