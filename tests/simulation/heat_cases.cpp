// Cases of section 7 of the second chapter: bodies of a hundred kelvins and a diffusivity of about 1 h²/s.
#include "simulation/oracle_case_parts.h"

namespace mallow {
namespace {

Material warm(Material material, float temperature) {
  material.deformation_damping = 0.0f;
  material.temperature = temperature;
  material.conductivity = 1.0f;
  material.specific_heat = 1.0f;
  return with_paper_settings(std::move(material));
}

Material melting() {
  Material material = warm(stuff(0.0f), 300);
  material.alpha_by_temperature = Schedule{{300, 0.0f}, {360, 0.95f}};
  return material;
}

Collider heated(Collider collider, float temperature, std::optional<float> film = {}) {
  collider.temperature = temperature;
  collider.heat_transfer = film;
  return collider;
}

SolverConfig in_air(SolverConfig solver, Schedule temperature) {
  solver.air_temperature = std::move(temperature);
  return solver;
}

}  // namespace

std::vector<Case> cases_of_heat() {
  Material thinning = warm(stuff(1.0f), 300);
  thinning.viscosity_by_temperature = Schedule{{300, 2.0f}, {340, 0.2f}};
  Material both = melting();
  both.viscosity_by_temperature = Schedule{{300, 2.0f}, {340, 0.2f}};
  both.latent_heat = 60.0f;
  both.solidus = 310.0f;
  both.liquidus = 330.0f;
  Material setting = melting();
  setting.temperature = 370.0f;
  setting.heat_transfer = 2.0f;
  Material softening = warm({.plastic_yield_by_temperature = Schedule{{300, 0.4f}, {330, 0.01f}}}, 300);
  Material melting_dough = melting();
  melting_dough.update_threshold.reset();
  melting_dough.plastic_yield = 0.02f;
  Material hot = melting(), cold = melting();
  hot.temperature = 358.0f;
  hot.conductivity = 3.0f;
  cold.specific_heat = 0.5f;
  const Blob low{melting(), {0, 0, 3.2f}, {1.0f, 0, -1.5f}};
  const auto as = [&](const Material& material) {
    Blob blob = low;
    blob.material = material;
    return blob;
  };
  return {
      {.name = "melts_on_hot_slope",
       .blobs = {low},
       .colliders = {heated(k_slope, 500)},
       .solver = units(),
       .updates = 1},
      {.name = "thins_on_hot_slope",
       .blobs = {as(thinning)},
       .colliders = {heated(k_slope, 500)},
       .solver = units()},
      {.name = "thins_and_melts_with_latent_heat",
       .blobs = {as(both)},
       .colliders = {heated(k_slope, 600, 2.0f)},
       .solver = walled(),
       .updates = 1},
      {.name = "sets_in_air",
       .blobs = {as(setting)},
       .colliders = {k_slope},
       .solver = in_air(units(), {{0.0f, 250.0f}, {3.0f, 150.0f}}),
       .updates = 1},
      {.name = "softens_on_hot_ball",
       .blobs = {{softening, {0, 0, 3.4f}, {0, 0, -2.5f}}},
       .colliders = {heated(k_ball, 700)},
       .solver = units(),
       .flows = true},
      {.name = "dough_melts_on_hot_slope",
       .blobs = {{melting_dough, {0, 0, 3.4f}, {1.0f, 0, -2.5f}}},
       .colliders = {heated(k_slope, 600)},
       .solver = units(),
       .updates = 1,
       .flows = true},
      {.name = "hot_pair",
       .blobs = {{hot, {0, 0, 0}, {0, 0, 0.6f}, {5, 5, 4}},
                 {cold, {0.6f, 0.2f, 4.2f}, {0, 0, -0.6f}, {5, 5, 4}}},
       .solver = units(),
       .updates = 1},
  };
}

}  // namespace mallow
