// What the mouse does to a session's matter.
#include <algorithm>

#include "view/session.h"

namespace mallow::view {
namespace {

std::string count_text(std::size_t particles) {
  return std::to_string(particles) + (particles == 1 ? " particle" : " particles");
}

}  // namespace

void Session::choose(const Ray& ray) {
  if (!simulation_) return;
  chosen_ = hit_of(*simulation_, ray).particle;
  changed_ = true;
}

void Session::pin(const Ray& ray, float radius) {
  act([&](Simulation& simulation) {
    hand_pins_.push_back(view::pin(simulation, ray, radius));
    const std::vector<ParticleId>& ids = hand_pins_.back().ids;
    pinned_.insert(pinned_.end(), ids.begin(), ids.end());
    return "pinned " + count_text(ids.size());
  });
}

void Session::release_pins() {
  act([&](Simulation& simulation) {
    std::size_t count = 0;
    for (const HandPin& pin : hand_pins_) {
      simulation.unpin(pin.pin);
      for (const ParticleId id : pin.ids)
        if (const auto found = std::ranges::find(pinned_, id); found != pinned_.end()) pinned_.erase(found);
      count += pin.ids.size();
    }
    hand_pins_.clear();
    return count == 0 ? "there are no pins of the mouse" : "let go of " + count_text(count);
  });
}

void Session::grab(const Vec3& at, float strength) {
  if (!simulation_) return;
  release();
  grab_.emplace(*simulation_, at, 1.3f * reach_of(*simulation_), strength);
  touched_ = true;
}

void Session::release() {
  if (!grab_) return;
  Grab::release(*simulation_);
  grab_.reset();
}

void Session::act(const std::function<std::string(Simulation&)>& verb) {
  if (!simulation_) return;
  say(verb(*simulation_));
  touched_ = true;
}

void Session::throw_ball(const Ray& ray, float speed) {
  if (!simulation_) return;
  const std::vector<BodyId> bodies = simulation_->bodies();
  if (bodies.empty()) throw ConfigError("throw", "there is no body that tells how large a ball should be");
  if (!ball_material_) {
    Material rubber = simulation_->material_settings(simulation_->material(bodies.front()));
    rubber.alpha = 0;
    rubber.alpha_by_temperature.reset();
    rubber.plastic_yield.reset();
    rubber.plastic_yield_by_temperature.reset();
    rubber.plastic_creep.reset();
    rubber.update_threshold.reset();
    ball_material_ = simulation_->add_material(rubber, "ball");
  }
  const float spacing = simulation_->spacing(bodies.front());
  const float radius = std::max(3.6f * spacing, 0.6f * reach_of(*simulation_));
  view::throw_ball(*simulation_, *ball_material_, ray, spacing, {.radius = radius, .speed = speed});
  say("threw a ball");
  touched_ = true;
}

}  // namespace mallow::view
