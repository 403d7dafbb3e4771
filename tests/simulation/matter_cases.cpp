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

std::vector<Case> cases_of_matter() {
  const auto to = [](SolverConfig solver, float tolerance) {
    solver.volume_iterations = 12;
    solver.volume_tolerance = tolerance;
    return solver;
  };
  Material still = damped(stuff(0.3f), 0, 0.0f);
  still.pressure_coefficient = 0.0f;
  Material creeping = dough(0.3f, 0.02f, 0.6f);
  creeping.pressure_coefficient = 0.0f;
  const auto painted = [](Material material, float speed) {
    Blob blob = thrown(damped(std::move(material), 0, 0.0f), speed);
    blob.paints_yield = true;
    return blob;
  };
  return {
      {.name = "to_tolerance_jelly",
       .blobs = {thrown(still, 3)},
       .colliders = {k_slope},
       .solver = to(units(), 0.01f),
       .updates = 1},
      {.name = "to_tolerance_fluid_in_tank",
       .blobs = {{with_paper_settings(damped(stuff(1.0f), 0, 0.0f)), {0, 0, 3.6f}, {-0.8f, 0.3f, -2.5f}}},
       .colliders = {k_tank},
       .solver = to(walled(), 0.02f),
       .tolerance = 2e-4},
      {.name = "painted_yield_on_slope",
       .blobs = {painted(dough(0.0f, 0.05f), 2.5f)},
       .colliders = {k_slope},
       .solver = units(),
       .updates = 1,
       .flows = true},
      {.name = "painted_yield_creeps_on_ball",
       .blobs = {painted(creeping, 2.0f)},
       .colliders = {k_ball},
       .solver = full(units(2.9f), 2),
       .flows = true},
  };
}

}  // namespace mallow
