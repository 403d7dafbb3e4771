#include "program/film_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "program/body_appearances.h"
#include "program/large_pieces.h"

namespace mallow::program {
namespace {

/// Moments at which a path is looked at from one end to the other.
constexpr int k_looks = 24;
/// A collider is seen whole where it is within so many sizes of what moves beside that.
constexpr float k_beside = 2;
/// A collider that goes through keyframes is a tool up to this size, in sizes of what moves.
constexpr float k_tool = 1.5f;

void extend(Aabb& box, const Aabb& other) {
  box.min = box.min.cwiseMin(other.min);
  box.max = box.max.cwiseMax(other.max);
}

Aabb grown(const Aabb& box, float margin) {
  return {box.min - Vec3::Constant(margin), box.max + Vec3::Constant(margin)};
}

bool holds(const Aabb& box, const Aabb& other) {
  return (other.min.array() >= box.min.array()).all() && (other.max.array() <= box.max.array()).all();
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
};

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

/// Adds what is seen of the colliders with what is in the box.
void add_colliders(const Room& room, double last, const Aabb& box, std::vector<Aabb>& boxes) {
  // What reaches farther than that is a part of the room, and its near part is seen; of the way of a tool
  // the far part too.
  const float size = longest_side(box);
  const Aabb near = grown(box, size), far = grown(box, k_beside * size);
  for (const Collider& collider : room.colliders)
    visit_parts(collider, [&]<class Shape>(const Shape& shape) {
      if constexpr (std::is_same_v<Shape, Plane>) return;  // endless
      const bool is_tool = !collider.keyframes.empty() && longest_side(bounds(shape)) <= k_tool * size;
      const Aabb whole = swept(shape, collider, last);
      const Aabb& seen = is_tool || holds(far, whole) ? far : near;
      const auto clamped = [&](const Vec3& x) -> Vec3 { return x.cwiseMax(seen.min).cwiseMin(seen.max); };
      boxes.push_back({clamped(whole.min), clamped(whole.max)});
    });
}

/// A box around boxes, of which there is one at least.
Aabb around(std::span<const Aabb> boxes) {
  Aabb box = boxes.front();
  for (const Aabb& other : boxes) extend(box, other);
  return box;
}

/// The bounds of positions, of which there is one at least.
Aabb bounds_of(const std::vector<Vec3>& positions) {
  Aabb box{positions.at(0), positions.at(0)};
  for (const Vec3& x : positions) extend(box, {x, x});
  return box;
}

/// The bounds of positions without those far from all others.
Aabb most_of(const std::vector<Vec3>& positions) {
  constexpr std::size_t k_rare = 100;  // one in so many may be far away
  const Aabb box = bounds_of(positions);
  const std::size_t rare = positions.size() / k_rare;
  if (rare == 0) return box;
  Aabb most;
  std::vector<float> values(positions.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::ranges::transform(positions, values.begin(), [&](const Vec3& x) { return x[axis]; });
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(rare);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(rare);
    std::nth_element(values.begin(), low, values.end());
    most.min[axis] = *low;
    std::nth_element(values.begin(), high, values.end());
    most.max[axis] = *high;
  }
  const Aabb near = grown(most, longest_side(most));
  return {box.min.cwiseMax(near.min), box.max.cwiseMin(near.max)};
}

/// What drops and crumbs reach that are not far from the large pieces.
void add_near(const std::vector<Vec3>& drops, Aabb& box) {
  constexpr float k_near = 0.25f;  // of the longest side
  const Aabb near = grown(box, k_near * longest_side(box));
  for (const Vec3& x : drops)
    if (holds(near, {x, x})) extend(box, {x, x});
}

/// Layers that a nozzle holds behind it, at most: as many as regions of the usual radius ask for, and more.
constexpr double k_most_layers = 24;

/// A nozzle as it is at a time.
class Nozzle {
 public:
  Nozzle(const SceneEmitter& emitter, double time) : spacing_(static_cast<double>(emitter.spacing)) {
    Pose pose = emitter.pose;
    if (!emitter.keyframes.empty())
      pose = pose_at(emitter.keyframes, time);
    else
      pose.translation += time * emitter.velocity.cast<double>();
    translation_ = pose.translation;
    rotation_ = Eigen::Quaterniond(pose.rotation).normalized();
    float side =
        emitter.radius.value_or(0.5f * std::max(emitter.width.value_or(0), emitter.height.value_or(0)));
    for (const Vec3& point : emitter.points) side = std::max(side, point.head<2>().norm());
    side_ = static_cast<double>(side);
  }

  /// Whether a place is behind it, where a strand is that has not left it.
  bool holds(const Vec3& x) const {
    const Eigen::Vector3d local = rotation_.conjugate() * (x.cast<double>() - translation_);
    // The nearest layer is half a spacing behind the mouth.
    if (local.z() > -0.25 * spacing_ || local.z() < -k_most_layers * spacing_) return false;
    return local.head<2>().cwiseAbs().maxCoeff() <= side_ + spacing_;
  }

 private:
  double spacing_, side_;
  Eigen::Vector3d translation_;
  Eigen::Quaterniond rotation_;
};

}  // namespace

std::vector<Collider> visible_colliders(const Scene& scene) {
  std::vector<Collider> colliders;
  for (const SceneCollider& collider : scene.colliders)
    if (collider.visible) colliders.push_back(collider);
  return colliders;
}

void FilmBounds::Reach::add(const Aabb& frame, std::size_t count) {
  boxes.push_back(frame);
  particles = std::max(particles, count);
}

void FilmBounds::add(const ParticleFrame& frame, std::span<const float> spacings) {
  if (frame.positions.empty()) return;
  last_time_ = std::max(last_time_, frame.time);
  std::vector<Nozzle> nozzles;
  for (const SceneEmitter& emitter : emitters_)
    if (!emitter.stop || frame.time <= *emitter.stop) nozzles.emplace_back(emitter, frame.time);
  if (nozzles.empty()) return add_seen(frame, spacings);
  ParticleFrame seen;
  seen.time = frame.time;
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    if (std::ranges::any_of(nozzles, [&](const Nozzle& nozzle) { return nozzle.holds(frame.positions[i]); }))
      continue;
    seen.positions.push_back(frame.positions[i]);
    seen.bodies.push_back(frame.bodies[i]);
  }
  if (seen.positions.empty())
    held_.push_back(bounds_of(frame.positions));
  else
    add_seen(seen, spacings);
}

/// All but what nozzles hold, which is something.
void FilmBounds::add_seen(const ParticleFrame& frame, std::span<const float> spacings) {
  const std::size_t count = frame.positions.size();
  if (frame.time <= 0) {  // nothing has flown off or come apart yet, however far from each other things begin
    const Aabb box = bounds_of(frame.positions);
    all_.add(box, count);
    whole_.add(box, count);
    return;
  }
  all_.add(most_of(frame.positions), count);
  const std::vector<bool> large = in_large_pieces(frame, spacings);
  std::vector<Vec3> pieces, drops;
  for (std::size_t i = 0; i < count; ++i) (large[i] ? pieces : drops).push_back(frame.positions[i]);
  if (2 * pieces.size() < count) return;  // it has come apart
  Aabb box = most_of(pieces);
  add_near(drops, box);
  whole_.add(box, count);
}

const std::vector<Aabb>& FilmBounds::reached() const {
  // What drips from a nozzle holds together only as long as it is little: it is seen wherever it goes.
  if (all_.boxes.empty()) return held_;
  return 10 * whole_.particles >= 9 * all_.particles ? whole_.boxes : all_.boxes;
}

std::vector<Aabb> FilmBounds::boxes(const Scene& scene) const {
  std::vector<Aabb> boxes = reached();
  if (boxes.empty()) return {{{-1, -1, -1}, {1, 1, 1}}};
  // The surface is half a spacing and a little outside of the particles.
  const float skin = spacings_.empty() ? 0 : 0.75f * *std::ranges::max_element(spacings_);
  for (Aabb& box : boxes) box = grown(box, skin);
  Aabb all = around(boxes);
  const Room room(scene);
  float lowest = -std::numeric_limits<float>::infinity();
  for (const Plane& plane : room.grounds) {
    const Vec3 middle = 0.5f * (all.min + all.max);
    const Vec3 foot(middle.x(), middle.y(), ground_height(plane, middle));
    lowest = std::max(lowest, std::min(foot.z(), all.min.z()));
    // How high something hangs is seen where the ground is near.
    if (all.min.z() - foot.z() >= 2 * longest_side(all)) continue;
    boxes.push_back({foot, foot});
    extend(all, boxes.back());
  }
  add_colliders(room, last_time_, all, boxes);
  for (Aabb& box : boxes) {
    box.min.z() = std::max(box.min.z(), lowest);
    box.max.z() = std::max(box.max.z(), lowest);
  }
  return boxes;
}

Aabb FilmBounds::box(const Scene& scene) const {
  return around(boxes(scene));
}

Aabb bounds_now(const Scene& scene, Simulation& simulation) {
  const std::vector<float> spacings = spacings_of(slot_bodies(simulation.info().bodies));
  Aabb box = FilmBounds(spacings, snapshot(simulation), scene.emitters).box(scene);
  const Vec3 middle = 0.5f * (box.min + box.max);
  for (const Plane& plane : Room(scene).grounds)
    if (const Vec3 foot(middle.x(), middle.y(), ground_height(plane, middle)); foot.z() < middle.z())
      extend(box, {foot, foot});
  return box;
}

}  // namespace mallow::program
