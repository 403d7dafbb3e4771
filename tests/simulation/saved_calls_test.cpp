// Whatever is called between steps, a state that is saved right after it goes on as the original does.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "mallow/simulation.h"

namespace mallow {
namespace saved_calls_test {

std::vector<ParticleId> some(const Simulation& s, BodyId body, std::size_t every = 3) {
  std::vector<ParticleId> ids;
  const auto rows = s.rows(body);
  for (std::size_t row = rows.begin; row < rows.end; row += every) ids.push_back(s.ids()[row]);
  return ids;
}
Body cube(int n, float x, float z) {
  return sample(Lattice{.count = {n, n, n}, .corner = {x, 0, z}});
}

/// Two cubes on each other, a fluid, a warm one, a bar that yields, a strand; a floor, a ball and a sink.
struct World {
  Simulation s{{.time_step = 0.15f, .support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1}};
  MaterialId soft = s.add_material({.alpha = 0.2f}), liquid = s.add_material({.alpha = 1.0f}),
             heated = s.add_material(
                 {.alpha = 0.4f, .temperature = 300.0f, .conductivity = 1.0f, .specific_heat = 1.0f}),
             paste = s.add_material({.alpha = 0.1f, .plastic_yield = 0.05f});
  BodyId lower = s.add_body(cube(4, 0, 0.5f), soft), upper = s.add_body(cube(4, 0, 4.6f), soft),
         fluid = s.add_body(cube(4, 10, 0.5f), liquid), warm = s.add_body(cube(4, 20, 0.5f), heated),
         bar = s.add_body(sample(Lattice{.count = {4, 4, 16}, .corner = {30, 0, 0.5f}}), paste);
  ColliderId floor = s.add_collider({.shape = Plane{}, .friction = 0.5f, .measure_load = true}),
             ball = s.add_collider(
                 {.shape = Sphere{.center = {0, 0, 0}, .radius = 2}, .pose = {.translation = {-20, 0, 3}}});
  EmitterId nozzle = s.add_emitter(Emitter{.radius = 2.0f, .pose = {.translation = {50, 0, 20}}}, soft);
  SinkId sink = s.add_sink(Aabb{{-100, -100, -100}, {100, 100, -50}});

  explicit World(int steps) {
    s.report_contacts(0.0);
    for (int k = 0; k < steps; ++k) s.step();
  }
};

struct Call {
  const char* name;
  std::function<void(World&)> make;
};

const std::vector<Call> k_calls = {
    {"nothing", [](World&) {}},
    {"set_alpha ids fluid", [](World& w) { w.s.set_alpha(some(w.s, w.fluid), 0.3f); }},
    {"set_alpha ids solid to 1", [](World& w) { w.s.set_alpha(some(w.s, w.lower, 1), 1.0f); }},
    {"set_stiffness", [](World& w) { w.s.set_stiffness(some(w.s, w.lower), 0.3f); }},
    {"set_stiffness fluid", [](World& w) { w.s.set_stiffness(some(w.s, w.fluid), 0.3f); }},
    {"set_temperature", [](World& w) { w.s.set_temperature(some(w.s, w.warm), 400); }},
    {"set_temperature collider", [](World& w) { w.s.set_temperature(w.floor, Schedule(350.0f)); }},
    {"alpha mat to 1", [](World& w) { w.s.set_alpha(w.soft, 1.0f); }},
    {"alpha fluid to 0", [](World& w) { w.s.set_alpha(w.liquid, 0.0f); }},
    {"alpha schedule",
     [](World& w) {
       w.s.set_alpha(w.liquid, Schedule{{0, 1}, {100, 0}});
     }},
    {"material radius", [](World& w) { w.s.set_material(w.soft, {.alpha = 0.2f, .region_radius = 1.7f}); }},
    {"material stride", [](World& w) { w.s.set_material(w.soft, {.alpha = 0.2f, .region_stride = 3}); }},
    {"material yield on",
     [](World& w) { w.s.set_material(w.soft, {.alpha = 0.2f, .plastic_yield = 0.05f}); }},
    {"material heat on",
     [](World& w) {
       w.s.set_material(w.soft,
                        {.alpha = 0.2f, .temperature = 300.0f, .conductivity = 1, .specific_heat = 1});
     }},
    {"material heat off", [](World& w) { w.s.set_material(w.heated, {.alpha = 0.2f}); }},
    {"material alpha by T",
     [](World& w) {
       w.s.set_material(w.heated, {.temperature = 300.0f,
                                   .conductivity = 1,
                                   .specific_heat = 1,
                                   .alpha_by_temperature = Schedule{{300, 0}, {400, 1}}});
     }},
    {"material damping", [](World& w) { w.s.set_material(w.soft, {.alpha = 0.2f, .damping_time = 0.05f}); }},
    {"extend",
     [](World& w) {
       auto b = w.s.bounds(w.upper);
       w.s.extend_body(
           w.upper, sample(Lattice{.count = {3, 3, 2}, .corner = {b.min.x(), b.min.y(), b.max.z() + 0.7f}}));
     }},
    {"remove body", [](World& w) { w.s.remove_body(w.lower); }},
    {"remove fluid", [](World& w) { w.s.remove_body(w.fluid); }},
    {"remove particles", [](World& w) { w.s.remove_particles(some(w.s, w.lower)); }},
    {"tear",
     [](World& w) {
       w.s.remove_particles(Aabb{{25, -9, 5}, {40, 9, 9}});
     }},
    {"tear and split",
     [](World& w) {
       w.s.remove_particles(Aabb{{25, -9, 5}, {40, 9, 9}});
       w.s.split(w.bar);
     }},
    {"remove strand particles", [](World& w) { w.s.remove_particles(w.s.held(w.nozzle)); }},
    {"remove strand", [](World& w) { w.s.remove_body(w.s.body(w.nozzle)); }},
    {"pin",
     [](World& w) {
       w.s.pin(some(w.s, w.lower), {0.1f, 0, 0});
     }},
    {"pin unpin",
     [](World& w) {
       auto p = w.s.pin(some(w.s, w.lower));
       w.s.unpin(p);
     }},
    {"unpin emitter's", [](World& w) { w.s.unpin(PinId{0}); }},
    {"pin over emitter's", [](World& w) { w.s.pin(w.s.held(w.nozzle)); }},
    {"disable", [](World& w) { w.s.enable(w.lower, false); }},
    {"disable strand", [](World& w) { w.s.enable(w.s.body(w.nozzle), false); }},
    {"set_position",
     [](World& w) {
       w.s.set_position(w.lower, {5, 5, 9});
     }},
    {"set_position far",
     [](World& w) {
       w.s.set_position(w.lower, {5000, 5, 9});
     }},
    {"impulse",
     [](World& w) {
       w.s.add_impulse({1, 1, 2}, 4, {50, 0, 0});
     }},
    {"set_velocity",
     [](World& w) {
       w.s.set_velocity(w.lower, {1, 0, 1}, {0, 1, 0});
     }},
    {"set_velocity ids",
     [](World& w) {
       w.s.set_velocity(some(w.s, w.lower), {1, 0, 1});
     }},
    {"gravity",
     [](World& w) {
       w.s.set_gravity({0.1f, 0, -0.2f});
     }},
    {"gravity 0",
     [](World& w) {
       w.s.set_gravity({0, 0, 0});
     }},
    {"solver",
     [](World& w) {
       auto c = w.s.config();
       c.time_step_factor = 0.5f;
       c.neighbor_slack = 0.2f;
       w.s.set_solver(c);
     }},
    {"pose",
     [](World& w) {
       w.s.set_pose(w.ball, {.translation = {1, 1, 2}});
     }},
    {"twist",
     [](World& w) {
       w.s.set_twist(w.ball, {1, 0, 0}, {0, 0, 1});
     }},
    {"set_collider", [](World& w) { w.s.set_collider(w.floor, {.shape = Plane{.offset = 0.5f}}); }},
    {"remove_collider", [](World& w) { w.s.remove_collider(w.floor); }},
    {"add_collider",
     [](World& w) {
       w.s.add_collider({.shape = Box{{-3, -3, 5}, {3, 3, 6}}});
     }},
    {"remove emitter", [](World& w) { w.s.remove_emitter(w.nozzle); }},
    {"add emitter",
     [](World& w) {
       w.s.add_emitter(Emitter{.radius = 2.0f, .pose = {.translation = {80, 0, 20}}}, w.liquid);
     }},
    {"set_flow",
     [](World& w) {
       w.s.set_flow(w.nozzle, Schedule{{0, 1}, {9, 0}}, {0.1f, 0, 0});
     }},
    {"remove sink", [](World& w) { w.s.remove_sink(w.sink); }},
    {"sink",
     [](World& w) {
       w.s.add_sink(Aabb{{-9, -9, 0}, {9, 9, 3}});
     }},
    {"no reports", [](World& w) { w.s.report_contacts(std::nullopt); }},
    {"report one", [](World& w) { w.s.report_contacts(w.lower, 3.0); }},
    {"wake", [](World& w) { w.s.wake(w.lower); }},
    {"add body",
     [](World& w) {
       w.s.add_body(sample(Lattice{.count = {3, 3, 3}, .corner = {-40, 0, 1}}), w.soft);
     }},
    {"add painted",
     [](World& w) {
       Body b = sample(Lattice{.count = {3, 3, 3}, .corner = {-40, 0, 1}});
       for (size_t i = 0; i < b.positions.size(); ++i) {
         b.alpha.push_back(i % 2 ? 1.f : 0.2f);
       }
       w.s.add_body(b, w.soft);
     }},
    {"merging",
     [](World& w) {
       for (int k = 0; k < 2; ++k) {
         Body b = sample(Lattice{.count = {3, 3, 3}, .corner = {-40, 0, 1 + 3 * static_cast<float>(k)}});
         b.merges = true;
         w.s.add_body(b, w.liquid);
       }
     }},
    {"all gone",
     [](World& w) {
       for (BodyId b : w.s.bodies()) w.s.remove_body(b);
     }},
};

/// What a step did, or why it did not.
std::string told_step(Simulation& s) {
  std::ostringstream told;
  try {
    s.step();
  } catch (const std::exception& error) {
    told << error.what();
  }
  for (const BodyEvent& event : s.events())
    told << static_cast<int>(event.kind) << ':' << static_cast<std::uint64_t>(event.body) << ' ';
  return told.str();
}

TEST(saved_state, right_after_any_call_goes_on_with_the_same_bits_and_events) {
  for (const int steps : {0, 40})
    for (const Call& call : k_calls) {
      SCOPED_TRACE(std::to_string(steps) + " steps, then " + call.name);
      World world(steps);
      call.make(world);
      Simulation restored = Simulation::restore(world.s.save(), 2);
      ASSERT_EQ(restored.state_hash(), world.s.state_hash());
      for (int k = 0; k < 12; ++k) {
        ASSERT_EQ(told_step(restored), told_step(world.s)) << k;
        ASSERT_EQ(restored.state_hash(), world.s.state_hash()) << k;
      }
    }
}

}  // namespace saved_calls_test
}  // namespace mallow
