// What the window shows of a session.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "program/body_appearances.h"
#include "view/session.h"

namespace mallow::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double k_plot_seconds = 10, k_sample_seconds = 0.1;

/// What holds nearly all values: single ones that are far off would take all the colours.
std::array<float, 2> range_of_values(std::vector<float> values) {
  if (values.empty()) return {0, 1};
  const auto at = [&](double share) {
    const auto place =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, place);
    return *place;
  };
  const float low = at(0.01), high = at(0.99);
  return {low, high > low ? high : low + 1};
}

}  // namespace

std::vector<Appearance> Session::palette() {
  program::follow_bodies(*simulation_, bodies_);
  return program::body_appearances(scene_, program::material_names(bodies_));
}

void Session::draw_mesh(Mesh& mesh) {
  const auto started = Clock::now();
  try {
    surface_->draw(*simulation_, mesh);
  } catch (const ConfigError& error) {
    if (skins_.empty()) throw;
    // What a skin follows is gone: its body is drawn as all others.
    skins_.clear();
    make_surface();
    say(std::string("a skin is dropped: ") + error.what());
    surface_->draw(*simulation_, mesh);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - started).count();
  frame_seconds_ += seconds;
  surface_time_.add(std::chrono::duration<double>(Clock::now().time_since_epoch()).count(), seconds);
}

void Session::fill_particles(Frame& frame) {
  const VectorView positions = simulation_->positions();
  frame.positions.resize(positions.size());
  for (std::size_t row = 0; row < positions.size(); ++row) frame.positions[row] = positions[row];
  frame.bodies.resize(positions.size());
  frame.radii.clear();
  for (const BodyId body : simulation_->bodies()) {
    const Simulation::Rows rows = simulation_->rows(body);
    std::fill(frame.bodies.begin() + static_cast<std::ptrdiff_t>(rows.begin),
              frame.bodies.begin() + static_cast<std::ptrdiff_t>(rows.end), slot_of(body));
    if (frame.radii.size() <= slot_of(body)) frame.radii.resize(slot_of(body) + 1, 0);
    frame.radii[slot_of(body)] = 0.5f * simulation_->spacing(body);
  }
  frame.shown = shown_;
  values_.find(*simulation_, shown_, frame.values);
  frame.value_range = shown_ == Shown::alpha ? std::array<float, 2>{0, 1} : range_of_values(frame.values);
}

void Session::fill_colliders(Frame& frame) const {
  frame.colliders.clear();
  frame.collider_slots.clear();
  const std::vector<ColliderId> ids = simulation_->collider_ids();
  const std::vector<Collider>& colliders = simulation_->colliders();
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const std::uint32_t slot = slot_of(ids[k]);
    if (slot < scene_.colliders.size() && !scene_.colliders[slot].visible) continue;
    frame.colliders.push_back(colliders[k]);
    frame.collider_slots.push_back(slot);
  }
}

void Session::add_sample(double wall) {
  if (!samples_.empty() && wall - samples_.back().wall < k_sample_seconds) return;
  Sample sample{.wall = wall, .time = simulation_->time()};
  Eigen::Vector3d momentum(0, 0, 0);
  double kinetic = 0, potential = 0;
  const Eigen::Vector3d gravity = simulation_->config().gravity.cast<double>();
  for (const BodyId body : simulation_->bodies()) {
    const BodyMotion motion = simulation_->motion(body);
    momentum += motion.momentum;
    kinetic += motion.kinetic_energy;
    potential -= motion.mass * gravity.dot(motion.center_of_mass);
  }
  sample.kinetic = static_cast<float>(kinetic);
  sample.potential = static_cast<float>(potential);
  sample.momentum = static_cast<float>(momentum.norm());
  samples_.push_back(sample);
  std::erase_if(samples_, [&](const Sample& old) { return old.wall < wall - k_plot_seconds; });
}

void Session::fill_stats(double wall, FrameStats& stats) {
  stats.time = simulation_->time();
  stats.steps = simulation_->step_count();
  stats.frame = frame_;
  stats.steps_per_second = steps_rate_.per_second(wall);
  stats.frames_per_second = frames_rate_.per_second(wall);
  stats.pace = time_rate_.per_second(wall) / (frame_time_ * scene_.render.frames_per_second);
  stats.last = last_;
  stats.phases = phases_.mean();
  stats.surface_seconds = drawn_ == Drawn::surface ? surface_time_.mean() : 0;
  stats.save_seconds = save_time_.mean();
  stats.particles = simulation_->particle_count();
  const std::vector<BodyId> bodies = simulation_->bodies();
  stats.bodies = bodies.size();
  stats.awake = static_cast<std::size_t>(
      std::ranges::count_if(bodies, [&](BodyId body) { return simulation_->is_awake(body); }));
  stats.threads = threads_.threads();
  stats.most_threads = threads_.most();
  stats.moments = ring_.size();
  stats.moment_bytes = ring_.bytes();
  stats.oldest = ring_.empty() ? 0 : ring_[0].time;
  stats.newest = ring_.empty() ? 0 : ring_[ring_.size() - 1].time;
  stats.rung = rung_;
  stats.given_up = given_up_;
  stats.state_hash = hash_asked_ ? simulation_->state_hash() : 0;
}

void Session::fill(double wall, Frame& frame) {
  frame.number = ++frames_filled_;
  frame.scene = scene_number_;
  frame.building = false;
  frame.camera = camera_;
  frame.bounds = bounds_;
  frame.paused = paused_;
  frame.finished = std::exchange(finished_, false) && recording_;
  changed_ = false;
  frame.message_number = message_number_;
  frame.camera_number = camera_number_;
  frame.has_scene = simulation_.has_value();
  if (!simulation_) {
    frame.message = message_;
    frame.failed = !message_.empty();
    frame.mesh = {};
    frame.positions.clear();
    frame.colliders.clear();
    frame.marks = {};
    frame.grab.reset();
    frame.samples.clear();
    frame.stats = {};
    frame.stats.threads = threads_.threads();
    frame.stats.most_threads = threads_.most();
    frame.stats.rung = governor_.rung();
    return;
  }
  const bool moves = !paused_ && !failed_;
  if (drawn_ == Drawn::surface) {
    frame.positions.clear();
    try {
      draw_mesh(frame.mesh);
    } catch (const ConfigError& error) {
      frame.mesh = {};
      if (message_ != error.what()) say(error.what());
      frame.message_number = message_number_;
      changed_ = false;
    }
  } else {
    frame.mesh = {};
    fill_particles(frame);
  }
  frame.has_skins = !skins_.empty();
  frame.palette = palette();
  fill_colliders(frame);
  frame.grab.reset();
  if (grab_) frame.grab = {grab_->middle(*simulation_), grab_->target()};
  frame.marks = place(marks_, *simulation_, pinned_, chosen_, last_.time_step);
  if (moves || samples_.empty()) add_sample(wall);
  frame.samples = samples_;
  fill_stats(wall, frame.stats);
  frame.settings_number = settings_number_;
  Settings now = settings();
  frame.solver = now.solver;
  frame.materials = std::move(now.materials);
  for (const auto& [index, wish] : wishes_) frame.materials[index] = wish.material;
  frame.waits = !wishes_.empty();
  frame.touched = touched_;
  frame.message = message_;
  frame.failed = failed_;
}

}  // namespace mallow::view
