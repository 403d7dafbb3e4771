// Bodies that are pressed into each other become one, as two sides of one body do. [model 2, section 5]
#include <algorithm>
#include <numeric>

#include "core/bounds.h"
#include "shape_matching/reshape.h"
#include "simulation/damage.h"
#include "simulation/membership.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

bool may_join(const BodyState& body) {
  return body.merges && body.moves() && body.flows();
}

/// Those that may become one with another of their group, which share its material and spacing.
void list_bodies(const Simulation::State& s, Pressed& pressed) {
  pressed.bodies.clear();
  for (std::uint32_t b = 0; b < s.bodies.size(); ++b)
    if (may_join(s.bodies[b])) pressed.bodies.push_back(b);
  std::ranges::sort(pressed.bodies, [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t group = s.bodies[a].merge_group, other = s.bodies[b].merge_group;
    return group != other ? group < other : a < b;
  });
}

/// What has flowed of some bodies, as far as it is near what has of another one.
void list_parts(const Simulation::State& s, std::span<const std::uint32_t> bodies,
                Column<std::uint32_t>& which, Pressed& pressed) {
  pressed.parts.clear();
  pressed.rows.clear();
  for (const std::uint32_t b : bodies) {
    const BodyState& body = s.bodies[b];
    list_flowed(body.material->settings.merge_flow, body.shape, which);
    Pressed::Part part{b, pressed.rows.size(), pressed.rows.size() + which.size(), empty_box()};
    for (const std::uint32_t i : which) {
      const std::size_t row = body.begin + i;
      pressed.rows.push_back(static_cast<std::uint32_t>(row));
      part.box = box_around(part.box, box_around(s.store.position, row, row + 1));
    }
    if (!which.empty()) pressed.parts.push_back(part);
  }
  pressed.boxes.clear();
  for (const Pressed::Part& part : pressed.parts) pressed.boxes.push_back(part.box);
  pressed.tree.build(pressed.boxes);
}

bool is_near_another(const Pressed& pressed, const Pressed::Part& part, float reach) {
  // Twice as far, so that no rounding leaves one out.
  const Vec3 around = Vec3::Constant(2 * reach);
  bool found = false;
  pressed.tree.for_overlapping({part.box.min - around, part.box.max + around}, [&](std::uint32_t k) {
    const Pressed::Part& other = pressed.parts[k];
    found = found || (other.body != part.body && are_near(part.box, other.box, reach));
  });
  return found;
}

/// In spacings: contact holds two sides a spacing apart, but for what its iterations leave.
constexpr float k_pressed = 1.1f;

/// Joins the sets of those bodies of a group whose particles are nearer than that where both have flowed.
void find_pressed(Simulation::State& s, std::span<const std::uint32_t> bodies) {
  Pressed& pressed = s.pressed;
  FlowScratch& flow = s.region_scratch.flow;
  list_parts(s, bodies, flow.which, pressed);
  const float reach = k_pressed * s.bodies[bodies.front()].spacing;
  pressed.owner.clear();
  flow.here.resize_unset(pressed.rows.size());
  for (const Pressed::Part& part : pressed.parts) {
    if (!is_near_another(pressed, part, reach)) continue;
    for (std::size_t k = part.begin; k < part.end; ++k) {
      flow.here.set(pressed.owner.size(), s.store.position.get(pressed.rows[k]));
      pressed.owner.push_back(part.body);
    }
  }
  if (pressed.owner.empty()) return;
  build_cell_grid(flow.here, 0, pressed.owner.size(), reach, s.execution, flow.grid);
  build_neighbor_lists(flow.grid, reach, s.execution, flow.lists);
  for (std::size_t k = 0; k < pressed.owner.size(); ++k)
    for (const std::uint32_t other : flow.lists.of(k))
      pressed.sets.join(pressed.owner[flow.grid.order[k]], pressed.owner[flow.grid.order[other]]);
}

/// Bodies that are to be one, first the one that stays.
std::vector<std::vector<BodyId>> list_sets(Simulation::State& s) {
  std::vector<std::vector<BodyId>> of_root(s.bodies.size());
  for (std::uint32_t b = 0; b < s.bodies.size(); ++b)
    of_root[s.pressed.sets.root(b)].push_back(s.bodies[b].id);
  std::erase_if(of_root, [](const std::vector<BodyId>& ids) { return ids.size() < 2; });
  return of_root;
}

/// Moves the rows of a body to right behind those of one before it, which gets them.
void give_rows(Simulation::State& s, BodyState& body, const BodyState& from) {
  const std::size_t begin = body.end, count = from.size(), between = from.begin - body.end;
  std::vector<std::uint32_t> order(count + between);
  std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
            static_cast<std::uint32_t>(between));
  std::iota(order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), 0u);
  if (between > 0) s.store.permute(begin, order, s.execution.threads);
  for (std::size_t b = s.place_of(body) + 1; &s.bodies[b] != &from; ++b) {
    s.bodies[b].begin += count;
    s.bodies[b].end += count;
  }
  body.end += count;
}

/// Contacts go on as those of the body that stays.
void give_contacts(Simulation::State& s, std::uint64_t id, std::uint64_t to) {
  std::vector<Contacts::Lasting>& lasting = s.contacts.lasting;
  for (Contacts::Lasting& contact : lasting) {
    ContactKey& key = contact.key;
    if (key.body == id) key.body = to;
    if (!key.of_bodies) continue;
    if (key.other == id) key.other = to;
    if (key.other < key.body) std::swap(key.body, key.other);
  }
  std::erase_if(lasting, [](const Contacts::Lasting& one) {
    return one.key.of_bodies && one.key.body == one.key.other;
  });
  std::ranges::sort(lasting, [](const Contacts::Lasting& a, const Contacts::Lasting& b) {
    return a.key != b.key ? a.key < b.key : a.apart < b.apart;
  });
  const auto same = [](const Contacts::Lasting& a, const Contacts::Lasting& b) { return a.key == b.key; };
  lasting.erase(std::unique(lasting.begin(), lasting.end(), same), lasting.end());
}

/// Whatever speaks of a body speaks of the one that it is part of now.
void give_names(Simulation::State& s, BodyId id, BodyId to) {
  for (EmitterState& emitter : s.emitters)
    if (emitter.body == id) emitter.body = to;
  for (EndedBody& ended : s.ended)
    if (ended.part_of == id) ended.part_of = to;
  // Of each slot the last one is enough, and a run that lasts has no list that grows for ever.
  std::erase_if(s.ended, [&](const EndedBody& ended) { return slot_of(BodyId{ended.id}) == slot_of(id); });
  s.ended.push_back({static_cast<std::uint64_t>(id), to});
  give_contacts(s, static_cast<std::uint64_t>(id), static_cast<std::uint64_t>(to));
}

/// What a body is told by and judged by, beside what its particles take along.
void take_over(BodyState& body, const BodyState& from) {
  if (from.hit_impulse)
    body.hit_impulse = std::min(*from.hit_impulse, body.hit_impulse.value_or(*from.hit_impulse));
  body.judged_external = std::max(body.judged_external, from.judged_external);
  body.recent_external.clear();
  body.slow_time = 0;
}

/// What regions carry along into a frame where their particles are now.
CarriedRegions leave_frame(Simulation::State& s, BodyState& body) {
  weigh_regions(s.execution.threads, s.store, body);
  return reframe_regions(s.store.position, body.begin, body.material->settings.plastic_yield.value_or(0.0f),
                         s.config.rotation_iterations, s.execution, body.shape)
      .carried;
}

/// The first of these takes the others.
void join_into_first(Simulation::State& s, std::span<const BodyId> ids) {
  BodyState& body = s.body(ids.front());
  CarriedRegions carried = leave_frame(s, body);
  find_parts(body.shape, s.parts_before);
  std::vector<BodyState*> joined;
  for (const BodyId id : ids.subspan(1)) {
    BodyState& other = s.body(id);
    append_carried(leave_frame(s, other), carried);
    find_parts(other.shape, s.parts_after);
    append_parts(s.parts_after, s.parts_before);
    paint_alike(s, body, other);
    give_rows(s, body, other);
    take_over(body, other);
    give_names(s, id, body.id);
    joined.push_back(&other);
  }
  forget_bodies(s, joined);
  s.rows_changed();
  take_frame(s, body, carried);
  find_parts(body.shape, s.parts_after);
  body.apart = s.parts_after.count != 1;
  measure_rigid(s, body);
  const auto tell = [&](BodyEvent event) { s.next_events.push_back(event); };
  tell({.kind = BodyEvent::Kind::yielded, .body = body.id});
  const std::size_t parts = s.parts_after.count, crumbs = s.parts_after.crumbs;
  if (any_in_two(s.parts_before, s.parts_after))
    tell({.kind = BodyEvent::Kind::torn, .body = body.id, .parts = parts, .crumbs = crumbs});
  for (const BodyId id : ids.subspan(1))
    tell({.kind = BodyEvent::Kind::merged, .body = body.id, .parts = parts, .crumbs = crumbs, .other = id});
}

}  // namespace

int join_bodies(Simulation::State& s) {
  if (!update_is_due(s)) return 0;
  Pressed& pressed = s.pressed;
  list_bodies(s, pressed);
  if (pressed.bodies.size() < 2) return 0;
  pressed.sets.reset(s.bodies.size());
  const std::span<const std::uint32_t> bodies = pressed.bodies;
  for (std::size_t begin = 0, end = 0; begin < bodies.size(); begin = end) {
    const std::uint32_t group = s.bodies[bodies[begin]].merge_group;
    while (end < bodies.size() && s.bodies[bodies[end]].merge_group == group) ++end;
    if (end - begin > 1) find_pressed(s, bodies.subspan(begin, end - begin));
  }
  if (pressed.sets.count() == s.bodies.size()) return 0;
  // A reference shape outlives the step: nothing that is not finite may get into it.
  check_damage(s);
  const std::vector<std::vector<BodyId>> sets = list_sets(s);
  for (const std::vector<BodyId>& ids : sets) join_into_first(s, ids);
  return static_cast<int>(sets.size());
}

}  // namespace mallow
