// Strands that leave nozzles, and what sinks take away. [model 2, section 6]
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "colliders/collider_checks.h"
#include "colliders/pose.h"
#include "config/validation.h"
#include "core/bounds.h"
#include "simulation/membership.h"
#include "simulation/overlaps.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

/// By which layers of a disc are turned, one against the next [rad]: never the same way twice.
constexpr double k_turn = 2.4;
/// Layers that are put behind the nozzle at once: the rows of the whole strand move for them.
constexpr std::size_t k_batch = 8;

/// So many layers must still be held for what rests beside new ones to rest beside free ones too.
std::size_t held_layers(const Emitter& emitter, float region_radius) {
  return 2 * static_cast<std::size_t>(std::ceil(region_radius / emitter.spacing)) + 1;
}

/// 32 well-mixed bits as a number in [-1, 1).
double noise(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((x ^ (x >> 31)) >> 32) / 2147483648.0 - 1;
}

/// Points of a lattice around the origin, h apart.
std::vector<Vec> lattice(std::size_t along_x, std::size_t along_y, double h) {
  std::vector<Vec> points;
  for (std::size_t b = 0; b < along_y; ++b)
    for (std::size_t a = 0; a < along_x; ++a)
      points.emplace_back(h * (static_cast<double>(a) - 0.5 * static_cast<double>(along_x - 1)),
                          h * (static_cast<double>(b) - 0.5 * static_cast<double>(along_y - 1)), 0);
  return points;
}

/// As many points, each for h², as come nearest to the area of a disc: those within some radius, of a lattice
/// with a point in the middle, or with none there.
std::vector<Vec> disc(double radius, double h) {
  const double wanted = std::numbers::pi * radius * radius / (h * h);
  const auto half = static_cast<std::size_t>(std::ceil(radius / h)) + 1;
  std::vector<Vec> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t side : {2 * half + 1, 2 * half}) {
    std::vector<Vec> points = lattice(side, side, h);
    std::ranges::stable_sort(points, {},
                             [&](const Vec& x) { return std::round(x.squaredNorm() / (h * h) * 4); });
    for (std::size_t n = 1; n < points.size(); ++n) {
      const bool shell_ends = points[n].squaredNorm() - points[n - 1].squaredNorm() > 0.1 * h * h;
      const double off = std::abs(static_cast<double>(n) - wanted);
      if (!shell_ends || off >= least) continue;
      least = off;
      best.assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }
  return best;
}

/// The same of a rectangle: a whole lattice.
std::vector<Vec> rectangle(double width, double height, double h) {
  const double wanted = width * height / (h * h);
  std::array<double, 2> best{1, 1};
  for (const double along_x : {std::floor(width / h + 1e-3), std::ceil(width / h - 1e-3)})
    for (const double along_y : {std::floor(height / h + 1e-3), std::ceil(height / h - 1e-3)})
      if (along_x >= 1 && along_y >= 1 &&
          std::abs(along_x * along_y - wanted) < std::abs(best[0] * best[1] - wanted))
        best = {along_x, along_y};
  return lattice(static_cast<std::size_t>(best[0]), static_cast<std::size_t>(best[1]), h);
}

/// Points of a layer across the flow, in the frame of the nozzle.
std::vector<Vec> section(const Emitter& emitter) {
  const double h = static_cast<double>(emitter.spacing);
  if (emitter.radius) return disc(static_cast<double>(*emitter.radius), h);
  if (emitter.width)
    return rectangle(static_cast<double>(*emitter.width), static_cast<double>(*emitter.height), h);
  std::vector<Vec> points;
  for (const Vec3& x : emitter.points) points.emplace_back(x.x(), x.y(), 0);
  return points;
}

/// Layer `number` of all, at `height` along the flow, in the world.
void add_layer(const Emitter& emitter, std::span<const Vec> points, std::uint64_t number, double height,
               std::vector<Vec3>& positions) {
  const Eigen::Matrix3d rotation = rotation_of(emitter.pose);
  const double turn = emitter.radius ? k_turn * static_cast<double>(number) : 0.0;
  const Eigen::AngleAxisd turned(std::remainder(turn, 2 * std::numbers::pi), Vec::UnitZ());
  std::uint64_t k = 0;
  for (const Vec& x : points) {
    const double most = static_cast<double>(emitter.jitter) * static_cast<double>(emitter.spacing);
    const std::uint64_t name = number << 24 ^ k++;
    const Vec moved = x + most * Vec(noise(2 * name), noise(2 * name + 1), 0) + Vec(0, 0, height);
    positions.push_back((emitter.pose.translation + rotation * (turned * moved)).cast<float>());
  }
}

/// By which its start, stop, keyframes and keys of the speed go [s].
double own_time(const Simulation::State& s, const EmitterState& emitter) {
  return s.time - emitter.late;
}

bool has_stopped(const Simulation::State& s, const EmitterState& emitter) {
  return emitter.settings.stop && own_time(s, emitter) >= *emitter.settings.stop;
}

bool flows(const Simulation::State& s, const EmitterState& emitter) {
  return own_time(s, emitter) >= emitter.settings.start.value_or(0) && !has_stopped(s, emitter);
}

/// A strand that is not enabled stands where it is, and so does its nozzle.
bool is_enabled(const Simulation::State& s, const EmitterState& emitter) {
  const std::optional<std::size_t> place = s.body_slots.find(static_cast<std::uint64_t>(emitter.body));
  return !place || s.bodies[*place].enabled;
}

/// Of what it holds, where the strand has a speed [m/s].
Vec3 velocity_of(const Emitter& emitter, const Pose& pose, double speed) {
  if (speed == 0) return emitter.velocity;
  return emitter.velocity + static_cast<float>(speed) * rotation_of(pose).col(2).cast<float>();
}

/// `count` layers behind the last, as points of a body.
Body next_layers(const EmitterState& emitter, std::size_t count) {
  Body body{.positions = {}, .spacing = emitter.settings.spacing};
  const double h = static_cast<double>(emitter.settings.spacing);
  const std::vector<Vec> points = section(emitter.settings);
  for (std::size_t k = 0; k < count; ++k)
    add_layer(emitter.settings, points, emitter.layers + k,
              emitter.offset - h * (static_cast<double>(emitter.layers + k) + 0.5), body.positions);
  return body;
}

/// Tells apart the layers of `ids`, which are new, and holds them.
void hold_layers(std::span<const ParticleId> ids, std::size_t count, Simulation::State& s,
                 EmitterState& emitter) {
  const std::size_t each = ids.size() / count;
  for (std::size_t k = 0; k < count; ++k)
    emitter.held.emplace_back(ids.begin() + static_cast<std::ptrdiff_t>(k * each),
                              ids.begin() + static_cast<std::ptrdiff_t>((k + 1) * each));
  emitter.layers += count;
  hold_particles(s, emitter.pin, ids);
}

/// What has passed the nozzle is free, but for what somebody else has pinned.
void free_layers(Simulation::State& s, EmitterState& emitter) {
  const double h = static_cast<double>(emitter.settings.spacing);
  while (!emitter.held.empty()) {
    const double number = static_cast<double>(emitter.layers - emitter.held.size());
    if (emitter.offset - h * (number + 0.5) < 0) break;
    for (const ParticleId id : emitter.held.front())
      if (const std::optional<std::size_t> row = s.store.slots.find(id))
        if (s.store.pin[*row] == slot_of(emitter.pin) + 1) s.store.pin[*row] = 0;
    emitter.held.pop_front();
  }
}

/// The strand ends at the nozzle: what has not left it by then is taken away, or it would hang there for
/// ever.
void cut_off(Simulation::State& s, EmitterState& emitter) {
  std::vector<ParticleId> ids;
  for (const std::vector<ParticleId>& layer : emitter.held)
    std::ranges::copy_if(layer, std::back_inserter(ids), [&](ParticleId id) {
      const std::optional<std::size_t> row = s.store.slots.find(id);
      return row && s.store.pin[*row] == slot_of(emitter.pin) + 1;
    });
  emitter.held.clear();
  if (!ids.empty()) erase_particles(s, ids);
}

void flow_out(Simulation::State& s, EmitterState& emitter) {
  if (!is_enabled(s, emitter)) return;
  if (has_stopped(s, emitter)) return cut_off(s, emitter);
  BodyState& body = s.body(emitter.body);
  const Emitter& settings = emitter.settings;
  const double time = own_time(s, emitter);
  const double speed = flows(s, emitter) ? static_cast<double>(settings.speed.at(time)) : 0;
  const Vec3 velocity = velocity_of(settings, settings.pose, speed);
  const bool is_led =
      !settings.keyframes.empty() && are_due(settings.keyframes, time, static_cast<double>(s.longest_step()));
  if (is_led || !velocity.isZero(0)) wake_island(s, body);
  free_layers(s, emitter);
  if (emitter.held.size() > held_layers(settings, body.shape.region_radius) ||
      body.size() >= static_cast<std::size_t>(settings.most_particles))
    return;
  Body points = next_layers(emitter, k_batch);
  points.velocity = velocity;
  hold_layers(extend(s, body, points), k_batch, s, emitter);
}

std::size_t drain(Simulation::State& s, SinkState& sink) {
  std::vector<ParticleId> ids;
  const Aabb box{relative_to(s.origin, sink.box.min), relative_to(s.origin, sink.box.max)};
  for (const BodyState& body : s.bodies) {
    if (!body.enabled) continue;
    for (std::size_t row = body.begin; row < body.end; ++row) {
      const Vec3 x = s.store.position.get(row);
      if (is_near(x, box) == sink.outside || (!s.store.pin.empty() && s.store.pin[row] != 0)) continue;
      ids.push_back(s.store.id[row]);
    }
  }
  if (!ids.empty()) erase_particles(s, ids);
  sink.drained += ids.size();
  return ids.size();
}

[[noreturn]] void refuse_sink(SinkId id) {
  throw ConfigError("sink",
                    "there is no sink " + std::to_string(static_cast<std::uint64_t>(id)) + ", or no longer");
}

std::size_t place_of(const Simulation::State& s, EmitterId id) {
  const auto number = static_cast<std::uint64_t>(id);
  for (std::size_t e = 0; e < s.emitters.size(); ++e)
    if (s.emitters[e].id == id) return e;
  throw ConfigError("emitter", "there is no emitter " + std::to_string(number) + ", or no longer");
}

void check_speed(const Simulation::State& s, const Emitter& emitter, Checks& checks) {
  const double own = emitter.velocity.cast<double>().norm();
  check_speed(s, "emitter.speed", static_cast<double>(emitter.speed.highest()) + own, checks);
}

void check_emitter(const Simulation::State& s, const Emitter& emitter) {
  Checks checks;
  check(emitter, checks);
  check_poses("emitter", emitter.pose, emitter.keyframes, checks);
  check_speed(s, emitter, checks);
  checks.finish();
}

}  // namespace

void check_emitters(const Simulation::State& s) {
  Checks checks;
  for (const EmitterState& emitter : s.emitters) check_speed(s, emitter.settings, checks);
  checks.finish();
}

std::size_t flow(Simulation::State& s) {
  // Whoever removes its body, or lets go what it holds, takes an emitter with it.
  std::erase_if(s.emitters, [&](const EmitterState& emitter) {
    const bool holds = s.pin_slots.find(static_cast<std::uint64_t>(emitter.pin)).has_value();
    if (holds && s.body_slots.find(static_cast<std::uint64_t>(emitter.body))) return false;
    if (holds) release_pin(s, emitter.pin);
    return true;
  });
  for (EmitterState& emitter : s.emitters) flow_out(s, emitter);
  std::size_t drained = 0;
  for (SinkState& sink : s.sinks) drained += drain(s, sink);
  return drained;
}

void drive_emitters(Simulation::State& s, double end, double time_step) {
  for (EmitterState& emitter : s.emitters) {
    if (!is_enabled(s, emitter)) continue;
    Emitter& settings = emitter.settings;
    Pose there = settings.pose;
    Vec3 spin{0, 0, 0};
    if (!settings.keyframes.empty()) {
      there = pose_at(settings.keyframes, end - emitter.late);
      const Twist twist = twist_between(settings.pose, there, time_step);
      settings.velocity = twist.velocity;
      spin = twist.angular_velocity;
    }
    // In the middle of the step: exact, but for the steps that keys of the speed are in.
    const double middle = end - emitter.late - 0.5 * time_step;
    emitter.speed = flows(s, emitter) ? static_cast<double>(settings.speed.at(middle)) : 0;
    PinState& pin = s.pin(emitter.pin);
    pin.velocity = velocity_of(settings, there, emitter.speed);
    s.pin_motions[slot_of(emitter.pin)] = {
        .velocity = pin.velocity,
        .spin = mean_spin(spin, time_step).cast<float>(),
        .center = (settings.pose.translation - s.origin.cast<double>()).cast<float>()};
  }
}

void move_emitters(Simulation::State& s, double end, double time_step) {
  for (EmitterState& emitter : s.emitters) {
    Emitter& settings = emitter.settings;
    if (!is_enabled(s, emitter)) {
      emitter.late += end - s.time;
      continue;
    }
    emitter.offset += time_step * emitter.speed;
    if (settings.keyframes.empty())
      settings.pose.translation += time_step * settings.velocity.cast<double>();
    else
      settings.pose = pose_at(settings.keyframes, end - emitter.late);
  }
}

EmitterId Simulation::add_emitter(const Emitter& settings, MaterialId material, std::string name) {
  state_->refuse_in_callback();
  State& s = *state_;
  check_emitter(s, settings);
  Checks checks;
  check_room_for_pin(s, checks);
  checks.finish();
  EmitterState emitter{.id = EmitterId{s.emitter_count}, .settings = settings};
  if (!settings.keyframes.empty()) {
    emitter.settings.pose = pose_at(settings.keyframes, s.time);
    emitter.settings.velocity.setZero();
  }
  const float radius = region_radius(s.config, s.material(material).settings, settings.spacing);
  const std::size_t count = held_layers(settings, radius) + k_batch;
  Body points = next_layers(emitter, count);
  points.merges = settings.merges;
  if (name.empty()) name = "strand " + std::to_string(s.emitter_count);
  emitter.body = add_body(points, material, std::move(name));
  const Rows rows = this->rows(emitter.body);
  const std::vector<ParticleId> ids(s.store.id.begin() + rows.begin, s.store.id.begin() + rows.end);
  emitter.pin = pin(ids, emitter.settings.velocity);
  hold_layers(ids, count, s, emitter);
  s.emitters.push_back(std::move(emitter));
  return EmitterId{s.emitter_count++};
}

BodyId Simulation::body(EmitterId id) const {
  return state_->emitters[place_of(*state_, id)].body;
}

const Emitter& Simulation::emitter(EmitterId id) const {
  return state_->emitters[place_of(*state_, id)].settings;
}

std::vector<EmitterId> Simulation::emitter_ids() const {
  std::vector<EmitterId> ids;
  for (const EmitterState& emitter : state_->emitters) ids.push_back(emitter.id);
  return ids;
}

std::vector<ParticleId> Simulation::held(EmitterId id) const {
  std::vector<ParticleId> ids;
  for (const std::vector<ParticleId>& layer : state_->emitters[place_of(*state_, id)].held)
    std::ranges::copy_if(layer, std::back_inserter(ids),
                         [&](ParticleId held) { return state_->store.slots.find(held).has_value(); });
  return ids;
}

void Simulation::set_flow(EmitterId id, const Schedule& speed, const Vec3& velocity) {
  state_->refuse_in_callback();
  EmitterState& emitter = state_->emitters[place_of(*state_, id)];
  Emitter settings = emitter.settings;
  settings.speed = speed;
  settings.velocity = velocity;
  settings.keyframes.clear();
  check_emitter(*state_, settings);
  // Keys of the new speed go by the time of now, and so does all else from now on.
  if (settings.start) *settings.start += emitter.late;
  if (settings.stop) *settings.stop += emitter.late;
  emitter.late = 0;
  emitter.settings = settings;
}

void Simulation::remove_emitter(EmitterId id) {
  state_->refuse_in_callback();
  State& s = *state_;
  const std::size_t place = place_of(s, id);
  const PinId pin = s.emitters[place].pin;
  if (s.pin_slots.find(static_cast<std::uint64_t>(pin))) release_pin(s, pin);
  s.emitters.erase(s.emitters.begin() + static_cast<std::ptrdiff_t>(place));
}

SinkId Simulation::add_sink(const Aabb& box, bool outside) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  checks.vector("sink.box.min", box.min);
  checks.vector("sink.box.max", box.max);
  if (!(box.min.array() < box.max.array()).all()) checks.problem("sink.box", "min must be below max");
  checks.finish();
  s.sinks.push_back({.id = SinkId{s.sink_count}, .box = box, .outside = outside});
  return SinkId{s.sink_count++};
}

void Simulation::remove_sink(SinkId id) {
  state_->refuse_in_callback();
  State& s = *state_;
  if (std::erase_if(s.sinks, [&](const SinkState& sink) { return sink.id == id; }) == 0) refuse_sink(id);
}

std::vector<SinkId> Simulation::sink_ids() const {
  std::vector<SinkId> ids;
  for (const SinkState& sink : state_->sinks) ids.push_back(sink.id);
  return ids;
}

std::uint64_t Simulation::drained(SinkId id) const {
  const auto sink = std::ranges::find(state_->sinks, id, &SinkState::id);
  if (sink == state_->sinks.end()) refuse_sink(id);
  return sink->drained;
}

}  // namespace mallow
