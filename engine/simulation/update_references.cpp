// Reference shapes that give way: by the paper's rule, or where regions have flowed.
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "shape_matching/reshape.h"
#include "simulation/damage.h"
#include "simulation/membership.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {

void take_reference(Simulation::State& state, BodyState& body) {
  PillarOrder& pillars = state.region_scratch.pillars;
  body.shape.spacing = body.spacing;
  update_reference(state.store.position, body.begin, body.end, state.execution.threads, state.region_scratch,
                   body.shape);
  sort_reference(state.execution, pillars, body.shape);
  state.store.permute(body.begin, pillars.order.span(), state.execution.threads);
  state.rows_moved();
  state.held = false;
}

/// Velocities are those of half a step ago. What the old shape pulled since then goes into them before it is
/// gone: then an update takes energy and never gives any. Without, a body that yields every few steps and is
/// as stiff as its step gained energy at each update that met it swinging back.
void kick_by_pull(Simulation::State& state, BodyState& body, float share) {
  MatchedBodies matched;
  weigh_regions(state.execution.threads, state.store, body);
  matched.add(body.shape, body.begin);
  match_shapes(state.store.position, state.config.rotation_iterations, state.execution, matched);
  const float kick = share * static_cast<float>(state.last_time_step) * state.stiffness(body);
  ParticleStore& store = state.store;
  parallel_for(state.execution.threads, body.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t row = body.begin + i;
      if (!store.pin.empty() && store.pin[row] != 0) continue;
      store.velocity.set(row, store.velocity.get(row) + kick * body.shape.pull.get(i));
    }
  });
}

void take_frame(Simulation::State& state, BodyState& body, CarriedRegions& carried) {
  take_reference(state, body);
  const std::span<const std::uint32_t> order = state.region_scratch.pillars.order.span();
  sort_parts(order, state.parts_before);
  sort_carried(order, carried);
  build_carried(carried, state.execution, state.region_scratch, body.shape);
}

namespace {

FlowRule flow_rule(const Material& material) {
  return {.yield = material.plastic_yield.value_or(0.0f),
          .creep = material.plastic_creep.value_or(std::numeric_limits<float>::infinity())};
}

/// What the step that begins now looks for.
struct Looks {
  bool check, tears;
};

bool frame_is_due(Simulation::State& state, const BodyState& body, const Looks& looks) {
  const Material& material = body.material->settings;
  const FrameLimits limits{material.merge_flow, material.tear_strain, looks.check ? 0.0f : k_torn_flow};
  const VectorColumn& x = state.store.position;
  FlowScratch& scratch = state.region_scratch.flow;
  return (looks.check && reframe_is_due(x, body.begin, limits, state.execution, body.shape, scratch)) ||
         (looks.tears && is_torn(x, body.begin, limits, state.execution, body.shape, scratch));
}

/// What the regions of a body take along into a new frame, where it gets one now: where one is due and no
/// blow strains it, or where it has flowed too far to wait.
std::optional<CarriedRegions> new_frame(Simulation::State& state, BodyState& body, const Looks& looks) {
  if (!body.flows()) return {};
  const bool far = has_flowed_too_far(body.shape);
  if (!far && !frame_is_due(state, body, looks)) return {};
  check_damage(state);
  ReframedShape found =
      reframe_regions(state.store.position, body.begin, flow_rule(body.material->settings).yield,
                      state.config.rotation_iterations, state.execution, body.shape);
  if (!far && found.is_strained) return {};
  return std::move(found.carried);
}

/// What became of the parts of a body, whose regions are built anew.
void tell_parts(Simulation::State& state, const BodyState& body) {
  Parts &before = state.parts_before, &after = state.parts_after;
  const auto tell = [&](BodyEvent::Kind kind) {
    state.events.push_back({.kind = kind, .body = body.id, .parts = after.count, .crumbs = after.crumbs});
  };
  if (any_in_two(before, after)) tell(BodyEvent::Kind::torn);
  if (any_in_two(after, before)) tell(BodyEvent::Kind::merged);
}

/// Whether a body that has yielded is still in one part: then it comes to rest as one. Nobody has followed
/// its rigid motion while it was not.
void judge_parts(Simulation::State& state, BodyState& body, bool was_apart) {
  body.apart = state.parts_after.count != 1;
  if (was_apart && !body.apart) measure_rigid(state, body);
}

}  // namespace

int update_references(Simulation::State& state) {
  int updated = 0;
  const bool check = update_is_due(state);
  const Looks looks{.check = check, .tears = check || tear_look_is_due(state)};
  for (BodyState* moving : state.awake) {
    BodyState& body = *moving;
    const double threshold =
        static_cast<double>(body.material->update_threshold * (1.0f - body.most_alpha()));
    const bool yields = check && body.follows_threshold() && body.judged_external > threshold;
    std::optional<CarriedRegions> frame = yields ? std::nullopt : new_frame(state, body, looks);
    const bool reframes = frame.has_value();
    const bool had_regions = body.matches_shape() && body.shape.built, was_apart = body.apart;
    const auto due = [&] { return body.matches_shape() && !body.shape.built; };
    // A reference shape outlives the step: nothing that is not finite may get into it.
    if (yields || due()) check_damage(state);
    if (yields || reframes) {
      if (had_regions) find_parts(body.shape, state.parts_before);
      if (reframes) {
        take_frame(state, body, *frame);
      } else if (!had_regions || !update_part(state, body)) {
        if (had_regions) kick_by_pull(state, body, 0.5f);
        take_reference(state, body);
        if (had_regions) sort_parts(state.region_scratch.pillars.order.span(), state.parts_before);
      }
      body.apart = true;
      state.events.push_back({BodyEvent::Kind::yielded, body.id});
      ++updated;
    }
    const bool builds = due();
    if (builds) build_regions(state.execution, state.region_scratch, body.shape);
    if (!body.apart || !(yields || reframes || builds) || !body.shape.built) continue;
    find_parts(body.shape, state.parts_after);
    keep_parts(state.parts_after, body.shape);
    judge_parts(state, body, was_apart);
    if ((yields || reframes) && had_regions) tell_parts(state, body);
  }
  state.matched.clear();
  for (BodyState* body : state.awake)
    if (body->matches_shape())
      state.matched.add(body->shape, body->begin, flow_rule(body->material->settings));
  return updated;
}

}  // namespace mallow
