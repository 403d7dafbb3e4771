#include "scene/motion_warnings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>
#include <variant>

#include "colliders/pose.h"
#include "colliders/ways.h"

namespace mallow {
namespace {

/// Half a turn [degrees]: from one keyframe to the next things turn the shorter way round.
constexpr float k_half_turn = 180;
/// Times a frame that the way of a nozzle is looked at, and times in all, at the most.
constexpr double k_looks = 4, k_most_looks = 4000;
/// Nobody means a share of the spacing that is as small as this.
constexpr float k_rounding_depth = 0.01f;
/// Of its length, how far beside the place where it turns the axis of what is round may be.
constexpr float k_through = 1e-4f;
/// Places on the rim of a mouth that are looked at, beside its middle.
constexpr int k_rim = 8;

/// What turns farther between two keyframes than it can: 0 to 360 degrees is no turn at all.
void look_at_turns(const std::string& what, std::span<const SceneKeyframe> keys,
                   std::vector<std::string>& all) {
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const float turn = (keys[k].rotate - keys[k - 1].rotate).cwiseAbs().maxCoeff();
    if (turn < k_half_turn) continue;
    std::ostringstream text;
    text << what << ": keyframes[" << k << "].rotate is " << turn
         << " degrees from the one before, and the shorter way round is taken: give a keyframe for at most "
            "every "
         << k_half_turn - 1 << " degrees, or angular_velocity";
    all.push_back(text.str());
    return;
  }
}

/// Round about an axis through where it turns, which it is taken to turn about: nobody sees how fast.
bool is_round(const Collider& collider) {
  return std::visit(
      [](const auto& shape) {
        if constexpr (requires {
                        shape.center;
                        shape.radius;
                      })
          return shape.center.isZero(0);
        else if constexpr (requires {
                             shape.start;
                             shape.end;
                           })
          return shape.start.cross(shape.end).norm() <= k_through * (shape.end - shape.start).squaredNorm();
        else
          return false;
      },
      collider.shape);
}

/// As fast as it ever turns before the run ends [rad/s].
double fastest_turn(const Collider& collider, double seconds) {
  double most = collider.keyframes.empty() ? static_cast<double>(collider.angular_velocity.norm()) : 0;
  for (std::size_t k = 1; k < collider.keyframes.size() && collider.keyframes[k - 1].time < seconds; ++k) {
    const PoseKeyframe &from = collider.keyframes[k - 1], &to = collider.keyframes[k];
    const Twist twist = twist_between(from.pose, to.pose, to.time - from.time);
    most = std::max(most, static_cast<double>(twist.angular_velocity.norm()));
  }
  return most;
}

/// What turns by half a turn and more from one frame to the next: 200 degrees a second as 200 rad/s.
void look_at_frames(const SceneCollider& collider, std::size_t number, double seconds, double frame,
                    std::vector<std::string>& all) {
  const double rate = fastest_turn(collider, seconds), degrees = rate * frame * 180 / std::numbers::pi;
  if (is_round(collider) || degrees < static_cast<double>(k_half_turn)) return;
  std::ostringstream unit, text;
  if (collider.keyframes.empty())
    unit << "angular_velocity is in rad/s, and " << rate << " degrees a second are "
         << rate * std::numbers::pi / 180 << "; ";
  text << "collider[" << number << "]: turns by " << std::round(degrees)
       << " degrees from one frame to the next, and frames show no more than half a turn, nor which way; "
       << unit.str() << "let it turn slower, or give a shorter frame_time";
  all.push_back(text.str());
}

Pose pose_of(const SceneEmitter& emitter, double time) {
  if (!emitter.keyframes.empty()) return pose_at(emitter.keyframes, time);
  Pose pose = emitter.pose;
  pose.translation += time * emitter.velocity.cast<double>();
  return pose;
}

Pose pose_of(const Collider& collider, double time) {
  return collider.keyframes.empty() ? pose_after(collider, time) : pose_at(collider.keyframes, time);
}

/// Places in the mouth of an emitter, in its frame: its middle and its rim, or its points.
std::vector<Eigen::Vector3d> mouth_of(const SceneEmitter& emitter) {
  std::vector<Eigen::Vector3d> places;
  for (const Vec3& x : emitter.points) places.emplace_back(x.x(), x.y(), 0);
  if (!places.empty()) return places;
  places.emplace_back(0, 0, 0);
  const double a = static_cast<double>(emitter.radius.value_or(emitter.width.value_or(0) / 2));
  const double b = static_cast<double>(emitter.radius.value_or(emitter.height.value_or(0) / 2));
  for (int k = 0; k < k_rim; ++k) {
    const double angle = 2 * std::numbers::pi * k / k_rim;
    places.emplace_back(a * std::cos(angle), b * std::sin(angle), 0);
  }
  return places;
}

bool stands_in(const Collider& collider, const SceneEmitter& emitter, std::span<const Eigen::Vector3d> mouth,
               double time) {
  const Pose pose = pose_of(emitter, time);
  const Eigen::Matrix3d rotation = rotation_of(pose);
  const Eigen::Vector3d ahead(0, 0, 0.5 * static_cast<double>(emitter.spacing));
  return std::ranges::any_of(mouth, [&](const Eigen::Vector3d& x) {
    const Eigen::Vector3d there = pose.translation + rotation * (x + ahead);
    return nearest(collider, there.cast<float>()).distance < -k_rounding_depth * emitter.spacing;
  });
}

/// When it first comes to stand in the mouth while the emitter flows, if it does; not where it stands there
/// from the start, as the simulation tells of that.
std::optional<double> first_met(const Collider& collider, const SceneEmitter& emitter, double seconds,
                                double frame) {
  const std::vector<Eigen::Vector3d> mouth = mouth_of(emitter);
  Collider there = collider;
  there.keyframes.clear();
  const auto is_met = [&](double time) {
    there.pose = pose_of(collider, time);
    return stands_in(there, emitter, mouth, time);
  };
  if (is_met(0)) return std::nullopt;
  const double begin = emitter.start.value_or(0), end = std::min(seconds, emitter.stop.value_or(seconds));
  const double step = std::max(frame / k_looks, (end - begin) / k_most_looks);
  for (double time = begin; time < end; time += step)
    if (emitter.speed.at(time) > 0 && is_met(time)) return time;
  return std::nullopt;
}

/// What leaves a nozzle inside of a collider is driven out of it.
void look_at_nozzle(const Scene& scene, std::size_t number, double seconds, double frame,
                    std::vector<std::string>& all) {
  const SceneEmitter& emitter = scene.emitters[number];
  const bool goes = !emitter.keyframes.empty() || !emitter.velocity.isZero(0);
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    if (!goes && !is_driven(scene.colliders[c])) continue;
    const std::optional<double> time = first_met(scene.colliders[c], emitter, seconds, frame);
    if (!time) continue;
    std::ostringstream text;
    text << "emitter[" << number << "]: at " << *time << " s collider[" << c
         << "] stands in its mouth, and drives out what leaves it; lead one of the two another way, or give "
            "an earlier stop";
    all.push_back(text.str());
  }
}

}  // namespace

std::vector<std::string> motion_warnings(const Scene& scene, double seconds, double frame) {
  std::vector<std::string> all;
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    look_at_turns("collider[" + std::to_string(c) + "]", scene.colliders[c].scene_keyframes, all);
    look_at_frames(scene.colliders[c], c, seconds, frame, all);
  }
  for (std::size_t e = 0; e < scene.emitters.size(); ++e) {
    look_at_turns("emitter[" + std::to_string(e) + "]", scene.emitters[e].scene_keyframes, all);
    look_at_nozzle(scene, e, seconds, frame, all);
  }
  return all;
}

}  // namespace mallow
