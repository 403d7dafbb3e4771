#include "program/view_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>
#include <type_traits>

namespace mallow::program {
namespace {

/// Moments at which a path is looked at from one end to the other.
constexpr int k_looks = 24;
/// A jet that reaches no ground, and a nozzle that moves on without an end, are followed over so many widths
/// of the nozzle.
constexpr float k_endless = 12;
/// A body that is thrown over so many of its own sizes.
constexpr float k_far_throw = 6;
/// A collider that goes through keyframes is seen whole up to this size, in sizes of what moves.
constexpr float k_tool = 1.5f;

void extend(Aabb& box, const Aabb& other) {
  box.min = box.min.cwiseMin(other.min);
  box.max = box.max.cwiseMax(other.max);
}

Aabb around(const Vec3& x, float reach) {
  return {x - Vec3::Constant(reach), x + Vec3::Constant(reach)};
}

float longest_side(const Aabb& box) {
  return (box.max - box.min).maxCoeff();
}

/// A plane that things come to rest on.
bool is_ground(const Plane& plane) {
  return plane.normal.z() > 0.7f * plane.normal.norm();
}

/// Height of a ground plane below (or above) a point.
float ground_height(const Plane& plane, const Vec3& x) {
  return (plane.offset - plane.normal.x() * x.x() - plane.normal.y() * x.y()) / plane.normal.z();
}

/// What a scene has that stops a fall.
struct Room {
  std::vector<Collider> colliders;  ///< that are seen
  std::vector<Plane> grounds;

  explicit Room(const Scene& scene) : colliders(visible_colliders(scene)) {
    for (const Collider& collider : colliders)
      visit_parts(collider, [&]<class Shape>(const Shape& shape) {
        if constexpr (std::is_same_v<Shape, Plane>)
          if (const Plane plane = placed(shape, collider.pose); is_ground(plane)) grounds.push_back(plane);
      });
  }

  bool is_below_ground(const Vec3& x) const {
    return std::ranges::any_of(grounds, [&](const Plane& plane) { return x.z() < ground_height(plane, x); });
  }
};

/// Follows what flies from `from` until it meets the ground, at most `reach` away. [m]
void add_flight(const Room& room, const Vec3& gravity, const Vec3& from, const Vec3& velocity, float reach,
                float radius, Aabb& box) {
  const float speed = velocity.norm(), pull = gravity.norm();
  if (!(speed > 0) && !(pull > 0)) return;
  // The time in which either of the two takes it that far.
  const float by_speed = speed > 0 ? reach / speed : std::numeric_limits<float>::infinity();
  const float by_pull = pull > 0 ? std::sqrt(2 * reach / pull) : std::numeric_limits<float>::infinity();
  const float longest = room.grounds.empty() ? std::min(by_speed, by_pull) : by_speed + by_pull;
  const float end = std::isfinite(longest) ? longest : std::min(by_speed, by_pull);
  constexpr int k_steps = 8 * k_looks;
  for (int k = 0; k <= k_steps; ++k) {
    const float t = end * static_cast<float>(k) / k_steps;
    const Vec3 way = velocity * t + 0.5f * t * t * gravity;
    if (room.is_below_ground(from + way)) return;
    const bool sideways = way.head<2>().norm() > reach || way.z() > reach;
    if (sideways || (room.grounds.empty() && way.norm() > reach)) return;
    extend(box, around(from + way, radius));
  }
}

/// Half of the width of a nozzle.
float nozzle_radius(const Emitter& emitter) {
  float radius = emitter.radius.value_or(0.0f);
  radius = std::max({radius, 0.5f * emitter.width.value_or(0.0f), 0.5f * emitter.height.value_or(0.0f)});
  for (const Vec3& x : emitter.points) radius = std::max(radius, x.head<2>().norm());
  return std::max(radius, emitter.spacing);
}

/// How long an emitter flows, or less where nothing says when it ends [s].
double flow_seconds(const Emitter& emitter) {
  const double begin = emitter.start.value_or(0);
  const std::vector<ScheduleKey>& speeds = emitter.speed.keys();
  if (emitter.stop) return *emitter.stop - begin;
  if (speeds.size() > 1 && speeds.back().value == 0)
    return std::max(0.0, static_cast<double>(speeds.back().time) - begin);
  const float speed = std::max(emitter.speed.highest(), emitter.velocity.norm());
  return speed > 0 ? static_cast<double>(2 * k_endless * nozzle_radius(emitter) / speed) : 0;
}

/// Where the nozzle goes, what flies from it, and how wide what it gives heaps up.
void add_emitter(const Room& room, const Vec3& gravity, const Emitter& emitter, Aabb& box) {
  const float radius = nozzle_radius(emitter), speed = emitter.speed.highest();
  const double begin = emitter.start.value_or(0), seconds = flow_seconds(emitter);
  // A half ball of all that comes.
  const double volume = static_cast<double>(std::numbers::pi_v<float> * radius * radius * speed) * seconds;
  const auto heap = static_cast<float>(std::cbrt(1.5 / std::numbers::pi * volume));
  const double end = emitter.keyframes.empty() ? begin + seconds : emitter.keyframes.back().time;
  for (int k = 0; k <= k_looks; ++k) {
    const double time = begin + (end - begin) * k / k_looks;
    const Pose pose =
        emitter.keyframes.empty()
            ? Pose{emitter.pose.translation + time * emitter.velocity.cast<double>(), emitter.pose.rotation}
            : pose_at(emitter.keyframes, time);
    const Vec3 mouth = pose.translation.cast<float>();
    extend(box, around(mouth, radius));
    const Eigen::Quaterniond turn = Eigen::Quaterniond(pose.rotation).normalized();
    const Vec3 velocity = (turn * Eigen::Vector3d::UnitZ()).cast<float>() * speed;
    add_flight(room, gravity, mouth, velocity, 2 * k_endless * radius, radius, box);
    for (const Plane& plane : room.grounds) {
      const Vec3 foot(mouth.x(), mouth.y(), ground_height(plane, mouth));
      if (foot.z() > mouth.z()) continue;
      extend(box, {foot - Vec3(heap, heap, 0), foot + Vec3(heap, heap, heap)});
    }
  }
}

/// Bodies that are thrown; what only falls is seen with the ground.
void add_throws(const Room& room, const Scene& scene, const ParticleFrame& first, Aabb& box) {
  if (std::ranges::none_of(scene.bodies, [](const SceneBody& body) { return !body.velocity.isZero(0); }))
    return;
  std::vector<Aabb> bodies;
  std::vector<Vec3> velocities;
  for (std::size_t i = 0; i < first.positions.size(); ++i) {
    const std::size_t body = first.bodies.at(i);
    while (bodies.size() <= body) {
      bodies.push_back({Vec3::Constant(1e30f), Vec3::Constant(-1e30f)});
      velocities.emplace_back(0, 0, 0);
    }
    extend(bodies[body], {first.positions[i], first.positions[i]});
    velocities[body] = first.velocities.at(i);
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].min.x() > bodies[b].max.x() || velocities[b].isZero(0)) continue;
    const float side = longest_side(bodies[b]);
    add_flight(room, scene.solver.gravity, 0.5f * (bodies[b].min + bodies[b].max), velocities[b],
               k_far_throw * side, 0.5f * side, box);
  }
}

/// The bounds of a shape wherever its keyframes take it, or its velocity up to a time.
template <class Shape>
Aabb swept(const Shape& shape, const Collider& collider, double last) {
  if (collider.keyframes.empty()) {
    Aabb box = placed(bounds(shape), collider.pose);
    if (last > 0) extend(box, placed(bounds(shape), pose_after(collider, last)));
    return box;
  }
  const double begin = collider.keyframes.front().time, end = collider.keyframes.back().time;
  Aabb box = placed(bounds(shape), pose_at(collider.keyframes, begin));
  for (const PoseKeyframe& key : collider.keyframes) extend(box, placed(bounds(shape), key.pose));
  for (int k = 1; k < k_looks; ++k)
    extend(box, placed(bounds(shape), pose_at(collider.keyframes, begin + (end - begin) * k / k_looks)));
  return box;
}

/// What is seen of the colliders with what is in the box.
void add_colliders(const Room& room, double last, float reach_sizes, Aabb& box) {
  // A collider far larger than what moves is a part of the room and does not have to be seen whole, one that
  // is moved through keyframes and is no larger is a tool, and is.
  const float size = longest_side(box);
  const Vec3 reach = Vec3::Constant(reach_sizes * size);
  const Aabb near{box.min - reach, box.max + reach};
  const Aabb far{box.min - Vec3::Constant(2 * size), box.max + Vec3::Constant(2 * size)};
  for (const Collider& collider : room.colliders)
    visit_parts(collider, [&]<class Shape>(const Shape& shape) {
      if constexpr (std::is_same_v<Shape, Plane>) return;  // endless
      const bool is_tool = !collider.keyframes.empty() && longest_side(bounds(shape)) <= k_tool * size;
      const Aabb whole = swept(shape, collider, last);
      const Aabb& seen = is_tool ? far : near;
      const auto clamped = [&](const Vec3& x) -> Vec3 { return x.cwiseMax(seen.min).cwiseMin(seen.max); };
      extend(box, {clamped(whole.min), clamped(whole.max)});
    });
}

/// The particles of a frame without those far from all others.
Aabb most_of(const ParticleFrame& frame) {
  constexpr std::size_t k_rare = 100;  // one in so many may be far away
  Aabb box{frame.positions.at(0), frame.positions.at(0)};
  for (const Vec3& x : frame.positions) extend(box, {x, x});
  const std::size_t rare = frame.positions.size() / k_rare;
  if (rare == 0) return box;
  Aabb most;
  std::vector<float> values(frame.positions.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::ranges::transform(frame.positions, values.begin(), [&](const Vec3& x) { return x[axis]; });
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(rare);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(rare);
    std::nth_element(values.begin(), low, values.end());
    most.min[axis] = *low;
    std::nth_element(values.begin(), high, values.end());
    most.max[axis] = *high;
  }
  const Vec3 reach = Vec3::Constant(longest_side(most));
  return {box.min.cwiseMax(most.min - reach), box.max.cwiseMin(most.max + reach)};
}

}  // namespace

std::vector<Collider> visible_colliders(const Scene& scene) {
  std::vector<Collider> colliders;
  for (const SceneCollider& collider : scene.colliders)
    if (collider.visible) colliders.push_back(collider);
  return colliders;
}

Aabb view_bounds(const Scene& scene, const ParticleFrame& first) {
  Aabb box{first.positions.at(0), first.positions.at(0)};
  for (const Vec3& x : first.positions) extend(box, {x, x});
  const Vec3 middle = 0.5f * (box.min + box.max);
  const float side = longest_side(box);
  const Room room(scene);

  float lowest = -std::numeric_limits<float>::infinity();
  const bool only_emitted = scene.bodies.empty();
  for (const Plane& plane : room.grounds) {
    const Vec3 foot(middle.x(), middle.y(), ground_height(plane, middle));
    // What falls spreads: to about twice its width.
    const Vec3 spread = only_emitted ? Vec3(0, 0, 0) : Vec3(side, side, 0.0f);
    extend(box, {foot - spread, foot + spread});
    lowest = std::max(lowest, std::min(foot.z(), box.min.z()));
  }
  add_throws(room, scene, first, box);
  for (const SceneEmitter& emitter : scene.emitters) add_emitter(room, scene.solver.gravity, emitter, box);

  add_colliders(room, 0, 0.5f, box);
  box.min.z() = std::max(box.min.z(), lowest);  // what is below the ground is not seen
  return box;
}

void FilmBounds::add(const ParticleFrame& frame) {
  if (frame.positions.empty()) return;
  const Aabb box = most_of(frame);
  if (!box_) box_ = box;
  extend(*box_, box);
  last_time_ = std::max(last_time_, frame.time);
}

std::optional<Aabb> FilmBounds::box(const Scene& scene, float spacing) const {
  if (!box_) return std::nullopt;
  // The surface is half a spacing and a little outside of the particles.
  const Vec3 skin = Vec3::Constant(0.75f * spacing);
  Aabb box{box_->min - skin, box_->max + skin};
  const Room room(scene);
  float lowest = -std::numeric_limits<float>::infinity();
  for (const Plane& plane : room.grounds) {
    const Vec3 middle = 0.5f * (box.min + box.max);
    const Vec3 foot(middle.x(), middle.y(), ground_height(plane, middle));
    lowest = std::max(lowest, std::min(foot.z(), box.min.z()));
    // How high something hangs is seen where the ground is near.
    if (box.min.z() - foot.z() < 2 * longest_side(box)) extend(box, {foot, foot});
  }
  add_colliders(room, last_time_, 1, box);
  box.min.z() = std::max(box.min.z(), lowest);
  return box;
}

}  // namespace mallow::program
