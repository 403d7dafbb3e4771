#include "program/body_appearances.h"

#include <algorithm>
#include <array>

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

std::vector<Appearance> body_appearances(const Scene& scene, std::size_t bodies) {
  std::vector<Appearance> appearances;
  for (const std::size_t index : body_materials(scene)) {
    const SceneMaterial& material = scene.materials[index];
    appearances.push_back({material.color.value_or(k_palette[index % k_palette.size()]), material.finish});
  }
  if (appearances.size() < bodies) appearances.resize(bodies, k_thrown);
  return appearances;
}

std::size_t body_slots(const Simulation& simulation) {
  std::size_t slots = 0;
  for (const BodyId body : simulation.bodies()) slots = std::max<std::size_t>(slots, slot_of(body) + 1);
  return slots;
}

}  // namespace mallow::program
