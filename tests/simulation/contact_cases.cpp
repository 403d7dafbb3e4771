// Cases of section 4 C of the second chapter, of sinks, and of bodies that are torn.
#include "simulation/oracle_case_parts.h"

namespace mallow {
namespace {

Material undamped(Material material) {
  material.deformation_damping = 0.0f;
  return with_paper_settings(std::move(material));
}
Material sticky(Material material, float adhesion) {
  material.adhesion = adhesion;
  return material;
}

/// Two walls lean together: what lies in it slides to the middle.
const Collider k_left_wall{.shape = Plane{{1.0f, 0, 0.6f}, -2.0f}};
const Collider k_right_wall{.shape = Plane{{-1.0f, 0, 0.6f}, -2.0f}};

Blob block(const Material& material, const Vec3& center, const Vec3& velocity) {
  return {undamped(material), center, velocity, {5, 5, 4}};
}

std::vector<Case> cases_of_touch() {
  Material heavy = undamped(stuff(0.3f)), light = undamped(lasting(0.0f));
  Material jelly = undamped(stuff(0.3f));
  jelly.pressure_coefficient = 0.0f;
  heavy.particle_mass = 3.0f;
  heavy.friction = 0.8f;
  light.friction = 0.2f;
  return {
      {.name = "touch_elastic_head_on",
       .blobs = {block(lasting(0.0f), {0, 0, 0}, {0, 0, 1.2f}),
                 block(lasting(0.0f), {0.6f, 0.2f, 4.9f}, {0.4f, 0, -1.2f})},
       .solver = units(),
       .tolerance = 1e-3},
      {.name = "touch_unlike_on_slope",
       .blobs = {{heavy, {0, 0, 3.4f}, {0, 0, -0.4f}, {5, 5, 5}},
                 {light, {0.2f, 0.3f, 8.2f}, {0.5f, 0, -2}, {6, 5, 5}, 0.8f}},
       .colliders = {k_slope},
       .solver = units(),
       .updates = 1,
       .tolerance = 1e-3},
      {.name = "touch_fluid_on_held_block",
       .blobs = {{undamped(lasting(0.3f)), {0, 0, 0}, {0, 0, 0}, {7, 7, 3}},
                 {undamped(stuff(1.0f)), {0.4f, 0.3f, 4.4f}, {0.5f, 0, -1.5f}, {4, 4, 4}}},
       .solver = units(),
       .pins = {{{{-9, -9, -9}, {9, 9, -0.5f}}, {0.1f, 0, 0.1f}}},
       .tolerance = 1e-3},
      {.name = "touch_dough_and_jelly_full",
       .blobs = {block(jelly, {0, 0, 2.6f}, {0, 0, -0.4f}),
                 block(dough(0.0f, 0.03f), {0.3f, 0.4f, 7.2f}, {0, 0.3f, -2.0f})},
       .colliders = {k_slope},
       .solver = full(units(), 2),
       .tolerance = 1e-3},
      {.name = "touch_and_stick",
       .blobs = {block(sticky(lasting(0.0f), 0.4f), {0, 0, 0}, {0.3f, 0, 0.5f}),
                 block(sticky(lasting(0.0f), 0.4f), {0.6f, 0.2f, 4.6f}, {0, 0, -0.5f})},
       .solver = units(),
       .tolerance = 1e-3},
      {.name = "touch_three_in_trough",
       .blobs = {block(lasting(0.0f), {-3.2f, 0, 4.5f}, {0, 0, -1}),
                 block(stuff(0.4f), {3.2f, 0.3f, 4.5f}, {-0.5f, 0, -1}),
                 block(lasting(0.2f), {0, 0.2f, 8.6f}, {0, 0, -2})},
       .colliders = {k_left_wall, k_right_wall},
       .solver = units(),
       .updates = 1,
       .tolerance = 1e-3},
  };
}

std::vector<Case> cases_of_sinks() {
  Blob bar{undamped(lasting(0.0f)), {0, 0, 8.5f}, {0, 0, -3}, {12, 4, 4}};
  bar.splits = true;
  Material soft = undamped(dough(0.0f, 0.002f));
  soft.elastic_time_step = 0.6f;
  Blob left{soft, {-1.5f, 0, 0}, {-4, 0.2f, 0}, {3, 3, 3}}, right = left;
  left.splits = true;
  right.center = {1.5f, 0, 0};
  right.velocity = {4, 0, 0.2f};
  right.joins_the_one_before = true;
  SolverConfig weightless = units();
  weightless.gravity = {0, 0, 0};
  weightless.update_interval = 4;
  return {
      {.name = "sink_under_fluid",
       .blobs = {{undamped(stuff(1.0f)), {0, 0, 3.6f}, {-0.8f, 0.3f, -0.5f}}},
       .colliders = {k_tank},
       .solver = walled(),
       .drains = {{{{-9, -9, -9}, {-1.5f, 9, 2.0f}}}}},
      {.name = "sink_outside_of_a_box",
       .blobs = {{undamped(stuff(0.3f)), {0, 0, 4.2f}, {1.5f, 0, -1.5f}}},
       .colliders = {k_slope},
       .solver = units(),
       .drains = {{{{-9, -9, -9}, {5.5f, 9, 99}}, true}},
       .updates = 1},
      {.name = "torn_by_sink_in_trough",
       .blobs = {bar},
       .colliders = {k_left_wall, k_right_wall},
       .solver = units(),
       .drains = {{{{-1.2f, -9, 6.2f}, {1.2f, 9, 99}}}},
       .tolerance = 1e-3},
      {.name = "torn_by_pull_between_walls",
       .blobs = {left, right},
       .colliders = {{.shape = Plane{{1, 0, 0}, -7}, .restitution = 0.9f},
                     {.shape = Plane{{-1, 0, 0}, -7}, .restitution = 0.9f}},
       .solver = weightless,
       .updates = 1,
       .flows = true,
       .tolerance = 1e-3},
  };
}

}  // namespace

std::vector<Case> cases_of_contact() {
  std::vector<Case> all = cases_of_touch();
  for (Case& one : cases_of_sinks()) all.push_back(std::move(one));
  return all;
}

}  // namespace mallow
