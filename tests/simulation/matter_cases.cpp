// Cases of the second chapter: what materials do beyond the paper.
#include "simulation/oracle_case_parts.h"

namespace mallow {
namespace {

Blob thrown(const Material& material, float speed = 1.5f) {
  return {with_paper_settings(material), {0, 0, 4.2f}, {0.5f, 0, -speed}};
}

Material damped(Material material, float damping_time, std::optional<float> deformation_damping) {
  material.damping_time = damping_time;
  material.deformation_damping = deformation_damping;
  return material;
}

}  // namespace

std::vector<Case> cases_of_damping() {
  SolverConfig light = units();
  light.gravity = {0, 0, -0.08f};
  Material firm_paste = firm(0.5f, 60.0f);
  firm_paste.pressure_coefficient = 500.0f;
  return {
      {.name = "damped_elastic",
       .blobs = {thrown(damped(lasting(0.0f), 0.1f, 0.0f), 3)},
       .colliders = {k_slope},
       .solver = units()},
      {.name = "damped_jelly_updated",
       .blobs = {thrown(damped(stuff(0.3f), 0.1f, 0.0f), 2)},
       .colliders = {k_slope},
       .solver = units(),
       .updates = 1},
      {.name = "damped_dough",
       .blobs = {thrown(damped(dough(0.1f, 0.05f), 0.06f, 0.0f), 2.5f)},
       .colliders = {k_slope},
       .solver = units(),
       .flows = true,
       .tolerance = 1e-3},
      {.name = "held_stiff",
       .blobs = {thrown(damped(lasting(0.0f), 0, 1.5f), 3)},
       .colliders = {k_slope},
       .solver = units()},
      {.name = "held_stiff_by_pins",
       .blobs = {{with_paper_settings(damped(lasting(0.0f), 0, 1.0f)), {0, 0, 0}, {0, 0, 0}, {10, 4, 4}}},
       .solver = units(),
       .pins = {{{{-9, -9, -9}, {-3.0f, 9, 9}}}, {{{3.0f, -9, -9}, {9, 9, 9}}, {-0.3f, 0.4f, 0}}}},
      {.name = "damped_limits",
       .blobs = {thrown(damped(firm_paste, 0.12f, 1.0f), 2)},
       .colliders = {k_slope},
       .solver = units(),
       .limited = true,
       .updates = 1},
      {.name = "damped_and_full",
       .blobs = {thrown(damped(stuff(0.0f), 0.1f, 0.5f), 3)},
       .colliders = {k_slope},
       .solver = full(units(), 2)},
      {.name = "comes_to_rest",
       .blobs = {{with_paper_settings(damped(lasting(0.0f), 0, {})), {0, 0, 0}, {0, 0, 0}, {10, 4, 4}}},
       .solver = light,
       .pins = {{{{-9, -9, -9}, {-3.0f, 9, 9}}}}},
  };
}

}  // namespace mallow
