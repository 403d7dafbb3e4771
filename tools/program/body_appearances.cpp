#include "program/body_appearances.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mallow::program {
namespace {

/// Linear RGB; for materials that name no colour.
const std::array<Vec3, 8> k_palette = {
    Vec3{0.80f, 0.24f, 0.09f}, Vec3{0.05f, 0.36f, 0.55f}, Vec3{0.85f, 0.55f, 0.08f},
    Vec3{0.18f, 0.48f, 0.14f}, Vec3{0.50f, 0.12f, 0.42f}, Vec3{0.03f, 0.45f, 0.42f},
    Vec3{0.75f, 0.30f, 0.34f}, Vec3{0.35f, 0.25f, 0.16f},
};

/// Of what no scene has.
const Appearance k_thrown{Vec3(0.05f, 0.30f, 0.55f), Finish::gloss};

}  // namespace

std::vector<Appearance> body_appearances(const Scene& scene, std::span<const std::string> materials) {
  std::vector<Appearance> looks;
  for (std::size_t index = 0; const SceneMaterial& material : scene.materials)
    looks.push_back({material.color.value_or(k_palette[index++ % k_palette.size()]), material.finish});
  std::vector<Appearance> appearances;
  for (const std::size_t index : body_materials(scene)) appearances.push_back(looks[index]);
  appearances.resize(std::max(appearances.size(), materials.size()), k_thrown);
  for (std::size_t slot = 0; slot < materials.size(); ++slot) {
    const auto of = std::ranges::find(scene.materials, materials[slot], &SceneMaterial::name);
    if (of != scene.materials.end())
      appearances[slot] = looks[static_cast<std::size_t>(of - scene.materials.begin())];
  }
  return appearances;
}

bool follow_bodies(const Simulation& simulation, std::vector<BodyInfo>& by_slot) {
  const std::vector<BodyId> bodies = simulation.bodies();
  const auto slot = [](BodyId body) { return static_cast<std::size_t>(slot_of(body)); };
  // A slot may be another's by now.
  const auto is_known = [&](BodyId body) {
    if (slot(body) >= by_slot.size()) return false;
    const BodyInfo& known = by_slot[slot(body)];
    return known.name == simulation.name(body) && known.spacing == simulation.spacing(body);
  };
  if (std::ranges::all_of(bodies, is_known)) return false;
  const std::vector<BodyInfo> known = simulation.info().bodies;
  by_slot.resize(std::max(by_slot.size(), slot(*std::ranges::max_element(bodies, {}, slot)) + 1));
  for (std::size_t b = 0; b < bodies.size(); ++b) by_slot[slot(bodies[b])] = known[b];
  // Somebody may have come and gone between two frames: nobody is seen there, but no spacing is 0.
  for (BodyInfo& body : by_slot)
    if (body.spacing == 0) body.spacing = known.front().spacing;
  return true;
}

void know_bodies(const Simulation& simulation, std::vector<BodyInfo>& by_slot) {
  std::vector<BodyInfo> now;
  follow_bodies(simulation, now);
  if (by_slot.empty()) by_slot = now;
  for (std::size_t slot = 0; slot < std::min(now.size(), by_slot.size()); ++slot)
    if (now[slot].name == by_slot[slot].name && now[slot].spacing == by_slot[slot].spacing)
      by_slot[slot] = now[slot];
}

void count_particles(const Simulation& simulation, std::vector<BodyInfo>& by_slot) {
  for (BodyInfo& body : by_slot) body.particles = 0;
  for (const BodyId body : simulation.bodies()) {
    const auto rows = simulation.rows(body);
    if (slot_of(body) < by_slot.size()) by_slot[slot_of(body)].particles = rows.end - rows.begin;
  }
}

std::vector<SlotBody> slot_bodies(std::span<const BodyInfo> bodies) {
  std::vector<SlotBody> by_slot;
  for (const BodyInfo& body : bodies) by_slot.push_back({body.name, body.material, body.spacing});
  return by_slot;
}

std::vector<std::string> material_names(std::span<const SlotBody> bodies) {
  std::vector<std::string> names;
  for (const SlotBody& body : bodies) names.push_back(body.material);
  return names;
}

std::vector<std::string> material_names(std::span<const BodyInfo> bodies) {
  return material_names(slot_bodies(bodies));
}

std::vector<float> spacings_of(std::span<const SlotBody> bodies, std::span<const PastBody> past) {
  std::vector<float> spacings;
  for (const SlotBody& body : bodies) spacings.push_back(body.spacing);
  for (const PastBody& body : past) spacings.push_back(body.body.spacing);
  return spacings;
}

std::vector<PastBody> past_bodies(std::span<const SlotBody> before, std::span<const SlotBody> after,
                                  int frame) {
  std::vector<PastBody> past;
  for (std::size_t slot = 0; slot < std::min(before.size(), after.size()); ++slot)
    if (!before[slot].name.empty() && before[slot] != after[slot])
      past.push_back({slot, frame, before[slot]});
  return past;
}

std::vector<std::uint32_t> slot_numbers_at(int frame, std::size_t slots, std::span<const PastBody> past) {
  std::vector<std::uint32_t> numbers(slots);
  std::iota(numbers.begin(), numbers.end(), 0u);
  for (std::size_t k = past.size(); k-- > 0;)
    if (frame < past[k].until && past[k].slot < slots)
      numbers[past[k].slot] = static_cast<std::uint32_t>(slots + k);
  return numbers;
}

std::vector<SlotBody> slot_bodies_at(int frame, std::vector<SlotBody> now, std::span<const PastBody> past) {
  const std::vector<std::uint32_t> numbers = slot_numbers_at(frame, now.size(), past);
  for (std::size_t slot = 0; slot < numbers.size(); ++slot)
    if (numbers[slot] != slot) now[slot] = past[numbers[slot] - numbers.size()].body;
  return now;
}

}  // namespace mallow::program
