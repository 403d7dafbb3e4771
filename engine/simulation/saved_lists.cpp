// The lists of a saved state: what there is, all but its rows.
#include <algorithm>
#include <numeric>
#include <type_traits>

#include "colliders/collider_archive.h"
#include "colliders/collider_checks.h"
#include "config/field_tables.h"
#include "config/validation.h"
#include "simulation/saved_chunks.h"
#include "simulation/settings.h"

namespace mallow {

void pack_slots(const char* name, const Slots& slots, SavedState& saved) {
  saved.chunks.push_back(packed(name, [&](PackingArchive& archive) {
    pass_list(archive, slots.free, 0, [&](std::uint32_t slot) { archive(slot); });
    archive.array(slots.generation.data(), slots.generation.size());
  }));
}

void unpack_slots(const SavedState& saved, const char* name, std::span<const std::uint64_t> ids,
                  Slots& slots) {
  unpack(saved, name, [&](UnpackingArchive& archive) {
    pass_list(archive, slots.free, sizeof(std::uint32_t), [&](std::uint32_t& slot) { archive(slot); });
    unpack_column(archive, slots.generation);
    slots.given_back = std::accumulate(slots.generation.begin(), slots.generation.end(), std::uint64_t{0});
    const std::size_t count = ids.size() + slots.free.size();
    if (!slots.generation.empty() && slots.generation.size() != count)
      archive.fail("there must be a generation for each slot, or none");
    if (slots.generation.empty() && !slots.free.empty()) archive.fail("no slot was given back");
    slots.index.resize(count);
    std::vector<bool> taken(count, false);
    const auto take = [&](std::uint32_t slot) {
      if (slot >= count || taken[slot])
        archive.fail("slot " + std::to_string(slot) + " appears twice or is too large");
      taken[slot] = true;
    };
    for (const std::uint64_t id : ids) {
      take(slot_of(id));
      if (generation_of(id) != (slots.generation.empty() ? 0 : slots.generation[slot_of(id)]))
        archive.fail("id " + std::to_string(id) + " is not of the generation of its slot");
    }
    for (const std::uint32_t slot : slots.free) {
      take(slot);
      slots.index[slot] = Slots::k_free;
    }
    slots.place(0, ids);
  });
}

namespace {

/// An id of any kind as the number that it is.
template <class Archive, class Id>
void pass_id(Archive& archive, Id& id) {
  auto number = static_cast<std::underlying_type_t<std::remove_const_t<Id>>>(id);
  archive(number);
  if constexpr (!Archive::k_packs) id = Id{number};
}

/// All of a body but its material.
template <class Archive, class BodyState>
void pass_body(Archive& archive, BodyState& body, ShapeSizes& sizes) {
  auto& frame = body.shape.frame;
  pass_id(archive, body.id);
  archive(body.name);
  archive(body.whole);
  archive(body.last_part);
  archive(body.merges);
  archive(body.splits);
  archive(body.enabled);
  archive(body.user_data);
  archive(body.hit_impulse);
  archive(body.island);
  archive(body.slow_time);
  pass_list(archive, body.resting, 56, [&](auto& resting) {
    archive(resting.collider);
    archive.array(resting.load.impulse.data(), 3);
    archive.array(resting.load.torque.data(), 3);
  });
  archive(body.begin);
  archive(body.end);
  archive(body.spacing);
  archive(body.mass);
  archive(body.rest_density);
  archive(body.judged_external);
  pass_list(archive, body.recent_external, 2 * sizeof(double), [&](auto& external) {
    archive(external.seconds);
    archive(external.mean);
  });
  archive(body.grew);
  archive(body.apart);
  archive(body.paints_alpha);
  archive(body.paints_stiffness);
  archive(body.paints_yield);
  archive(body.is_heated);
  for (auto* vector : {&body.rigid.center, &body.rigid.velocity, &body.rigid.spin})
    archive.array(vector->data(), 3);
  archive(body.rigid.deformation_speed);
  archive(body.shape.built);
  archive(body.shape.spacing);
  archive.array(body.shape.mean.data(), 3);
  archive(body.shape.total_moment);
  archive.array(frame.rotation.coeffs().data(), 4);
  archive.array(frame.translation.data(), 3);
  archive(sizes.references);
  archive(sizes.regions);
}

void require_valid(const UnpackingArchive& archive, const Simulation::State& state, const BodyState& body,
                   const ShapeSizes& sizes, std::size_t begin) {
  const auto require = [&](bool ok, const char* what) {
    if (!ok) archive.fail("body '" + body.name + "': " + what);
  };
  require(body.begin == begin && body.end >= begin, "its rows must follow those of the body before it");
  require(body.size() > 0, "it has no particles");
  require(!body.hit_impulse || *body.hit_impulse >= 0, "the impulse that it tells of must be 0 or above");
  require(std::isfinite(body.slow_time) && body.slow_time >= 0,
          "the time that it has been slow must be finite and 0 or above");
  for (const BodyState::RestingLoad& resting : body.resting)
    require(resting.load.impulse.allFinite() && resting.load.torque.allFinite(),
            "what it gives colliders while it sleeps must be finite");
  for (const float value : {body.spacing, body.mass, body.rest_density})
    require(std::isfinite(value) && value > 0,
            "spacing, particle mass and rest density must be finite and above 0");
  const auto is_size = [](double value) { return std::isfinite(value) && value >= 0; };
  require(is_size(body.judged_external) && std::ranges::all_of(body.recent_external,
                                                               [&](const BodyState::External& e) {
                                                                 return is_size(e.seconds) && is_size(e.mean);
                                                               }),
          "mean acceleration must be finite and 0 or above");
  require(body.shape.spacing >= 0 && std::isfinite(body.shape.spacing),
          "spacing of the regions must be finite and 0 or above");
  require(!(body.grew && state.prepared), "it has particles that were not prepared");
  require(body.grew || !body.keeps_reference() || sizes.references == body.size(),
          "its reference shape must have as many particles as the body");
  require(sizes.references <= body.size(), "its reference shape has more particles than the body");
  require(!body.shape.built || sizes.references > 0, "there are regions without a reference shape");
}

template <class Archive, class Material>
void pass_material(Archive& archive, Material& material) {
  pass_id(archive, material.id);
  archive(material.name);
  archive(material.stays);
  pass_fields(archive, material.settings);
  archive(material.alpha);
}

void unpack_materials(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "materials", [&](UnpackingArchive& archive) {
    Checks checks;
    constexpr std::size_t k_least_bytes = 16;
    pass_list(archive, state.materials, k_least_bytes, [&](MaterialState& material) {
      pass_material(archive, material);
      if (!material.is_there()) return;
      constexpr Range k_alpha = range_of(&Material::alpha);
      if (!k_alpha.holds(material.alpha))
        archive.fail("material '" + material.name + "': alpha must be" + range_text(k_alpha));
      check(material.settings, checks);
      check_stiffness(state.config, material.settings, material.name, checks);
    });
    checks.finish();
  });
  std::vector<std::uint64_t> ids;
  for (const MaterialState& material : state.materials)
    if (material.is_there()) ids.push_back(static_cast<std::uint64_t>(material.id));
  unpack_slots(saved, "material_slots", ids, state.material_slots);
  for (const std::uint64_t id : ids) {
    if (slot_of(id) >= state.materials.size() || state.materials[slot_of(id)].id != MaterialId{id})
      throw ConfigError("saved state, chunk 'materials'", "a material does not stand where its slot is");
    state.material_slots.index[slot_of(id)] = slot_of(id);
  }
}

std::vector<ShapeSizes> unpack_bodies(const SavedState& saved, Simulation::State& state) {
  std::vector<ShapeSizes> sizes;
  unpack(saved, "bodies", [&](UnpackingArchive& archive) {
    std::size_t rows = 0;
    constexpr std::size_t k_least_bytes = 64;
    pass_list(archive, state.bodies, k_least_bytes, [&](BodyState& body) {
      std::uint64_t material = 0;
      archive(material);
      const std::optional<std::size_t> slot = state.material_slots.find(material);
      if (!slot) archive.fail("there is no material " + std::to_string(material));
      body.material = &state.materials[*slot];
      ++body.material->bodies;
      pass_body(archive, body, sizes.emplace_back());
      require_valid(archive, state, body, sizes.back(), rows);
      rows = body.end;
      const Material& settings = body.material->settings;
      body.shape.region_radius = region_radius(state.config, settings, body.spacing);
      body.shape.region_stride = settings.region_stride;
      body.shape.flows = flows(settings);
    });
  });
  return sizes;
}

template <class Archive, class Pin>
void pass_pin(Archive& archive, Pin& pin) {
  pass_id(archive, pin.id);
  archive(pin.velocity);
  archive(pin.left);
  archive(pin.seconds);
}

/// A pin stands where its slot says, beside those that are nobody's.
void unpack_pin_slots(const SavedState& saved, Simulation::State& state) {
  std::vector<std::uint64_t> ids;
  std::vector<bool> is_free(state.pins.size(), false);
  unpack(saved, "pin_slots", [&](UnpackingArchive& archive) {
    std::vector<std::uint32_t> free;
    pass_list(archive, free, sizeof(std::uint32_t), [&](std::uint32_t& slot) { archive(slot); });
    for (const std::uint32_t slot : free) {
      if (slot >= state.pins.size()) archive.fail("slot " + std::to_string(slot) + " is too large");
      is_free[slot] = true;
    }
    Column<std::uint32_t> generations;
    unpack_column(archive, generations);
  });
  for (std::size_t p = 0; p < state.pins.size(); ++p)
    if (!is_free[p]) ids.push_back(static_cast<std::uint64_t>(state.pins[p].id));
  unpack_slots(saved, "pin_slots", ids, state.pin_slots);
  for (const std::uint64_t id : ids) {
    if (slot_of(id) >= state.pins.size() || state.pins[slot_of(id)].id != PinId{id})
      throw ConfigError("saved state, chunk 'pins'", "a pin does not stand where its slot is");
    state.pin_slots.index[slot_of(id)] = slot_of(id);
  }
}

template <class Archive, class State>
void pass_emitters(Archive& archive, State& state) {
  archive(state.emitter_count);
  archive(state.sink_count);
  pass_list(archive, state.emitters, 72, [&](auto& emitter) {
    pass_id(archive, emitter.id);
    pass_id(archive, emitter.body);
    pass_id(archive, emitter.pin);
    pass_fields(archive, emitter.settings);
    pass_list(archive, emitter.settings.points, sizeof(Vec3), [&](auto& x) { archive(x); });
    pass_pose(archive, emitter.settings.pose);
    pass_keyframes(archive, emitter.settings.keyframes);
    archive(emitter.layers);
    archive(emitter.offset);
    archive(emitter.late);
    pass_list(archive, emitter.held, 8, [&](auto& layer) {
      pass_list(archive, layer, sizeof(ParticleId), [&](auto& id) { archive(id); });
    });
  });
  pass_list(archive, state.sinks, 41, [&](auto& sink) {
    pass_id(archive, sink.id);
    archive(sink.box.min);
    archive(sink.box.max);
    archive(sink.outside);
    archive(sink.drained);
  });
}

void unpack_emitters(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "emitters", [&](UnpackingArchive& archive) {
    pass_emitters(archive, state);
    Checks checks;
    for (const EmitterState& emitter : state.emitters) {
      check(emitter.settings, checks);
      check_poses("emitter", emitter.settings.pose, emitter.settings.keyframes, checks);
      if (!std::isfinite(emitter.offset) || emitter.held.size() > emitter.layers)
        archive.fail("an emitter has more layers than there have been, or is nowhere");
      if (!(std::isfinite(emitter.late) && emitter.late >= 0))
        archive.fail("the clock of an emitter is ahead, or no number");
    }
    checks.finish();
  });
}

/// What events of the next step depend on, and those that calls left for it.
template <class Archive, class State>
void pass_events(Archive& archive, State& state) {
  archive(state.contacts.hit_impulse);
  pass_list(archive, state.contacts.lasting, 25, [&](auto& contact) {
    archive(contact.key.body);
    archive(contact.key.of_bodies);
    archive(contact.key.other);
    archive(contact.apart);
  });
  // A step that failed leaves those of bodies that it joined.
  pass_list(archive, state.next_events, 26, [&](auto& event) {
    auto kind = static_cast<std::uint8_t>(event.kind);
    std::optional<std::uint64_t> other = std::nullopt;
    if (event.other) other = static_cast<std::uint64_t>(*event.other);
    archive(kind);
    pass_id(archive, event.body);
    archive(event.parts);
    archive(event.crumbs);
    archive(other);
    if constexpr (!Archive::k_packs) {
      if (kind > static_cast<std::uint8_t>(BodyEvent::Kind::split)) archive.fail("calls leave no such event");
      event.kind = static_cast<BodyEvent::Kind>(kind);
      if (other) event.other = BodyId{*other};
    }
  });
  pass_list(archive, state.ended, 16, [&](auto& ended) {
    archive(ended.id);
    pass_id(archive, ended.part_of);
  });
}

void unpack_events(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "events", [&](UnpackingArchive& archive) {
    pass_events(archive, state);
    const Contacts& contacts = state.contacts;
    if (contacts.hit_impulse && !(*contacts.hit_impulse >= 0))
      archive.fail("the impulse that bodies tell of must be 0 or above");
    for (std::size_t k = 0; k < contacts.lasting.size(); ++k) {
      const double apart = contacts.lasting[k].apart;
      if (!std::isfinite(apart) || apart < 0) archive.fail("a contact lasts for no time that there is");
      if (k > 0 && !(contacts.lasting[k - 1].key < contacts.lasting[k].key))
        archive.fail("contacts must ascend");
    }
  });
}

void unpack_obstacles(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "origin", [&](UnpackingArchive& archive) {
    archive(state.origin);
    if (!state.origin.allFinite()) archive.fail("is not finite");
  });
  unpack(saved, "colliders", [&](UnpackingArchive& archive) {
    Checks checks;
    pass_list(archive, state.colliders, 64, [&](Collider& collider) {
      archive(state.collider_ids.emplace_back());
      pass_collider(archive, collider);
      check(collider, checks);
    });
    checks.finish();
  });
  unpack_slots(saved, "collider_slots", state.collider_ids, state.collider_slots);
  unpack(saved, "pins", [&](UnpackingArchive& archive) {
    pass_list(archive, state.pins, sizeof(Vec3), [&](PinState& pin) {
      pass_pin(archive, pin);
      if (!pin.velocity.allFinite() || !pin.left.allFinite() || !(pin.seconds >= 0) ||
          !std::isfinite(pin.seconds))
        archive.fail("a velocity, a way or a time is not finite, or it is below 0");
    });
    if (state.pins.size() > k_max_pins) archive.fail("there are more than " + std::to_string(k_max_pins));
  });
  unpack_pin_slots(saved, state);
}

}  // namespace

void pack_lists(const Simulation::State& s, SavedState& saved) {
  const auto add = [&](Chunk chunk) { saved.chunks.push_back(std::move(chunk)); };
  add(packed("materials", [&](PackingArchive& archive) {
    pass_list(archive, s.materials, 0,
              [&](const MaterialState& material) { pass_material(archive, material); });
  }));
  pack_slots("material_slots", s.material_slots, saved);
  add(packed("bodies", [&](PackingArchive& archive) {
    pass_list(archive, s.bodies, 0, [&](const BodyState& body) {
      ShapeSizes sizes{body.shape.reference.size(), body.shape.built ? body.shape.region_weight.size() : 0};
      archive(static_cast<std::uint64_t>(body.material->id));
      pass_body(archive, body, sizes);
    });
  }));
  add(packed("origin", [&](PackingArchive& archive) { archive(s.origin); }));
  add(packed("colliders", [&](PackingArchive& archive) {
    std::size_t number = 0;
    pass_list(archive, s.colliders, 0, [&](const Collider& collider) {
      archive(s.collider_ids[number++]);
      pass_collider(archive, collider);
    });
  }));
  add(packed("pins", [&](PackingArchive& archive) {
    pass_list(archive, s.pins, 0, [&](const PinState& pin) { pass_pin(archive, pin); });
  }));
  add(packed("emitters", [&](PackingArchive& archive) { pass_emitters(archive, s); }));
  add(packed("events", [&](PackingArchive& archive) { pass_events(archive, s); }));
  pack_slots("body_slots", s.body_slots, saved);
  pack_slots("collider_slots", s.collider_slots, saved);
  pack_slots("pin_slots", s.pin_slots, saved);
}

std::vector<ShapeSizes> unpack_lists(const SavedState& saved, Simulation::State& state) {
  unpack_materials(saved, state);
  std::vector<ShapeSizes> sizes = unpack_bodies(saved, state);
  std::vector<std::uint64_t> body_ids;
  for (const BodyState& body : state.bodies) body_ids.push_back(static_cast<std::uint64_t>(body.id));
  unpack_slots(saved, "body_slots", body_ids, state.body_slots);
  for (const BodyState& body : state.bodies)
    if (body.island > state.body_slots.size())
      throw ConfigError("saved state, chunk 'bodies'",
                        "body '" + body.name + "': it sleeps with others that there are not");
  unpack_obstacles(saved, state);
  unpack_emitters(saved, state);
  unpack_events(saved, state);
  return sizes;
}

}  // namespace mallow
