// What applications ask for of what is not there, or with numbers that mean nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mallow/simulation.h"
#include "refusal.h"

namespace mallow {
namespace refusals_test {

using test::refusal;

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();
constexpr float k_infinity = std::numeric_limits<float>::infinity();

Body cube(float x) {
  return sample(Lattice{.count = {4, 4, 4}, .corner = {x, 0, 1}, .jitter = 0});
}

/// A cube that is there, one that was, and a fluid; a floor, two nozzles, two sinks and two pins, of each of
/// which one more was there.
struct Crowd {
  Simulation s{{.support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1}};
  BodyId there, gone, fluid;
  ColliderId floor, gone_wall;
  EmitterId nozzle, gone_nozzle;
  PinId held, let_go;
  SinkId gone_sink;
  ParticleId gone_particle;

  Crowd() {
    there = s.add_body(cube(0), Material{.alpha = 0.3f}, "there");
    gone = s.add_body(cube(20), Material{}, "gone");
    fluid = s.add_body(cube(40), Material{.alpha = 1.0f}, "fluid");
    const MaterialId jelly = s.add_material({.alpha = 0.5f});
    const auto place = [](double x) { return Emitter{.radius = 2.0f, .pose = {.translation = {x, 0, 30}}}; };
    nozzle = s.add_emitter(place(0), jelly);
    gone_nozzle = s.add_emitter(place(20), jelly);
    floor = s.add_collider({.shape = Plane{}});
    gone_wall = s.add_collider({.shape = Plane{.normal = {0, 1, 0}, .offset = -90}});
    gone_sink = s.add_sink({{0, 0, -90}, {1, 1, -80}});
    held = s.pin(std::vector<ParticleId>{first()});
    let_go = s.pin(std::vector<ParticleId>{s.ids()[1]});
    for (int k = 0; k < 5; ++k) s.step();
    gone_particle = s.ids()[s.rows(gone).begin];
    s.remove_body(gone);
    s.remove_emitter(gone_nozzle);
    s.remove_collider(gone_wall);
    s.remove_sink(gone_sink);
    s.unpin(let_go);
    s.step();
  }
  ParticleId first() const { return s.ids()[0]; }
};

struct Call {
  const char* name;
  std::function<void(Crowd&)> make;
  const char* says;  ///< part of what it is refused with
};

/// A call with a body that was removed, and with one that never was.
void add_stale(std::vector<Call>& calls, const char* name,
               const std::function<void(Simulation&, BodyId)>& make) {
  calls.push_back({name, [make](Crowd& crowd) { make(crowd.s, crowd.gone); }, "body 1 was removed"});
  calls.push_back({name, [make](Crowd& crowd) { make(crowd.s, BodyId{77}); }, "there is no body 77"});
}

std::vector<Call> calls_with_bodies() {
  std::vector<Call> calls;
  add_stale(calls, "bounds", [](Simulation& s, BodyId id) { s.bounds(id); });
  add_stale(calls, "motion", [](Simulation& s, BodyId id) { s.motion(id); });
  add_stale(calls, "energy", [](Simulation& s, BodyId id) { s.energy(id); });
  add_stale(calls, "volume", [](Simulation& s, BodyId id) { s.volume(id); });
  add_stale(calls, "wake", [](Simulation& s, BodyId id) { s.wake(id); });
  add_stale(calls, "is_awake", [](Simulation& s, BodyId id) { s.is_awake(id); });
  add_stale(calls, "enable", [](Simulation& s, BodyId id) { s.enable(id, false); });
  add_stale(calls, "is_enabled", [](Simulation& s, BodyId id) { s.is_enabled(id); });
  add_stale(calls, "user_data", [](Simulation& s, BodyId id) { s.user_data(id); });
  add_stale(calls, "set_user_data", [](Simulation& s, BodyId id) { s.set_user_data(id, 7); });
  add_stale(calls, "name", [](Simulation& s, BodyId id) { s.name(id); });
  add_stale(calls, "spacing", [](Simulation& s, BodyId id) { s.spacing(id); });
  add_stale(calls, "heat", [](Simulation& s, BodyId id) { s.heat(id); });
  add_stale(calls, "set_velocity", [](Simulation& s, BodyId id) { s.set_velocity(id, Vec3{0, 0, 1}); });
  add_stale(calls, "rotations", [](Simulation& s, BodyId id) { s.rotations(id); });
  add_stale(calls, "rest_positions", [](Simulation& s, BodyId id) { s.rest_positions(id); });
  add_stale(calls, "rows", [](Simulation& s, BodyId id) { s.rows(id); });
  add_stale(calls, "material", [](Simulation& s, BodyId id) { s.material(id); });
  add_stale(calls, "remove_body", [](Simulation& s, BodyId id) { s.remove_body(id); });
  add_stale(calls, "extend_body", [](Simulation& s, BodyId id) { s.extend_body(id, cube(60)); });
  add_stale(calls, "split", [](Simulation& s, BodyId id) { s.split(id); });
  add_stale(calls, "set_position", [](Simulation& s, BodyId id) { s.set_position(id, {0, 0, 9}); });
  add_stale(calls, "add_impulse", [](Simulation& s, BodyId id) { s.add_impulse(id, {0, 0, 1}); });
  add_stale(calls, "report_contacts", [](Simulation& s, BodyId id) { s.report_contacts(id, 1.0); });
  return calls;
}

/// A call with another id that named something, and with one that never did.
template <class Id>
void add_gone(std::vector<Call>& calls, const char* name, Id Crowd::*gone, const char* says,
              const std::function<void(Simulation&, Id)>& make) {
  calls.push_back({name, [make, gone](Crowd& crowd) { make(crowd.s, crowd.*gone); }, says});
  calls.push_back({name, [make](Crowd& crowd) { make(crowd.s, Id{77}); }, "there is no "});
}

std::vector<Call> calls_with_other_ids() {
  std::vector<Call> calls;
  const auto wall = [&](const char* name, const std::function<void(Simulation&, ColliderId)>& make) {
    add_gone(calls, name, &Crowd::gone_wall, "collider 1 was removed", make);
  };
  wall("collider", [](Simulation& s, ColliderId id) { s.collider(id); });
  wall("load", [](Simulation& s, ColliderId id) { s.load(id); });
  wall("set_collider", [](Simulation& s, ColliderId id) { s.set_collider(id, {}); });
  wall("remove_collider", [](Simulation& s, ColliderId id) { s.remove_collider(id); });
  wall("set_temperature", [](Simulation& s, ColliderId id) { s.set_temperature(id, Schedule(300)); });
  wall("set_velocity", [](Simulation& s, ColliderId id) { s.set_velocity(id, {0, 0, 1}); });
  wall("set_twist", [](Simulation& s, ColliderId id) { s.set_twist(id, {0, 0, 1}, {0, 0, 1}); });
  wall("set_pose", [](Simulation& s, ColliderId id) { s.set_pose(id, {}); });
  const auto nozzle = [&](const char* name, const std::function<void(Simulation&, EmitterId)>& make) {
    add_gone(calls, name, &Crowd::gone_nozzle, "there is no emitter 1, or no longer", make);
  };
  nozzle("body", [](Simulation& s, EmitterId id) { s.body(id); });
  nozzle("emitter", [](Simulation& s, EmitterId id) { s.emitter(id); });
  nozzle("held", [](Simulation& s, EmitterId id) { s.held(id); });
  nozzle("set_flow", [](Simulation& s, EmitterId id) { s.set_flow(id, 1.0f); });
  nozzle("remove_emitter", [](Simulation& s, EmitterId id) { s.remove_emitter(id); });
  const auto pin = [&](const char* name, const std::function<void(Simulation&, PinId)>& make) {
    add_gone(calls, name, &Crowd::let_go, "pin 3 was removed", make);
  };
  pin("unpin", [](Simulation& s, PinId id) { s.unpin(id); });
  pin("set_velocity", [](Simulation& s, PinId id) { s.set_velocity(id, {0, 0, 1}); });
  pin("move_pin", [](Simulation& s, PinId id) { s.move_pin(id, {0, 0, 1}, 1); });
  add_gone<SinkId>(calls, "remove_sink", &Crowd::gone_sink, "there is no sink 0, or no longer",
                   [](Simulation& s, SinkId id) { s.remove_sink(id); });
  const auto particle = [&](const char* name, const std::function<void(Simulation&, ParticleId)>& make) {
    calls.push_back({name, [make](Crowd& crowd) { make(crowd.s, crowd.gone_particle); }, " was removed"});
    calls.push_back({name, [make](Crowd& crowd) { make(crowd.s, ParticleId{1u << 20}); }, "there is no"});
  };
  particle("row", [](Simulation& s, ParticleId id) { s.row(id); });
  particle("alpha", [](Simulation& s, ParticleId id) { s.alpha(id); });
  particle("rotation", [](Simulation& s, ParticleId id) { s.rotation(id); });
  particle("rest_position", [](Simulation& s, ParticleId id) { s.rest_position(id); });
  const auto particles = [&](const char* name,
                             const std::function<void(Simulation&, std::span<const ParticleId>)>& make) {
    particle(name, [make](Simulation& s, ParticleId id) {
      make(s, std::vector<ParticleId>{s.ids()[0], id});  // the first of them is there
    });
  };
  particles("remove_particles",
            [](Simulation& s, std::span<const ParticleId> ids) { s.remove_particles(ids); });
  particles("pin", [](Simulation& s, std::span<const ParticleId> ids) { s.pin(ids); });
  particles("set_alpha", [](Simulation& s, std::span<const ParticleId> ids) { s.set_alpha(ids, 0.5f); });
  particles("set_stiffness", [](Simulation& s, std::span<const ParticleId> ids) { s.set_stiffness(ids, 1); });
  particles("set_velocity", [](Simulation& s, std::span<const ParticleId> ids) {
    s.set_velocity(ids, {0, 0, 1});
  });
  calls.push_back({"set_temperature",
                   [](Crowd& crowd) {
                     const ParticleId gone[] = {crowd.gone_particle};
                     crowd.s.set_temperature(gone, 300);
                   },
                   " was removed"});
  const auto matter = [&](const char* name, const std::function<void(Simulation&, MaterialId)>& make) {
    calls.push_back(
        {name, [make](Crowd& crowd) { make(crowd.s, MaterialId{99}); }, "there is no material 99"});
  };
  matter("add_body", [](Simulation& s, MaterialId id) { s.add_body(cube(60), id); });
  matter("add_emitter", [](Simulation& s, MaterialId id) { s.add_emitter({.radius = 2.0f}, id); });
  matter("set_material", [](Simulation& s, MaterialId id) { s.set_material(id, {}); });
  matter("material_settings", [](Simulation& s, MaterialId id) { s.material_settings(id); });
  matter("set_alpha", [](Simulation& s, MaterialId id) { s.set_alpha(id, 0.5f); });
  return calls;
}

std::vector<Call> calls_with_numbers() {
  const double endless = std::numeric_limits<double>::infinity();
  const auto cast = [](const Vec3& from, const Vec3& along, double farthest) {
    return [=](Crowd& crowd) { crowd.s.raycast_colliders(from, along, farthest); };
  };
  const auto look = [](const Aabb& box) { return [=](Crowd& crowd) { crowd.s.particles_in(box); }; };
  const auto flow = [](bool gone, const Schedule& speed, const Vec3& velocity) {
    return [=](Crowd& crowd) { crowd.s.set_flow(gone ? crowd.gone_nozzle : crowd.nozzle, speed, velocity); };
  };
  return {
      {"raycast_colliders", cast({k_nan, 0, 0}, {0, 0, -1}, endless), "origin"},
      {"raycast_colliders", cast({0, 0, 9}, {0, k_infinity, 0}, endless), "direction"},
      {"raycast_colliders", cast({0, 0, 9}, {0, 0, 0}, endless), "direction: must not be 0"},
      {"raycast_colliders", cast({0, 0, 9}, {0, 0, -1}, -1), "farthest: must be 0 or above"},
      {"raycast_colliders", cast({0, 0, 9}, {0, 0, -1}, std::nan("")), "farthest: must be 0 or above"},
      {"particles_in", look({{0, k_nan, 0}, {1, 1, 1}}), "box: min must not be above max"},
      {"particles_in", look({{0, 0, 0}, {1, 1, k_nan}}), "box: min must not be above max"},
      {"particles_in", look({{0, 0, 2}, {1, 1, 1}}), "box: min must not be above max"},
      {"set_flow", flow(true, 1.0f, {0, 0, 0}), "there is no emitter 1, or no longer"},
      {"set_flow", flow(false, -1.0f, {0, 0, 0}), "emitter.speed"},
      {"set_flow", flow(false, k_nan, {0, 0, 0}), "emitter.speed"},
      {"set_flow", flow(false, 1.0f, {0, k_nan, 0}), "emitter.velocity"},
      {"set_gravity",
       [](Crowd& crowd) {
         crowd.s.set_gravity({0, 0, k_nan});
       },
       "solver.gravity"},
      {"set_velocity",
       [](Crowd& crowd) {
         crowd.s.set_velocity(crowd.there, {0, 0, 0}, {k_nan, 0, 0});
       },
       "body.angular_velocity"},
      {"set_velocity",
       [](Crowd& crowd) {
         crowd.s.set_velocity(crowd.there, {0, 1e30f, 0});
       },
       "body.velocity: 1e+30 m/s is not allowed: no step carries more than"},
      {"set_velocity",
       [](Crowd& crowd) {
         crowd.s.set_velocity(crowd.there, {0, 0, 0}, {0, 0, 1e30f});
       },
       "body.velocity"},
      {"set_velocity",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.s.ids()[0]};
         crowd.s.set_velocity(first, {3e38f, 3e38f, 3e38f});
       },
       "velocity: 5.19615e+38 m/s"},
      {"add_impulse",
       [](Crowd& crowd) {
         crowd.s.add_impulse(crowd.there, {0, 0, 1e30f});
       },
       "impulse: "},
      {"add_impulse",
       [](Crowd& crowd) {
         crowd.s.add_impulse({1, 1, 2}, 2, {0, 0, 1e30f});
       },
       "impulse: "},
      {"set_flow", flow(false, 1e30f, {0, 0, 0}), "emitter.speed: 1e+30 m/s"},
      {"pin",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.s.ids()[0]};
         crowd.s.pin(first, {0, 1e6f, 0});
       },
       "pin.velocity: 1e+06 m/s is not allowed: no step carries more than"},
      {"add_body",
       [](Crowd& crowd) {
         Body fast = cube(60);
         fast.velocity = {0, 0, 1e6f};
         crowd.s.add_body(fast, Material{});
       },
       "body.velocity: 1e+06 m/s"},
      {"extend_body",
       [](Crowd& crowd) {
         Body fast = cube(60);
         fast.velocities.assign(fast.positions.size(), {1e6f, 0, 0});
         crowd.s.extend_body(crowd.there, fast);
       },
       "body.velocity: 1e+06 m/s"},
      {"set_pose", [endless](Crowd& crowd) { crowd.s.set_pose(crowd.floor, {}, endless); },
       "seconds: inf is not allowed: a finite number, 0 or above"},
      {"set_temperature",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.s.ids()[0]};
         crowd.s.set_temperature(first, k_nan);
       },
       "temperature"},
      {"set_stiffness",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.s.ids()[0]};
         crowd.s.set_stiffness(first, -1);
       },
       "stiffness"},
      {"set_alpha",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.first()};
         crowd.s.set_alpha(first, 1.5f);
       },
       "alpha"},
      {"set_alpha", [](Crowd& crowd) { crowd.s.set_alpha(crowd.s.material(crowd.there), -1); }, "alpha"},
      {"move_pin",
       [](Crowd& crowd) {
         crowd.s.move_pin(crowd.held, {0, k_nan, 0}, 1);
       },
       "pin.way"},
      {"move_pin",
       [](Crowd& crowd) {
         crowd.s.move_pin(crowd.held, {0, 1, 0}, 0);
       },
       "pin.seconds"},
      {"move_pin",
       [](Crowd& crowd) {
         crowd.s.move_pin(crowd.held, {0, 1e6f, 0}, 1e-3);
       },
       "pin.way: "},
      {"set_velocity",
       [](Crowd& crowd) {
         crowd.s.set_velocity(crowd.held, {0, k_nan, 0});
       },
       "pin.velocity"},
      {"set_velocity",
       [](Crowd& crowd) {
         crowd.s.set_velocity(crowd.floor, {0, k_nan, 0});
       },
       "collider.velocity"},
      {"set_twist",
       [](Crowd& crowd) {
         crowd.s.set_twist(crowd.floor, {0, 0, 0}, {0, 0, k_infinity});
       },
       "collider.angular_velocity"},
      {"set_pose",
       [](Crowd& crowd) {
         crowd.s.set_pose(crowd.floor, {.rotation = {0, 0, 0, 0}});
       },
       "collider.pose.rotation"},
      {"set_temperature", [](Crowd& crowd) { crowd.s.set_temperature(crowd.floor, Schedule(k_nan)); },
       "collider.temperature"},
      {"set_position",
       [](Crowd& crowd) {
         crowd.s.set_position(crowd.there, {0, k_nan, 0});
       },
       "body.center"},
      {"set_position",
       [](Crowd& crowd) {
         crowd.s.set_position(crowd.there, {0, 1e20f, 0});
       },
       "body.center"},
      {"set_material",
       [](Crowd& crowd) { crowd.s.set_material(crowd.s.material(crowd.there), {.alpha = 2.0f}); }, "alpha"},
      {"set_solver",
       [](Crowd& crowd) {
         SolverConfig config = crowd.s.config();
         config.time_step_factor = -1;
         crowd.s.set_solver(config);
       },
       "solver.time_step_factor"},
      {"set_collider", [](Crowd& crowd) { crowd.s.set_collider(crowd.floor, {.friction = -1}); }, "friction"},
      {"load", [](Crowd& crowd) { crowd.s.load(crowd.floor); }, "are not measured"},
      {"add_collider", [](Crowd& crowd) { crowd.s.add_collider({.shape = Sphere{.radius = 0}}); }, "radius"},
      {"add_material", [](Crowd& crowd) { crowd.s.add_material({.alpha = k_nan}); }, "alpha"},
      {"add_emitter", [](Crowd& crowd) { crowd.s.add_emitter({}, crowd.s.material(crowd.there)); },
       "emitter.radius"},
      {"add_sink",
       [](Crowd& crowd) {
         crowd.s.add_sink({{0, 0, 0}, {1, 1, k_infinity}});
       },
       "sink.box.max"},
      {"pin",
       [](Crowd& crowd) {
         crowd.s.pin(Aabb{{500, 0, 0}, {501, 1, 1}});
       },
       "no particle is between"},
      {"remove_particles",
       [](Crowd& crowd) {
         crowd.s.remove_particles(Aabb{{500, 0, 0}, {501, 1, 1}});
       },
       "no particle is between"},
      {"remove_particles",
       [](Crowd& crowd) { crowd.s.remove_particles(std::vector<ParticleId>(2, crowd.first())); },
       "is given twice"},
      {"add_impulse",
       [](Crowd& crowd) {
         crowd.s.add_impulse({1, 1, 2}, 0, {0, 0, 1});
       },
       "radius"},
      {"report_contacts", [](Crowd& crowd) { crowd.s.report_contacts(-1); }, "impulse"},
      {"raycast",
       [](Crowd& crowd) {
         crowd.s.raycast({0, 0, 9}, {0, 0, 0});
       },
       "direction: must not be 0"},
      {"raycast",
       [](Crowd& crowd) {
         crowd.s.raycast({0, k_nan, 9}, {0, 0, -1}, -1);
       },
       "farthest: must be 0 or above"},
      {"particles_in",
       [](Crowd& crowd) {
         crowd.s.particles_in({0, 0, 0}, 0);
       },
       "radius"},
      {"nearest_particle",
       [](Crowd& crowd) {
         crowd.s.nearest_particle({0, k_nan, 0});
       },
       "point"},
      {"step_towards", [](Crowd& crowd) { crowd.s.step_towards(crowd.s.time()); }, "time"},
      {"advance", [](Crowd& crowd) { crowd.s.advance(-1); }, "seconds"},
      {"rotations", [](Crowd& crowd) { crowd.s.rotations(crowd.fluid); },
       "'fluid', which has no reference shape"},
  };
}

void expect_refused(const std::vector<Call>& calls) {
  Crowd crowd, undisturbed;
  for (const Call& call : calls) {
    const std::string text = refusal([&] { call.make(crowd); });
    EXPECT_NE(text.find(call.says), std::string::npos) << call.name << ": " << text;
    EXPECT_EQ(crowd.s.state_hash(), undisturbed.s.state_hash()) << call.name;
  }
  for (int k = 0; k < 10; ++k) {
    crowd.s.step();
    undisturbed.s.step();
  }
  EXPECT_EQ(crowd.s.state_hash(), undisturbed.s.state_hash());
}

TEST(refusals, of_bodies_that_are_gone_or_never_were_change_nothing) {
  expect_refused(calls_with_bodies());
}

TEST(refusals, of_other_ids_that_are_gone_or_never_were_change_nothing) {
  expect_refused(calls_with_other_ids());
}

TEST(refusals, of_numbers_that_mean_nothing_change_nothing) {
  expect_refused(calls_with_numbers());
}

TEST(reads, of_a_const_simulation_are_all_there_and_change_no_later_step) {
  Crowd crowd, undisturbed;
  const Simulation& s = crowd.s;
  EXPECT_FALSE(s.find_body("nobody"));
  EXPECT_FALSE(s.find_body("gone"));
  EXPECT_EQ(s.find_body("there"), crowd.there);
  EXPECT_EQ(s.heat(crowd.there), 0) << "it carries none";
  EXPECT_EQ(s.particles_in(Aabb{Vec3::Constant(-k_infinity), Vec3::Constant(k_infinity)}).size(),
            s.particle_count());
  EXPECT_TRUE(s.particles_in(Aabb{{500, 0, 0}, {500, 0, 0}}).empty());
  EXPECT_EQ(s.raycast_colliders({5, 5, 5}, {0, 0, -2})->collider, crowd.floor);
  EXPECT_EQ(s.info().particles, s.particle_count());
  const Energy all = s.energy(), one = s.energy(crowd.there);
  EXPECT_GT(all.kinetic, one.kinetic);
  EXPECT_NEAR(one.kinetic, s.motion(crowd.there).kinetic_energy, 1e-12 * one.kinetic);
  crowd.s.step();
  undisturbed.s.step();
  EXPECT_EQ(crowd.s.state_hash(), undisturbed.s.state_hash());
}

}  // namespace refusals_test
}  // namespace mallow
