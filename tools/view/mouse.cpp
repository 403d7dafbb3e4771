#include "view/mouse.h"

#include <cmath>

#include "view/pick.h"
#include "view/verbs.h"

namespace mallow::view {
namespace {

constexpr float k_degrees = 60;  ///< that a stroke of heat warms

/// A speed that suits a scene [m/s]: that of what falls through as much as the tool reaches, and a little.
float speed_of(const Simulation& simulation) {
  const float reach = reach_of(simulation), pull = simulation.config().gravity.norm();
  if (pull > 0) return 3 * std::sqrt(2 * pull * reach);
  return reach / (20 * simulation.config().time_step.value_or(1));
}

}  // namespace

Ray Mouse::ray(const OrbitCamera& camera) const {
  return camera.ray(2 * x_ / width_ - 1, 1 - 2 * y_ / height_);
}

void Mouse::press(const Frame& frame, const OrbitCamera& camera, ViewState& state, const Send& send) {
  const Ray ray = this->ray(camera);
  const float strength = state.strength;
  if (state.tool == Tool::throw_ball) {
    send([ray, strength](Session& session) {
      if (session.has_scene()) session.throw_ball(ray, 2 * strength * speed_of(session.simulation()));
    });
    return;
  }
  if (state.tool == Tool::cut) {
    cut_from_ = Vec3(x_, y_, 0);
    cut_start_ = ray;
    return;
  }
  const std::optional<Vec3> hit = pick(frame, ray);
  if (!hit) {
    drags_ = Drag::turn;
    return;
  }
  const auto act = [&](auto verb) {
    send([ray, strength, verb](Session& session) {
      session.act([&](Simulation& simulation) { return verb(simulation, ray, strength); });
    });
  };
  switch (state.tool) {
    case Tool::grab:
      grabbed_ = hit;
      send([at = *hit, strength](Session& session) { session.grab(at, strength); });
      break;
    case Tool::poke:
      act([](Simulation& simulation, const Ray& along, float by) {
        return poke(simulation, along, reach_of(simulation), by * speed_of(simulation));
      });
      break;
    case Tool::heat:
      act([](Simulation& simulation, const Ray& along, float by) {
        return heat(simulation, along, reach_of(simulation), by * k_degrees, 0.5f * by);
      });
      break;
    case Tool::pin:
      send([ray](Session& session) {
        if (session.has_scene()) session.pin(ray, 0.7f * reach_of(session.simulation()));
      });
      break;
    case Tool::choose:
      state.marks.region = true;
      send([ray, marks = state.marks](Session& session) {
        session.show_marks(marks);
        session.choose(ray);
      });
      break;
    default:
      break;
  }
}

void Mouse::release(const OrbitCamera& camera, const Send& send) {
  drags_ = Drag::none;
  if (grabbed_) send([](Session& session) { session.release(); });
  grabbed_.reset();
  if (cut_from_)
    send([from = cut_start_, to = ray(camera)](Session& session) {
      session.act([&](Simulation& simulation) { return cut(simulation, from, to); });
    });
  cut_from_.reset();
}

void Mouse::button(int button, bool pressed, bool shift, const Frame& frame, OrbitCamera& camera,
                   ViewState& state, const Send& send) {
  if (!pressed) {
    release(camera, send);
  } else if (button == 0) {
    press(frame, camera, state, send);
  } else {
    drags_ = button == 2 || shift ? Drag::move : Drag::turn;
  }
}

void Mouse::move(float x, float y, float width, float height, OrbitCamera& camera, const Send& send) {
  const float right = x - x_, down = y - y_;
  x_ = x;
  y_ = y;
  width_ = std::max(1.0f, width);
  height_ = std::max(1.0f, height);
  if (drags_ == Drag::turn) camera.turn(right, down);
  if (drags_ == Drag::move) camera.pan(right / height_, down / height_);
  if (grabbed_)
    send(
        [to = on_plane(ray(camera), *grabbed_, camera.forward())](Session& session) { session.pull_to(to); });
}

}  // namespace mallow::view
