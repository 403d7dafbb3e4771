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

/// A cube that is there, one that was, a warm one, and a fluid; a floor; two nozzles of which one is gone.
struct Crowd {
  Simulation s{{.support_radius = 2.1f, .gravity = {0, 0, -0.3f}, .threads = 1}};
  BodyId there, gone, fluid;
  ColliderId floor;
  EmitterId nozzle, gone_nozzle;

  Crowd() {
    there = s.add_body(cube(0), Material{.alpha = 0.3f}, "there");
    gone = s.add_body(cube(20), Material{}, "gone");
    fluid = s.add_body(cube(40), Material{.alpha = 1.0f}, "fluid");
    const MaterialId jelly = s.add_material({.alpha = 0.5f});
    const auto place = [](double x) { return Emitter{.radius = 2.0f, .pose = {.translation = {x, 0, 30}}}; };
    nozzle = s.add_emitter(place(0), jelly);
    gone_nozzle = s.add_emitter(place(20), jelly);
    floor = s.add_collider({.shape = Plane{}});
    for (int k = 0; k < 5; ++k) s.step();
    s.remove_body(gone);
    s.remove_emitter(gone_nozzle);
    s.step();
  }
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
      {"material_settings", [](Crowd& crowd) { crowd.s.material_settings(MaterialId{99}); }, "99"},
      {"alpha", [](Crowd& crowd) { crowd.s.alpha(ParticleId{1u << 20}); }, "particle"},
      {"rest_position", [](Crowd& crowd) { crowd.s.rest_position(ParticleId{1u << 20}); }, "particle"},
      {"move_pin",
       [](Crowd& crowd) {
         const ParticleId first[] = {crowd.s.ids()[0]};
         const PinId pin = crowd.s.pin(first);
         try {
           crowd.s.move_pin(pin, {0, k_nan, 0}, 1);
         } catch (...) {
           crowd.s.unpin(pin);
           throw;
         }
       },
       "pin"},
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
