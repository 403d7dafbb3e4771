// Settings that nobody means: of what comes and goes, and of what acts on nothing.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "colliders/pose.h"
#include "colliders/ways.h"
#include "config/gravity_units.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/warning_list.h"

namespace mallow {
namespace {

/// Nobody means a share of the spacing that is as small as this.
constexpr float k_rounding_depth = 0.01f;

/// Spacings that nothing is meant to go in a step: 27 m/s at 5 mm.
constexpr double k_far_step = 10;

/// A layer of an emitter has this area to this share.
constexpr double k_same_area = 0.15;

class SourceWarnings {
 public:
  explicit SourceWarnings(const Simulation::State& state)
      : state_(state), needs_sph_(state.needs_sph()), keeps_volume_(state.keeps_volume()) {}

  std::vector<std::string> list() && {
    if (state_.step == 0) {
      for (const EmitterState& emitter : state_.emitters) look_at_mouth(emitter);
      for (std::size_t k = 0; k < state_.sinks.size(); ++k) look_at_sink(k);
    }
    for (const BodyState& body : state_.bodies) {
      look_at_modulus(body);
      look_at_parts(body);
    }
    for (std::size_t c = 0; c < state_.colliders.size(); ++c) look_at_speed(c);
    look_at_formulation();
    look_at_arithmetic();
    return list_.take();
  }

 private:
  /// Where the first layer will be when it leaves.
  void look_at_mouth(const EmitterState& emitter) {
    if (emitter.held.empty()) return;
    const Emitter& settings = emitter.settings;
    const std::vector<ParticleId>& layer = emitter.held.front();
    const std::string& name = state_.body(emitter.body).name;
    if (layer.size() == 1 && settings.points.empty())
      list_.add("body '", name, "': layers of its emitter are one particle each, as ",
                settings.radius ? "radius " : "width ", settings.radius ? *settings.radius : *settings.width,
                " is too small for a spacing of ", settings.spacing,
                ": a line of particles; give a smaller spacing, or a wider emitter");
    look_at_area(name, settings, layer.size());
    const Vec3 ahead = 0.5f * settings.spacing * rotation_of(settings.pose).col(2).cast<float>();
    for (std::size_t c = 0; c < state_.colliders.size(); ++c) {
      const auto is_inside = [&](ParticleId id) {
        const Vec3 x = state_.far(state_.store.position.get(*state_.store.slots.find(id))) + ahead;
        return nearest(state_.colliders[c], x).distance < -k_rounding_depth * settings.spacing;
      };
      if (const auto inside = std::ranges::count_if(layer, is_inside); inside > 0)
        list_.add("body '", name, "': ", inside, " of ", layer.size(),
                  " particles of a layer leave its emitter inside ", "collider ", c,
                  ", which drives them out; move one of the two");
    }
  }

  /// A layer of few particles has another area than its mouth.
  void look_at_area(const std::string& name, const Emitter& settings, std::size_t count) {
    if (!settings.points.empty() || count < 2) return;
    const double h = static_cast<double>(settings.spacing), cells = static_cast<double>(count);
    const double area = settings.radius
                            ? std::numbers::pi * std::pow(static_cast<double>(*settings.radius), 2)
                            : static_cast<double>(*settings.width) * static_cast<double>(*settings.height);
    const double share = cells * h * h / area;
    if (std::abs(share - 1) <= k_same_area) return;
    list_.add("body '", name, "': layers of its emitter have ", count, " particles, ",
              std::round(100 * std::abs(share - 1)), share > 1 ? "% more" : "% less",
              " than fit its mouth, and so much is poured; give a finer spacing, or a mouth of the area of ",
              count, " cells, ", cells * h * h);
  }

  void look_at_sink(std::size_t number) {
    const SinkState& sink = state_.sinks[number];
    const ParticleStore& store = state_.store;
    std::size_t free = 0;
    for (std::size_t row = 0; row < store.size(); ++row) {
      if (!store.pin.empty() && store.pin[row] != 0) continue;
      if ((state_.far(store.position.get(row)).array() >= sink.box.min.array() &&
           state_.far(store.position.get(row)).array() <= sink.box.max.array())
              .all() == sink.outside)
        return;
      ++free;
    }
    if (free > 0)
      list_.add("sink ", number, ": all ", free, " particles that are not held are ",
                sink.outside ? "outside" : "inside", " its box at the start, and are removed at once",
                sink.outside ? "; give a larger box" : "; with outside = true it takes what leaves the box");
  }

  /// A turn in degrees a second, or a way in millimetres: what it meets is torn away in one step.
  void look_at_speed(std::size_t number) {
    const double speed = greatest_corner_speed(state_.colliders[number]);
    const double way = speed * static_cast<double>(state_.longest_step());
    const double spacing = static_cast<double>(state_.scale.spacing);
    if (spacing == 0 || way <= k_far_step * spacing) return;
    const char* const unit = unit_of(state_.config.gravity, " m/s");
    const bool keyed = !state_.colliders[number].keyframes.empty();  // which drive angular_velocity
    list_.add("collider ", number, ": a part of it moves at ", speed, unit, ", ", std::round(way / spacing),
              " spacings in a step of ", state_.longest_step(), " s, and what it meets is flung away; ",
              keyed || state_.colliders[number].angular_velocity.isZero(0)
                  ? "let it take longer for its way, or lead it a shorter one"
                  : "angular_velocity is in rad/s, and a turn a second is 6.283",
              "; or give a shorter solver.time_step");
  }

  void look_at_modulus(const BodyState& body) {
    if (body.material->settings.youngs_modulus && !body.keeps_reference())
      list_.add(body, "youngs_modulus ", *body.material->settings.youngs_modulus,
                " has no effect where alpha is 1: a fluid springs back to no shape; lower alpha");
  }

  void look_at_parts(const BodyState& body) {
    const bool may_be_several = body.shape.built && (body.shape.flows || body.apart);
    if (!may_be_several || body.most_alpha() > 0 || keeps_volume_) return;
    Parts parts;
    find_parts(body.shape, parts);
    if (parts.count > 1)
      list_.add(
          body, "its ", parts.count,
          " parts pass through each other where alpha is 0, as nothing acts between parts of a body; make "
          "them bodies of their own (splits = true does it where a body is torn, split() now), or give "
          "alpha, "
          "or volume_iterations");
  }

  void look_at_formulation() {
    if (state_.config.formulation == Formulation::conservative || state_.bodies.empty()) return;
    const auto flows = [](const BodyState& body) {
      return body.paints_alpha || body.material->settings.alpha.highest() > 0;
    };
    if (std::ranges::none_of(state_.bodies, flows) && !needs_sph_)
      list_.add(
          "solver.formulation = \"printed\" has no effect where alpha is 0: it is of the accelerations that "
          "alpha blends in");
  }

  void look_at_arithmetic() {
    if (state_.config.arithmetic == Arithmetic::exact || state_.bodies.empty()) return;
    const InstructionLevel level = state_.execution.level;
    if (!needs_sph_ && !keeps_volume_)
      list_.add(
          "solver.arithmetic = \"native\" has no effect: it is of sums of SPH and of volume iterations, and "
          "there are none where alpha is 0");
    else if (level == InstructionLevel::baseline)
      list_.add("solver.arithmetic = \"native\" has no effect: at instruction level ", name(level),
                " there are no fused multiply-adds, and sums are exact");
  }

  const Simulation::State& state_;
  const bool needs_sph_, keeps_volume_;  ///< asked once, not for each body
  WarningList list_;
};

}  // namespace

std::vector<std::string> source_warnings(const Simulation::State& state) {
  return SourceWarnings(state).list();
}

}  // namespace mallow
