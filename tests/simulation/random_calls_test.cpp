#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/simulation.h"

/// Calls that nobody would make in this order, between steps: what comes out is finite, and the same whether
/// the simulation was saved and restored in between or not, on any number of threads.
namespace mallow {
namespace random_calls_test {

class Caller {
 public:
  Caller(unsigned seed, int threads, float slack) : random_(seed), seed_(seed) {
    SolverConfig config{.time_step = 0.15f,
                        .support_radius = 2.1f,
                        .gravity = {0, 0, -0.3f},
                        .neighbor_slack = slack,
                        .threads = threads};
    config.sleep_speed = 0.2f;  // so that bodies sleep and wake often
    config.sleep_time = 1.0f;
    config.volume_iterations = static_cast<int>(seed % 3);  // in two of three
    if (joins()) config.update_interval = 5;
    s_ = std::make_unique<Simulation>(config);
    s_->add_collider({.shape = Box{{-20, -20, 0}, {20, 20, 80}, true}, .friction = 0.5f});
    for (const float alpha : {0.0f, 0.5f, 1.0f}) {
      Material material{.alpha = alpha,
                        .viscosity = 0.5f,
                        .temperature = seed % 2 ? 300.0f : std::optional<float>{},
                        .conductivity = 1,
                        .specific_heat = 1};
      if (joins()) {
        material.plastic_yield = 0.02f;
        material.merge_flow = 0;
      }
      s_->add_material(material);
    }
    add_body();
  }

  void call() {
    const std::vector<BodyId> bodies = s_->bodies();
    const auto body = [&] { return bodies[pick(bodies.size())]; };
    switch (pick(26)) {
      case 0:
      case 1:
        if (bodies.size() < 12) add_body();
        break;
      case 2:
        if (bodies.size() > 1) s_->remove_body(body());
        break;
      case 3: {
        const std::vector<ParticleId> ids(s_->ids().begin(), s_->ids().end());
        std::vector<ParticleId> some;
        for (const ParticleId id : ids)
          if (pick(20) == 0) some.push_back(id);
        if (some.size() < ids.size()) s_->remove_particles(some);
        break;
      }
      case 4: {
        const BodyId of = body();
        const Aabb box = s_->bounds(of);
        try {
          s_->extend_body(of, cube(3, {box.min.x(), box.min.y(), box.max.z() + 0.6f}));
        } catch (const ConfigError&) {
          // Something is there already.
        }
        break;
      }
      case 5:
        s_->set_velocity(body(), {number(2), number(2), number(2)}, {number(0.3f), 0, number(0.3f)});
        break;
      case 6:
        s_->add_impulse({number(15), number(15), 5}, 6, {number(100), number(100), 50});
        break;
      case 7:
        s_->enable(body(), pick(2) == 0);
        break;
      case 8: {
        const Simulation::Rows rows = s_->rows(body());
        std::vector<ParticleId> ids;
        for (std::size_t row = rows.begin; row < rows.end; row += 7) ids.push_back(s_->ids()[row]);
        pins_.push_back(s_->pin(ids, {number(0.3f), 0, 0}));
        break;
      }
      case 9:
        if (pins_.empty()) break;
        s_->unpin(pins_.back());
        pins_.pop_back();
        break;
      case 10:
        if (!pins_.empty()) s_->move_pin(pins_.back(), {number(3), number(3), 1}, 2);
        break;
      case 11:
        s_->set_gravity({number(0.1f), 0, -0.3f});
        break;
      case 12: {
        Material material{.alpha = 0.5f * static_cast<float>(pick(3)), .viscosity = 0.5f};
        if (pick(3) == 0) material.region_radius = 1.7f;
        if (pick(2) == 0) material.plastic_yield = 0.1f * static_cast<float>(pick(3));
        if (material.plastic_yield && pick(2) == 0) material.plastic_creep = 0.5f;
        if (pick(4) == 0) material.damping_time = 0.05f;
        if (s_->material_settings(MaterialId{0}).temperature) {
          material.temperature = 300.0f;
          material.conductivity = 1;
          material.specific_heat = 1;
          if (pick(3) == 0)
            material.alpha_by_temperature = Schedule{{300, material.alpha.lowest()}, {400, 1}};
          if (pick(3) == 0) material.viscosity_by_temperature = Schedule{{300, 1}, {400, 0.1f}};
        }
        s_->set_material(MaterialId{static_cast<std::uint32_t>(pick(3))}, material);
        break;
      }
      case 13: {
        if (emitters_.size() == 2) {
          s_->remove_emitter(emitters_.front());
          emitters_.erase(emitters_.begin());
        }
        Emitter emitter{
            .radius = 1.6f, .velocity = {number(0.5f), 0, 0}, .most_particles = 300, .merges = joins()};
        emitter.pose.translation = {number(10), number(10), 40};
        emitter.pose.rotation = {1, 0, 0, 0};
        try {
          emitters_.push_back(s_->add_emitter(emitter, MaterialId{static_cast<std::uint32_t>(pick(3))}));
        } catch (const ConfigError&) {
          // Something is there already.
        }
        break;
      }
      case 14:
        if (sinks_.size() == 2) {
          s_->remove_sink(sinks_.front());
          sinks_.erase(sinks_.begin());
        }
        sinks_.push_back(s_->add_sink(Aabb{{number(10) - 15, -20, -1}, {number(10) + 10, 20, 0.4f}}));
        break;
      case 15:
        if (colliders_.size() == 3) {
          s_->remove_collider(colliders_.front());
          colliders_.erase(colliders_.begin());
        }
        colliders_.push_back(s_->add_collider({.shape = Sphere{.center = {0, 0, 0}, .radius = 3},
                                               .pose = {.translation = {number(15), number(15), 3}},
                                               .velocity = {number(0.5f), 0, 0},
                                               .angular_velocity = {0, 0, number(1)}}));
        break;
      case 16:
        if (!colliders_.empty()) s_->set_pose(colliders_.back(), {.translation = {number(9), 0, 2}}, 1.5);
        break;
      case 17:
        s_->set_position(body(), {number(12), number(12), 20 + number(8)});
        break;
      case 18:
        if (pick(3) == 0)
          s_->report_contacts(std::nullopt);
        else
          s_->report_contacts(5.0);
        break;
      case 19:
        if (pick(3) == 0)
          s_->report_contacts(body(), std::nullopt);
        else
          s_->report_contacts(body(), 0.0);
        break;
      case 20:
        try {
          s_->set_alpha(some_of(body()), 0.5f * static_cast<float>(pick(3)));
        } catch (const ConfigError&) {
          // Too stiff, or alpha follows temperature.
        }
        break;
      case 21:
        try {
          s_->set_stiffness(some_of(body()), 0.5f * static_cast<float>(pick(4)));
        } catch (const ConfigError&) {
          // Too stiff, or alpha follows temperature.
        }
        break;
      case 22:
        try {
          s_->set_temperature(some_of(body()), number(1000));
        } catch (const ConfigError&) {
          // It carries no heat.
        }
        break;
      case 23:
        s_->set_temperature(s_->collider_ids().front(),
                            pick(2) == 0 ? std::nullopt : std::optional<Schedule>(number(1000)));
        break;
      case 24:
        s_->split(body());
        break;
      case 25:
        if (!colliders_.empty())
          s_->set_collider(colliders_.back(), {.shape = Sphere{.center = {0, 0, 0}, .radius = 2 + number(1)},
                                               .pose = {.translation = {number(15), number(15), 3}},
                                               .friction = 0.5f});
        break;
      default:
        break;
    }
    // An emitter goes with its strand.
    std::erase_if(emitters_, [&](EmitterId id) {
      try {
        s_->rows(s_->body(id));
        return false;
      } catch (const ConfigError&) {
        return true;
      }
    });
  }
  void step() {
    for (int k = 0; k < 4; ++k) {
      s_->step();
      for (const BodyEvent& event : s_->events()) {
        joined_ += event.kind == BodyEvent::Kind::merged && event.other;
        events_ << static_cast<int>(event.kind) << ' ' << static_cast<std::uint64_t>(event.body) << ' '
                << event.parts << ' ' << static_cast<std::uint64_t>(event.other.value_or(BodyId{9999})) << ' '
                << static_cast<std::uint64_t>(event.collider.value_or(ColliderId{9999})) << ' '
                << event.position.transpose() << ' ' << event.normal.transpose() << ' '
                << event.impulse.transpose() << ' ' << event.speed << '\n';
      }
    }
    if (s_->body_count() == 0) add_body();
  }
  /// Of all steps, as text.
  std::string events() const { return events_.str(); }
  void restart(int threads) { *s_ = Simulation::restore(s_->save(), threads); }
  const Simulation& simulation() const { return *s_; }
  /// How many bodies have become part of others.
  std::size_t joined() const { return joined_; }

 private:
  /// Bodies become one as soon as they touch.
  bool joins() const { return seed_ % 3 == 0; }
  std::size_t pick(std::size_t below) { return random_() % below; }
  float number(float most) { return most * (static_cast<float>(random_() % 2001) / 1000 - 1); }
  std::vector<ParticleId> some_of(BodyId body) {
    const Simulation::Rows rows = s_->rows(body);
    std::vector<ParticleId> ids;
    for (std::size_t row = rows.begin + pick(3); row < rows.end; row += 3) ids.push_back(s_->ids()[row]);
    return ids;
  }
  static Body cube(int n, const Vec3& corner) {
    return sample(Lattice{.count = {n, n, n}, .corner = corner, .jitter = 0.05f});
  }
  void add_body() {
    const MaterialId material{joins() ? 1u : static_cast<std::uint32_t>(pick(3))};
    const int side = 2 + static_cast<int>(pick(5));
    const float spread = joins() ? 6.0f : 12.0f;
    try {
      Body body = cube(side, {number(spread), number(spread), 10 + number(5)});
      for (std::size_t i = 0; i < body.positions.size() && side == 4; ++i) {
        body.alpha.push_back(i % 2 == 0 ? 0.0f : 1.0f);
        body.stiffness.push_back(i % 3 == 0 ? 0.1f : 1.0f);
      }
      body.merges = joins() || side % 2 == 0;
      s_->add_body(body, material);
    } catch (const ConfigError&) {
      // Something is there already.
    }
    if (s_->body_count() == 0) s_->add_body(cube(3, {0, 0, 60}), material);
  }

  std::mt19937 random_;
  const unsigned seed_;
  std::size_t joined_ = 0;
  std::unique_ptr<Simulation> s_;
  std::ostringstream events_;
  std::vector<PinId> pins_;
  std::vector<EmitterId> emitters_;
  std::vector<SinkId> sinks_;
  std::vector<ColliderId> colliders_;
};

TEST(random_calls, leave_what_is_finite_and_the_same_bits_after_restores_on_any_number_of_threads) {
  std::size_t joined = 0;
  for (unsigned seed = 1; seed <= 12; ++seed)
    for (const float slack : {0.0f, 0.2f}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", slack " << slack);
      Caller one(seed, 1, slack), other(seed, 2, slack);
      for (int k = 0; k < 60; ++k) {
        one.call();
        other.call();
        if (k % 7 == 3) other.restart(3);
        one.step();
        other.step();
        ASSERT_EQ(one.simulation().particle_count(), other.simulation().particle_count()) << k;
        ASSERT_EQ(one.simulation().state_hash(), other.simulation().state_hash()) << k;
        ASSERT_EQ(one.events(), other.events()) << k;
        for (std::size_t row = 0; row < one.simulation().particle_count(); ++row)
          ASSERT_LT(one.simulation().positions()[row].norm(), 1e4f) << k;
      }
      joined += one.joined();
    }
  EXPECT_GE(joined, 5u);
}

}  // namespace random_calls_test
}  // namespace mallow
