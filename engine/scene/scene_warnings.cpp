#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mallow/scene.h"
#include "simulation/settings.h"

namespace mallow {
namespace {

/// A film slower than this share of real time is hardly meant, and one whose frame_time is left out slower
/// than that, where seconds are seconds.
constexpr double k_slowest_film = 0.1, k_slowest_by_default = 0.5;

/// Of what a scene says moves from the start [m/s].
double fastest(const Scene& scene) {
  float speed = 0;
  for (const SceneBody& body : scene.bodies) speed = std::max(speed, body.velocity.norm());
  for (const Collider& collider : scene.colliders) speed = std::max(speed, collider.velocity.norm());
  for (const ScenePin& pin : scene.pins) speed = std::max(speed, pin.velocity.norm());
  return static_cast<double>(speed);
}

}  // namespace

std::vector<std::string> warnings(const Scene& scene, const SimulationInfo& info) {
  std::vector<std::string> all = info.warnings;
  const double frames = scene.run.frames, frame = frame_time(scene, info);
  const double seconds = frames * frame;
  if (scene.run.frames == 0) return all;
  const double gravity = static_cast<double>(scene.solver.gravity.norm());
  double spacing = std::numeric_limits<double>::infinity();
  for (const BodyInfo& body : info.bodies) spacing = std::min(spacing, static_cast<double>(body.spacing));
  const double way = 0.5 * gravity * seconds * seconds + fastest(scene) * seconds;
  const double film = frames / scene.render.frames_per_second;
  std::ostringstream text;
  text << "run: " << scene.run.frames << " frames of " << frame << " s cover " << seconds << " s";
  if (way > 0 && way < spacing)
    text << ", in which nothing falls or flies farther than " << way << " m, less than the spacing of "
         << spacing << " m; give more frames, or a longer frame_time";
  else if (is_in_metres(scene.solver.gravity) &&
           seconds < (scene.run.frame_time ? k_slowest_film : k_slowest_by_default) * film)
    text << ", and the film of them takes " << film << " s, " << std::round(film / seconds)
         << " times slower; frame_time = " << 1.0 / scene.render.frames_per_second << " shows real time";
  else
    return all;
  all.push_back(text.str());
  return all;
}

double frame_time(const Scene& scene, const SimulationInfo& info) {
  return scene.run.frame_time.value_or(static_cast<double>(info.time_step));
}

}  // namespace mallow
