#include "simulation/oracle_cases.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "oracle/points.h"
#include "paper_settings.h"
#include "simulation/oracle_case_parts.h"

namespace mallow {
namespace {

/// Nothing given but what has no default: metres, and a gravity that is to be felt.
SolverConfig left_out(float update_period) {
  return {.support_radius = 0.22f, .gravity = {0, 0, -9.81f}, .update_period = update_period};
}
SolverConfig turned(SolverConfig solver, float time_step_factor) {
  solver.time_step_factor = time_step_factor;
  return solver;
}
/// Weightless: seconds follow from the fastest body.
SolverConfig adrift() {
  return {.support_radius = 2.2f, .gravity = {0, 0, 0}};
}

std::vector<Case> paper_cases() {
  // clang-format off
  std::vector<Case> cases = {
      {.name = "elastic_on_slope", .blobs = {{lasting(0.0f), {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units()},
      {.name = "elastic_on_slope_updated", .blobs = {{stuff(0.0f), {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "jelly_on_slope", .blobs = {{stuff(0.3f), {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "paste_on_slope", .blobs = {{stuff(0.7f), {0, 0, 4.0f}, {0, 0, -1.0f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "paste_on_ball", .blobs = {{stuff(0.7f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_ball}, .solver = units(2.9f), .updates = 1},
      {.name = "cream_on_ball_and_slope", .blobs = {{stuff(0.9f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_ball, {.shape = Plane{{0, 0.1f, 1}, -0.5f}, .friction = 0.3f}}, .solver = units(), .updates = 2},
      {.name = "dough_on_slope", .blobs = {{dough(0.0f, 0.02f), {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units(), .flows = true, .tolerance = 1e-3},
      {.name = "creeping_dough_on_ball", .blobs = {{dough(0.7f, 0.01f, 0.4f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_ball}, .solver = units(2.9f), .flows = true, .tolerance = 1e-3},
      {.name = "dough_hits_slope_and_is_taken_anew", .blobs = {{dough(0.0f, 0.05f), {0, 0, 4.2f}, {0, 0, -2.5f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1, .flows = true, .tolerance = 1e-3},
      {.name = "two_lumps_of_dough_merge", .blobs = {{dough(0.4f, 0.05f), {0, 0, 3.4f}, {0, 0, -0.2f}, {5, 5, 5}}, {.center = {0.3f, 0.4f, 8.8f}, .velocity = {0, 0, -2.0f}, .count = {5, 5, 5}, .joins_the_one_before = true}}, .colliders = {k_slope}, .solver = units(), .updates = 1, .flows = true, .tolerance = 1e-3},
      {.name = "firm_jelly_on_slope", .blobs = {{firm(0.3f, 60.0f), {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "fluid_on_slope", .blobs = {{stuff(1.0f), {0, 0, 4.0f}, {0, 0, -1.0f}}}, .colliders = {k_slope}, .solver = units()},
      {.name = "syrup_on_ball", .blobs = {{{.alpha = 1.0f, .viscosity = 4}, {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_ball}, .solver = units(), .limited = true, .tolerance = 5e-4},
      {.name = "fluid_in_tank", .blobs = {{stuff(1.0f), {0, 0, 3.6f}, {-0.8f, 0.3f, -0.5f}}}, .colliders = {k_tank}, .solver = units()},
      {.name = "paste_in_bowl", .blobs = {{stuff(0.7f), {0, 0, 5.0f}, {0, 0, -1.0f}, {5, 5, 7}}}, .colliders = {k_bowl}, .solver = units(1.7f), .updates = 1},
      {.name = "paste_on_step", .blobs = {{stuff(0.7f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_step}, .solver = units(), .updates = 1},
      {.name = "jelly_on_union", .blobs = {{stuff(0.3f), {0, 0, 4.4f}, {0, 0, -1.0f}, {7, 5, 6}}}, .colliders = {k_union}, .solver = units(), .updates = 1},
      {.name = "overlap_at_start", .blobs = {{lasting(0.3f), {0, 0, 2.0f}, {0, 0, -0.5f}}}, .colliders = {{.shape = k_tilted, .friction = 0.3f}}, .solver = with_offset(0.2f)},
      {.name = "moving_slope", .blobs = {{stuff(0.7f), {0, 0, 4.0f}}}, .colliders = {{.shape = k_tilted, .velocity = {0.5f, 0, 0.6f}, .friction = 0.5f}}, .solver = units(), .updates = 1},
      {.name = "moving_ball", .blobs = {{{.alpha = 0.3f, .update_threshold = 1e6f, .pressure_coefficient = 60}, {0, 0, 4.0f}}}, .colliders = {{.shape = Sphere{{-6.5f, 0.2f, 4}, 2.5f}, .velocity = {1.0f, 0, 0}, .restitution = 0.6f}}, .solver = units()},
      {.name = "elastic_pair", .blobs = {{lasting(0.0f), {0, 0, 0}, {0, 0, 0.6f}, {5, 5, 4}}, {lasting(0.0f), {0.6f, 0.2f, 4.6f}, {0, 0, -0.6f}, {5, 5, 4}}}, .solver = units()},
      {.name = "unlike_pair", .blobs = {{{.alpha = 0.3f, .update_threshold = 1.0f, .pressure_coefficient = 12, .viscosity = 0.2f, .particle_mass = 2.0f}, {0, 0, 3.4f}, {0, 0, -0.4f}, {5, 5, 5}},
                                        {{.alpha = 0.9f, .update_threshold = 1.0f, .pressure_coefficient = 20, .viscosity = 1.0f, .rest_density = 0.4f, .cohesion = 0.3f}, {0.2f, 0.3f, 8.2f}, {0, 0, -1}, {6, 5, 5}, 0.8f}}, .colliders = {k_slope}, .solver = units(), .updates = 2},
      {.name = "bodies_of_one_group_merge", .blobs = {{stuff(0.7f), {0, 0, 3.4f}, {0, 0, -0.2f}, {5, 5, 5}}, {.center = {0.3f, 0.4f, 8.8f}, .velocity = {0, 0, -1.2f}, .count = {5, 5, 5}, .joins_the_one_before = true}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "melting", .blobs = {{stuff({{1.0f, 0.05f}, {3.0f, 1.0f}}), {0, 0, 4.0f}, {0, 0, -1.0f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "setting", .blobs = {{stuff({{0.6f, 0.9f}, {1.2f, 0.0f}}), {0, 0, 4.0f}, {3, 0, -1.0f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "hanging", .blobs = {{{.alpha = 0.5f, .cohesion = 1.0f}, {0, 0, 4.2f}, {0, 0, 0}, {4, 4, 10}}}, .solver = units(), .pins = {{{{-9, -9, 7.2f}, {9, 9, 99}}, {0.3f, 0.2f, 0.1f}}}},
      {.name = "pinned_and_pushed", .blobs = {{{.alpha = 0.3f, .update_threshold = 1.2f, .viscosity = 0.7f, .cohesion = 1.0f}, {0, 0, 6.0f}, {0, 0, 0}, {4, 4, 10}}}, .colliders = {{.shape = Plane{{0.1f, 0.1f, 1}, 0.6f}, .velocity = {0, 0, 0.5f}, .friction = 0.3f}}, .solver = units(), .pins = {{{{-9, -9, 5.5f}, {9, 9, 99}}}}, .updates = 1},
      {.name = "wrung", .blobs = {{lasting(0.7f), {0, 0, 0}, {0, 0, 0}, {10, 4, 4}}}, .solver = units(), .pins = {{{{-9, -9, -9}, {-3.0f, 9, 9}}}, {{{3.0f, -9, -9}, {9, 9, 9}}, {-0.3f, 0.2f, 0}}}},
      {.name = "printed_paste_on_slope", .blobs = {{stuff(0.7f), {0, 0, 4.0f}, {0, 0, -1.0f}}}, .colliders = {k_slope}, .solver = printed(), .updates = 1},
      {.name = "printed_pair", .blobs = {{lasting(0.5f), {0, 0, 0}, {0, 0, 0.6f}, {5, 5, 4}}, {{.alpha = 0.7f, .pressure_coefficient = 9, .viscosity = 1, .cohesion = 0.2f}, {0.6f, 0.2f, 4.4f}, {0, 0, -0.6f}, {5, 5, 4}}}, .solver = printed()},
      {.name = "cohesive_fluid_in_wind", .blobs = {{{.alpha = 1.0f, .cohesion = 0.5f}, {0, 0, 0}, {0.2f, 0, 0}}}, .solver = units(), .wind = true},
      {.name = "jelly_in_wind", .blobs = {{{.alpha = 0.3f, .update_threshold = 1e6f, .pressure_coefficient = 60, .viscosity = 1.5f, .cohesion = 0.5f}, {0, 0, 0}, {0.2f, 0, 0}, {8, 4, 4}}}, .solver = units(), .wind = true},
      {.name = "walled_fluid_on_slope", .blobs = {{stuff(1.0f), {0, 0, 4.0f}, {0, 0, -1.0f}}}, .colliders = {k_slope}, .solver = walled()},
      {.name = "walled_fluid_in_tank", .blobs = {{stuff(1.0f), {0, 0, 3.6f}, {-0.8f, 0.3f, -0.5f}}}, .colliders = {k_tank}, .solver = walled()},
      {.name = "walled_cream_on_ball_and_slope", .blobs = {{stuff(0.9f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_ball, {.shape = Plane{{0, 0.1f, 1}, -0.5f}, .friction = 0.3f}}, .solver = walled(), .updates = 2},
      {.name = "walled_paste_in_bowl", .blobs = {{stuff(0.7f), {0, 0, 5.0f}, {0, 0, -1.0f}, {5, 5, 7}}}, .colliders = {k_bowl}, .solver = walled(1.7f), .updates = 1},
      {.name = "walled_paste_on_step", .blobs = {{stuff(0.7f), {0, 0, 3.8f}, {0, 0, -1.0f}}}, .colliders = {k_step}, .solver = walled(), .updates = 1},
      {.name = "walled_jelly_on_union", .blobs = {{stuff(0.3f), {0, 0, 4.4f}, {0, 0, -1.0f}, {7, 5, 6}}}, .colliders = {k_union}, .solver = walled(), .updates = 1},
      {.name = "walled_moving_slope", .blobs = {{stuff(0.7f), {0, 0, 4.0f}}}, .colliders = {{.shape = k_tilted, .velocity = {0.5f, 0, 0.6f}, .friction = 0.5f}}, .solver = walled(), .updates = 1},
      {.name = "fast_fall", .blobs = {{stuff(0.7f), {0, 0, 14}, {2, 0, -16}}}, .solver = without_acoustic_limit(), .limited = true},
      {.name = "slow_spring_small_regions", .blobs = {{{.alpha = 0.3f, .update_threshold = 1.0f, .elastic_time_step = 0.3f, .region_radius = 1.6f}, {0, 0, 4.2f}, {0, 0, -1.5f}}}, .colliders = {k_slope}, .solver = units(), .updates = 1},
      {.name = "painted_on_slope", .blobs = {{.material = stuff(0.0f), .center = {0, 0, 4.2f}, .velocity = {0, 0, -1.5f}, .painted = true}}, .colliders = {k_slope}, .solver = units(), .updates = 1, .tolerance = 1e-3},
      {.name = "painted_in_tank", .blobs = {{.material = stuff(0.0f), .center = {0, 0, 3.6f}, .velocity = {-0.8f, 0.3f, -0.5f}, .painted = true}}, .colliders = {k_tank}, .solver = walled(), .updates = 1, .tolerance = 1e-3},
      {.name = "painted_pair", .blobs = {{.material = stuff(0.3f), .center = {0, 0, 0}, .velocity = {0, 0, 0.6f}, .count = {5, 5, 4}, .painted = true}, {lasting(0.4f), {0.6f, 0.2f, 4.6f}, {0, 0, -0.6f}, {5, 5, 4}}}, .solver = units(), .updates = 1, .tolerance = 1e-3},
      // Of the loose points three make an almost straight line. The engine lets its last rotation decide there from 1e-4
      // of the region's size on, the oracle from 1e-12 on.
      {.name = "flat_sheet_and_loose_points", .blobs = {{lasting(0.0f), {0, 0, 3}, {0, 0, 0}, {9, 9, 1}, 1, 0}, {.center = {0, 0, 9}, .velocity = {0, 0, -1.5f}, .count = {1, 1, 1}, .joins_the_one_before = true}, {.center = {9, 0, 7}, .velocity = {0, 0, -1}, .count = {3, 1, 1}, .joins_the_one_before = true}}, .colliders = {k_ball, k_slope}, .solver = units(), .tolerance = 1e-3},
  };
  // clang-format on
  for (Case& one : cases)
    for (Blob& b : one.blobs) b.material = with_paper_settings(b.material);
  return cases;
}

/// What configs leave out follows from the scene: in metres under gravity, and adrift.
std::vector<Case> cases_with_defaults() {
  const Collider floor{.shape = Plane{}, .friction = 0.3f};
  const auto cube = [](AlphaSchedule alpha, float height) {
    return Blob{.material = {.alpha = std::move(alpha), .rest_density = 1000.0f},
                .center = {0, 0, height},
                .velocity = {0.4f, 0, -1.5f},
                .count = {5, 5, 5},
                .spacing = 0.1f};
  };
  const auto clay = [&](float height) {
    Blob blob = cube(0.3f, height);
    blob.material.update_threshold = 20.0f;
    return blob;
  };
  return {
      {.name = "defaults_paste",
       .blobs = {cube(0.7f, 0.35f)},
       .colliders = {floor},
       .solver = left_out(0.1f)},
      {.name = "defaults_melting",
       .blobs = {cube({{0.1f, 0.01f}, {0.3f, 1.0f}}, 0.35f)},
       .colliders = {floor},
       .solver = left_out(0.1f)},
      {.name = "defaults_pair",
       .blobs = {cube(0.02f, 0.3f), cube(0.6f, 0.83f)},
       .colliders = {floor},
       .solver = left_out(0.1f)},
      {.name = "defaults_updated",
       .blobs = {clay(0.3f)},
       .colliders = {floor},
       .solver = left_out(0.037f),
       .updates = 2},
      {.name = "defaults_updated_half_steps",
       .blobs = {clay(0.3f)},
       .colliders = {floor},
       .solver = turned(left_out(0.037f), 0.5f),
       .updates = 1},
      {.name = "defaults_long_steps",
       .blobs = {clay(0.3f)},
       .colliders = {floor},
       .solver = turned(left_out(0.05f), 1.5f),
       .updates = 1},
      {.name = "defaults_adrift",
       .blobs = {{{.alpha = 0.4f}, {0, 0, 0}, {1.5f, 0, 0}, {5, 5, 4}},
                 {{.alpha = 0.0f}, {0.6f, 0.2f, 4.6f}, {1.5f, 0, -2.0f}, {5, 5, 4}}},
       .solver = adrift()},
  };
}

/// Volume iterations, beside pressure or without. Blows are hard, so that they matter.
std::vector<Case> cases_that_keep_volume() {
  const auto stuff_of = [](AlphaSchedule alpha) {
    return Material{
        .alpha = std::move(alpha), .update_threshold = 1.0f, .pressure_coefficient = 0.0f, .viscosity = 0.5f};
  };
  const auto one = [&](AlphaSchedule alpha) {
    return Blob{stuff_of(std::move(alpha)), {0, 0, 4.2f}, {0, 0, -3}};
  };
  const Material hung{.alpha = 0.3f, .update_threshold = 1e6f, .viscosity = 0.5f, .cohesion = 1.0f};
  const Material light{.alpha = 0.2f, .update_threshold = 1.0f, .viscosity = 0.4f, .rest_density = 0.4f};
  Material heavy = stuff_of(0.9f);
  heavy.pressure_coefficient = {};
  heavy.particle_mass = 2.0f;
  return {
      {.name = "full_elastic",
       .blobs = {one(0.0f)},
       .colliders = {k_slope},
       .solver = full(units(), 1),
       .updates = 1},
      {.name = "full_jelly",
       .blobs = {one(0.3f)},
       .colliders = {k_slope},
       .solver = full(units(), 2),
       .updates = 1},
      {.name = "full_paste",
       .blobs = {one(0.7f)},
       .colliders = {k_ball},
       .solver = full(units(2.9f), 3),
       .updates = 1},
      {.name = "full_fluid", .blobs = {one(1.0f)}, .colliders = {k_slope}, .solver = full(units(), 2)},
      {.name = "full_walled_fluid_in_tank",
       .blobs = {{stuff_of(1.0f), {0, 0, 3.6f}, {-0.8f, 0.3f, -2.5f}}},
       .colliders = {k_tank},
       .solver = full(walled(), 2),
       .tolerance = 2e-4},
      {.name = "full_walled_moving_slope",
       .blobs = {one(0.7f)},
       .colliders = {{.shape = k_tilted, .velocity = {0.5f, 0, 0.6f}, .friction = 0.5f}},
       .solver = full(walled(), 1),
       .updates = 1},
      {.name = "full_pinned_and_pushed",
       .blobs = {{hung, {0, 0, 6}, {0, 0, 0}, {4, 4, 10}}},
       .colliders = {{.shape = Plane{{0.1f, 0.1f, 1}, 0.6f}, .velocity = {0, 0, 0.6f}, .friction = 0.3f}},
       .solver = full(units(), 2),
       .pins = {{{{-9, -9, 5.5f}, {9, 9, 99}}}}},
      {.name = "full_unlike_pair",
       .blobs = {{heavy, {0, 0, 3.4f}, {0, 0, -0.4f}, {5, 5, 5}},
                 {light, {0.2f, 0.3f, 8.2f}, {0, 0, -3}, {6, 5, 5}, 0.8f}},
       .colliders = {k_slope},
       .solver = full(units(), 2),
       .updates = 1},
  };
}

}  // namespace

const std::vector<Case>& oracle_cases() {
  static const std::vector<Case> cases = [] {
    std::vector<Case> all = paper_cases();
    for (Case& one : cases_with_defaults()) all.push_back(std::move(one));
    for (Case& one : cases_that_keep_volume()) all.push_back(std::move(one));
    for (Case& one : all)
      for (Blob& b : one.blobs) b.material.deformation_damping = 0.0f;
    for (Case& one : cases_of_damping()) all.push_back(std::move(one));
    for (Case& one : cases_of_matter()) all.push_back(std::move(one));
    for (Case& one : cases_of_strands()) all.push_back(std::move(one));
    for (Case& one : cases_of_heat()) all.push_back(std::move(one));
    for (Case& one : all) one.solver.contact = BodyContact::pressure;
    for (Case& one : cases_of_contact()) all.push_back(std::move(one));
    for (Case& one : all) one.walls = one.name.starts_with("walled") || one.name.starts_with("full_walled");
    return all;
  }();
  return cases;
}

namespace {

/// What temperatures do to a material.
void each_without_heat(const Material& material,
                       const std::function<void(const char*, std::function<void(Material&)>)>& without) {
  if (!material.temperature) return;
  const double start = double{*material.temperature};
  if (material.conductivity > 0) without("conduction", [](Material& less) { less.conductivity = 0; });
  if (material.heat_transfer > 0) without("air", [](Material& less) { less.heat_transfer = 0; });
  if (material.latent_heat > 0) without("latent heat", [](Material& less) { less.latent_heat = 0; });
  if (material.alpha_by_temperature)
    without("alpha by temperature", [=](Material& less) {
      less.alpha = less.alpha_by_temperature->at(start);
      less.alpha_by_temperature = {};
    });
  if (material.viscosity_by_temperature)
    without("viscosity by temperature", [=](Material& less) {
      less.viscosity = less.viscosity_by_temperature->at(start);
      less.viscosity_by_temperature = {};
    });
  if (material.plastic_yield_by_temperature)
    without("yield by temperature", [=](Material& less) {
      less.plastic_yield = less.plastic_yield_by_temperature->at(start);
      less.plastic_yield_by_temperature = {};
    });
}

}  // namespace

std::vector<Case> ablations(const Case& whole) {
  std::vector<Case> lesser;
  const auto without = [&](const std::string& what, const std::function<void(Case&)>& take_away) {
    Case less = whole;
    less.name += " without " + what;
    take_away(less);
    lesser.push_back(std::move(less));
  };
  for (std::size_t c = 0; c < whole.colliders.size(); ++c) {
    const std::string number = std::to_string(c);
    without("collider " + number,
            [&](Case& less) { less.colliders.erase(less.colliders.begin() + static_cast<long>(c)); });
    if (whole.colliders[c].friction > 0)
      without("friction", [&](Case& less) { less.colliders[c].friction = 0; });
    if (whole.colliders[c].restitution > 0)
      without("bounce", [&](Case& less) { less.colliders[c].restitution = 0; });
    if (!whole.colliders[c].velocity.isZero())
      without("motion", [&](Case& less) { less.colliders[c].velocity.setZero(); });
    if (whole.colliders[c].temperature)
      without("heat of collider " + number, [&](Case& less) { less.colliders[c].temperature = {}; });
    if (whole.colliders[c].heat_transfer)
      without("a film on collider " + number, [&](Case& less) { less.colliders[c].heat_transfer = {}; });
    const auto* shapes = std::get_if<Union>(&whole.colliders[c].shape);
    for (std::size_t p = 0; shapes && p < shapes->parts.size(); ++p) {
      without("part " + std::to_string(p), [&](Case& less) {
        auto& parts = std::get<Union>(less.colliders[c].shape).parts;
        parts.erase(parts.begin() + static_cast<long>(p));
      });
    }
  }
  for (std::size_t p = 0; p < whole.pins.size(); ++p) {
    without("pin " + std::to_string(p),
            [&](Case& less) { less.pins.erase(less.pins.begin() + static_cast<long>(p)); });
  }
  for (std::size_t b = 0; b < whole.blobs.size(); ++b) {
    const Material& material = whole.blobs[b].material;
    if (material.damping_time > 0)
      without("damping time", [&](Case& less) { less.blobs[b].material.damping_time = 0; });
    if (material.deformation_damping != 0.0f)
      without("deformation damping", [&](Case& less) { less.blobs[b].material.deformation_damping = 0.0f; });
  }
  for (std::size_t b = 0; b < whole.blobs.size(); ++b)
    each_without_heat(whole.blobs[b].material, [&](const char* what, const auto& take_away) {
      without(what, [&](Case& less) { take_away(less.blobs[b].material); });
    });
  for (std::size_t n = 0; n < whole.nozzles.size(); ++n) {
    without("nozzle", [&](Case& less) { less.nozzles.erase(less.nozzles.begin() + static_cast<long>(n)); });
    const Nozzle& nozzle = whole.nozzles[n];
    if (nozzle.turn != 0) without("turned layers", [&](Case& less) { less.nozzles[n].turn = 0; });
    if (!nozzle.emitter.velocity.isZero())
      without("motion of the nozzle", [&](Case& less) { less.nozzles[n].emitter.velocity.setZero(); });
    if (nozzle.emitter.start) without("its start", [&](Case& less) { less.nozzles[n].emitter.start = {}; });
    if (nozzle.emitter.speed.keys().size() > 1)
      without("keys of its speed",
              [&](Case& less) { less.nozzles[n].emitter.speed = less.nozzles[n].emitter.speed.at(0); });
    if (nozzle.material.plastic_yield)
      without("yield of the strand", [&](Case& less) {
        less.nozzles[n].material.plastic_yield = {};
        less.nozzles[n].material.update_threshold = 1e6f;
      });
  }
  const bool two_bodies = std::any_of(whole.blobs.begin() + 1, whole.blobs.end(),
                                      [](const Blob& b) { return !b.joins_the_one_before; });
  const bool touches = two_bodies && whole.solver.contact == BodyContact::constraint;
  const auto any_blob = [&](const auto& is_so) { return std::ranges::any_of(whole.blobs, is_so); };
  if (touches) {
    without("contact between bodies", [](Case& less) { less.solver.contact = BodyContact::pressure; });
    if (any_blob([](const Blob& b) { return b.material.friction > 0; }))
      without("friction between bodies", [](Case& less) {
        for (Blob& b : less.blobs) b.material.friction = 0;
      });
    if (any_blob([](const Blob& b) { return b.material.adhesion > 0; }))
      without("adhesion", [](Case& less) {
        for (Blob& b : less.blobs) b.material.adhesion = 0;
      });
  }
  if (any_blob([](const Blob& b) { return b.splits; }))
    without("parts of their own", [](Case& less) {
      for (Blob& b : less.blobs) b.splits = false;
    });
  for (std::size_t d = 0; d < whole.drains.size(); ++d)
    without("sink " + std::to_string(d),
            [&](Case& less) { less.drains.erase(less.drains.begin() + static_cast<long>(d)); });
  if (whole.wind) without("wind", [](Case& less) { less.wind = false; });
  if (whole.flows)
    without("yield", [](Case& less) {
      for (Blob& b : less.blobs) b.material.plastic_yield = b.material.plastic_creep = {};
      for (Blob& b : less.blobs) b.material.plastic_yield_by_temperature = {};
      for (Blob& b : less.blobs) b.material.update_threshold = 1e6f;
    });
  if (whole.updates > 0 && !whole.flows)
    without("updates", [](Case& less) {
      for (Blob& b : less.blobs) b.material.update_threshold = 1e6f;
    });
  for (std::size_t b = 0; b < whole.blobs.size(); ++b)
    if (whole.blobs[b].painted) without("paint", [&](Case& less) { less.blobs[b].painted = false; });
  for (std::size_t b = 0; b < whole.blobs.size(); ++b)
    if (whole.blobs[b].paints_yield)
      without("painted yield", [&](Case& less) { less.blobs[b].paints_yield = false; });
  const bool sph_acts = whole.blobs.front().painted || whole.blobs.front().material.alpha_by_temperature ||
                        whole.blobs.front().material.alpha.keys().back().value > 0 ||
                        (two_bodies && !touches);
  const bool full = whole.solver.volume_iterations > 0;
  if (whole.walls) without("walls", [](Case& less) { less.solver.wall_pressure = false; });
  if (whole.solver.volume_tolerance > 0)
    without("tolerance", [](Case& less) { less.solver.volume_tolerance = 0; });
  if (full) without("volume iterations", [](Case& less) { less.solver.volume_iterations = 0; });
  if (sph_acts && whole.blobs.front().material.pressure_coefficient.value_or(1) > 0)
    without("pressure", [](Case& less) {
      for (Blob& b : less.blobs) b.material.pressure_coefficient = 0;
    });
  if (sph_acts)
    without("viscosity", [](Case& less) {
      for (Blob& b : less.blobs) b.material.viscosity = 0;
      for (Blob& b : less.blobs) b.material.viscosity_by_temperature = {};
    });
  for (std::size_t b = 0; b < whole.blobs.size(); ++b) {
    if (whole.blobs[b].material.cohesion > 0)
      without("cohesion", [&](Case& less) { less.blobs[b].material.cohesion = 0; });
  }
  return lesser;
}

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}

std::vector<Vec3> points_of(const Blob& blob) {
  return oracle::lattice_points(blob.count, blob.spacing, blob.center, blob.jitter);
}

namespace {

/// From `first` to `last` along an axis.
std::vector<float> graded(const Blob& blob, int axis, float first, float last) {
  std::vector<float> values;
  const std::vector<Vec3> points = points_of(blob);
  const auto along = [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
  const auto [low, high] = std::minmax_element(points.begin(), points.end(), along);
  for (const Vec3& x : points)
    values.push_back(first + (last - first) * (x[axis] - (*low)[axis]) / ((*high)[axis] - (*low)[axis]));
  return values;
}

}  // namespace

std::vector<float> alphas_of(const Blob& blob) {
  return blob.painted ? graded(blob, 0, 0.0f, 1.0f) : std::vector<float>{};
}

std::vector<float> stiffnesses_of(const Blob& blob) {
  return blob.painted ? graded(blob, 1, 0.4f, 1.6f) : std::vector<float>{};
}

std::vector<float> yields_of(const Blob& blob) {
  return blob.paints_yield ? graded(blob, 1, 0.01f, 0.3f) : std::vector<float>{};
}

oracle::Oracle oracle_of(const Case& scene) {
  oracle::Oracle oracle(scene.solver);
  std::size_t group = 0;
  for (const Blob& blob : scene.blobs) {
    if (!blob.joins_the_one_before) group = oracle.add_group(blob.material);
    std::vector<oracle::Vec> positions;
    for (const Vec3& x : points_of(blob)) positions.push_back(x.cast<double>());
    const std::vector<oracle::Vec> velocities(positions.size(), blob.velocity.cast<double>());
    const std::size_t first = oracle.particles().size();
    oracle.add_body(positions, velocities, blob.spacing, group);
    if (blob.splits) oracle.let_split(group);
    const std::vector<float> alphas = alphas_of(blob), stiffnesses = stiffnesses_of(blob);
    for (std::size_t k = 0; k < alphas.size(); ++k)
      oracle.paint(first + k, double{alphas[k]}, double{stiffnesses[k]});
    const std::vector<float> yields = yields_of(blob);
    for (std::size_t k = 0; k < yields.size(); ++k) oracle.paint_yield(first + k, double{yields[k]});
  }
  for (const Collider& collider : scene.colliders) oracle.add_collider(collider);
  for (const Pinned& pin : scene.pins) oracle.pin(pin.box, pin.velocity.cast<double>());
  for (const Nozzle& nozzle : scene.nozzles) {
    std::vector<oracle::Vec> section;
    for (const Vec3& x : nozzle.section) section.push_back(x.cast<double>());
    oracle.add_emitter(nozzle.emitter, section, nozzle.turn, nozzle.material);
  }
  for (const Drain& drain : scene.drains) oracle.add_sink(drain.box, drain.outside);
  if (scene.wind) oracle.set_force(wind<double>);
  return oracle;
}

PlacesById places_of(const oracle::Oracle& oracle) {
  PlacesById places;
  for (const oracle::Particle& p : oracle.particles()) places[p.id] = p.x;
  return places;
}

double largest_deviation(const Case& scene, const PlacesById& a, const PlacesById& b) {
  std::vector<float> spacings;
  for (const Blob& blob : scene.blobs) spacings.insert(spacings.end(), points_of(blob).size(), blob.spacing);
  double largest = 0;
  for (const auto& [id, x] : a) {
    const auto twin = b.find(id);
    if (twin == b.end() || (id >= spacings.size() && scene.nozzles.empty())) continue;
    const float spacing = id < spacings.size() ? spacings[id] : scene.nozzles.front().emitter.spacing;
    const double deviation = (x - twin->second).norm() / double{spacing};
    largest = std::isfinite(deviation) ? std::max(largest, deviation) : INFINITY;
  }
  return largest;
}

double largest_deviation(const Case& scene, const std::vector<oracle::Vec>& a,
                         const std::vector<oracle::Vec>& b) {
  const auto numbered = [](const std::vector<oracle::Vec>& of) {
    PlacesById places;
    for (std::size_t id = 0; id < of.size(); ++id) places[id] = of[id];
    return places;
  };
  return largest_deviation(scene, numbered(a), numbered(b));
}

}  // namespace mallow
