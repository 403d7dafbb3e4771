#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "config/gravity_units.h"
#include "mallow/materials.h"
#include "mallow/scene.h"
#include "scene/motion_warnings.h"
#include "scene/scene_fields.h"
#include "scene/surface_warnings.h"

namespace mallow {
namespace {

/// A film slower than this share of real time is hardly meant, and one whose frame_time is left out slower
/// than that, where seconds are seconds.
constexpr double k_slowest_film = 0.1, k_slowest_by_default = 0.5;
/// A film so many times faster than real time, where frame_time is given, has it in milliseconds.
constexpr double k_fastest_film = 50;

/// Of what a scene says moves from the start [m/s].
double fastest(const Scene& scene) {
  float speed = 0;
  for (const SceneBody& body : scene.bodies) speed = std::max(speed, body.velocity.norm());
  for (const Collider& collider : scene.colliders) speed = std::max(speed, collider.velocity.norm());
  for (const ScenePin& pin : scene.pins) speed = std::max(speed, pin.velocity.norm());
  return static_cast<double>(speed);
}

/// Gravity was left out, and something is in pascals and metres: what, or nothing.
std::string in_pascals(const Scene& scene) {
  if (scene.solver.gravity != SolverConfig{}.gravity) return {};
  for (const SceneMaterial& material : scene.materials) {
    if (material.material.youngs_modulus)
      return "youngs_modulus of material '" + material.name + "' is in pascals";
    const MaterialPreset* preset = find_preset(material.name);
    if (preset && preset->material.rest_density == material.material.rest_density)
      return "material '" + material.name + "' is in kilograms and metres";
  }
  return {};
}

/// Gravity so many times that of the earth, or so many times less, is in other units than metres and seconds.
constexpr float k_other_units = 5, k_earth = 9.81f;  // [m/s²]
constexpr double k_rounding = 1e-6;                  // of frames by steps
/// Steps of a frame beyond which nobody waits for a film.
constexpr double k_most_steps = 1000;

/// Whether a material of a scene is the one of its name that scenes know.
bool is_preset(const SceneMaterial& material, const MaterialPreset& preset) {
  SceneMaterial own = material;
  SceneMaterial known{.name = preset.name, .material = preset.material};
  const scene_file::BoundFields fields = scene_file::fields(own.material),
                                known_fields = scene_file::fields(known.material);
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (scene_file::value_text(fields[i]) != scene_file::value_text(known_fields[i])) return false;
  return true;
}

/// What a preset says of stiffness and density where a scene's own material of that name says nothing.
std::string left_out_of(const Material& own, const Material& preset) {
  std::string text;
  if (preset.youngs_modulus && !own.youngs_modulus && !own.elastic_time_step) text = "a youngs_modulus";
  if (preset.rest_density && !own.rest_density && !own.particle_mass)
    text += (text.empty() ? "a" : " and a") + std::string(" rest_density");
  return text;
}

/// Materials that are known by name: in metres under the gravity of other units, or hidden by the scene's
/// own.
void look_at_presets(const Scene& scene, std::vector<std::string>& all) {
  const float gravity = scene.solver.gravity.norm();
  const bool other_units = gravity > k_other_units * k_earth || gravity < k_earth / k_other_units;
  const bool left_out = scene.solver.gravity == SolverConfig{}.gravity;
  for (const SceneMaterial& material : scene.materials) {
    const MaterialPreset* preset = find_preset(material.name);
    if (!preset) continue;
    const bool known = is_preset(material, *preset);
    std::ostringstream text;
    text << "material '" << material.name << "': ";
    if (known && other_units && gravity > 0 && !left_out)
      text << "its numbers are in metres, kilograms and seconds, and a gravity of " << gravity
           << " is not, as that of the earth is 9.81 m/s2; give all lengths in metres";
    else if (const std::string missing = left_out_of(material.material, preset->material);
             !known && !missing.empty() && is_in_metres(scene.solver.gravity))
      text << "the scene's own [[material]] is taken, not the one of that name that `mallow materials` lists "
              "and that has "
           << missing << "; give " << (missing.find(" and ") == missing.npos ? "it" : "them")
           << ", or leave the [[material]] out to take that one, or give it another name";
    else
      continue;
    all.push_back(text.str());
  }
}

/// Frames that take more steps than anyone waits for.
void look_at_steps(double frame, double frames, const SimulationInfo& info, std::vector<std::string>& all) {
  const double step = std::min(static_cast<double>(info.longest_step), info.unlimited_step);
  if (!(frame > k_most_steps * step)) return;
  const double steps = std::ceil(frame / step - k_rounding);
  std::ostringstream text;
  text << "run: a frame of " << frame << " s takes " << steps << " steps of " << step << " s or more, "
       << frames * steps << " in all; give a shorter frame_time, or what lets steps be longer: `mallow info` "
       << "says where theirs comes from";
  all.push_back(text.str());
}

/// What flows by less than this share of what it will, hardly flows.
constexpr double k_least_flow = 0.01;

/// Creep so slow that a run shows none.
void look_at_creep(const Scene& scene, double seconds, std::vector<std::string>& all) {
  for (const SceneMaterial& material : scene.materials) {
    if (!material.material.plastic_yield || !material.material.plastic_creep) continue;
    const auto creep = static_cast<double>(*material.material.plastic_creep);
    if (-std::expm1(-creep * seconds) >= k_least_flow) continue;
    std::ostringstream text;
    text << "material '" << material.name << "': plastic_creep " << creep << " 1/s takes " << 1 / creep
         << " s to flow, and the run covers " << seconds
         << " s: it flows by less than a hundredth of what it would; raise plastic_creep, or leave it out";
    all.push_back(text.str());
  }
}

/// What begins only when a run is over.
void look_at_beginnings(const Scene& scene, double seconds, std::vector<std::string>& all) {
  const auto look = [&](const char* list, std::size_t number, const char* key, double begin) {
    if (begin < seconds) return;
    std::ostringstream text;
    text << list << '[' << number << "]: " << key << ' ' << begin << " s is not reached, as the run covers "
         << seconds << " s; give an earlier time, or more frames";
    all.push_back(text.str());
  };
  const auto look_at_keyframes = [&](const char* list, std::size_t number, const auto& keys) {
    if (keys.size() > 1) look(list, number, "keyframes[0].time", static_cast<double>(keys.front().time));
  };
  for (std::size_t c = 0; c < scene.colliders.size(); ++c)
    look_at_keyframes("collider", c, scene.colliders[c].scene_keyframes);
  for (std::size_t e = 0; e < scene.emitters.size(); ++e) {
    look("emitter", e, "start", scene.emitters[e].start.value_or(-1));
    look_at_keyframes("emitter", e, scene.emitters[e].scene_keyframes);
  }
}

/// Numbers of degrees that are parts of a turn in radians, to this relative difference: twelfths of half a
/// turn, from a twelfth to two.
constexpr float k_same_turn = 1e-3f;

bool are_radians(const Vec3& rotate) {
  const auto is_part_of_a_turn = [](float angle) {
    const float parts = std::abs(angle) * 12 / std::numbers::pi_v<float>, whole = std::round(parts);
    return whole >= 1 && whole <= 24 && std::abs(parts - whole) <= k_same_turn * whole;
  };
  return std::ranges::any_of(rotate, is_part_of_a_turn) &&
         std::ranges::all_of(rotate, [&](float angle) { return angle == 0 || is_part_of_a_turn(angle); });
}

/// A quarter of a turn is 90 degrees, not 1.5708.
void look_at_radians(const Scene& scene, std::vector<std::string>& all) {
  const auto look = [&](const std::string& what, const Vec3& rotate) {
    if (!are_radians(rotate)) return;
    const float most = rotate.cwiseAbs().maxCoeff();
    std::ostringstream text;
    text << what << ".rotate: " << most << " is in degrees, hardly a turn at all, and "
         << std::round(180 / std::numbers::pi_v<float> * most) << " degrees are " << most << " radians";
    all.push_back(text.str());
  };
  const auto look_at_all = [&](const char* list, const auto& ones) {
    for (std::size_t k = 0; k < ones.size(); ++k) {
      const std::string what = list + ('[' + std::to_string(k) + ']');
      look(what, ones[k].rotate);
      for (std::size_t i = 0; i < ones[k].scene_keyframes.size(); ++i)
        look(what + ".keyframes[" + std::to_string(i) + ']', ones[k].scene_keyframes[i].rotate);
    }
  };
  look_at_all("collider", scene.colliders);
  look_at_all("emitter", scene.emitters);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    std::visit(
        [&](const auto& source) {
          if constexpr (requires { source.placement.rotate; })
            look("body[" + std::to_string(b) + ']', source.placement.rotate);
        },
        scene.bodies[b].source);
}

/// Whether something follows the temperature of a material.
bool follows_heat(const Material& material) {
  return material.alpha_by_temperature || material.viscosity_by_temperature ||
         material.plastic_yield_by_temperature;
}

/// Heat that does not get anywhere in a run: what is to melt, or to set, stays as it is.
void look_at_heat(const Scene& scene, const SimulationInfo& info, double seconds,
                  std::vector<std::string>& all) {
  const bool any_heats = std::ranges::any_of(
      scene.colliders, [](const SceneCollider& collider) { return collider.temperature.has_value(); });
  if (!any_heats) return;
  for (const SceneMaterial& material : scene.materials) {
    const Material& m = material.material;
    const auto body = std::ranges::find(info.bodies, material.name, &BodyInfo::material);
    if (body == info.bodies.end() || !follows_heat(m) || !(m.conductivity > 0)) continue;
    // Half of a sudden change has come this far. [Carslaw & Jaeger, 2.4]
    const double by_conductivity = seconds / (static_cast<double>(body->rest_density) * m.specific_heat);
    const double way = std::sqrt(by_conductivity * static_cast<double>(m.conductivity));
    const double spacing = static_cast<double>(body->spacing);
    if (way >= spacing) continue;
    std::ostringstream text;
    text << "material '" << material.name << "': in the " << seconds << " s of the run heat comes " << way
         << " m far into it, less than its spacing of " << spacing
         << " m, so that nothing melts or sets but what starts so; real matter is as slow: a conductivity of "
         << 9 * spacing * spacing / by_conductivity << " takes it three spacings far, or give a longer run";
    all.push_back(text.str());
  }
}

/// A skin follows all particles that it was bound to, or nothing.
void look_at_skins(const Scene& scene, std::vector<std::string>& all) {
  if (scene.sinks.empty()) return;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (!scene.bodies[b].skin.empty())
      all.push_back("body[" + std::to_string(b) +
                    "]: its skin ends the run where a sink takes a particle of it; leave out the skin, or "
                    "keep the body from the sink");
}

}  // namespace

std::vector<std::string> warnings(const Scene& scene, const SimulationInfo& info) {
  std::vector<std::string> all = info.warnings;
  if (const std::string what = in_pascals(scene); !what.empty())
    all.push_back("solver: gravity is left out, and so 0.3 m/s2 as in the paper, but " + what +
                  "; gravity = [0.0, 0.0, -9.81] is that of the earth");
  look_at_presets(scene, all);
  look_at_radians(scene, all);
  look_at_skins(scene, all);
  for (std::string& text : surface_warnings(scene.surface, info)) all.push_back(std::move(text));
  const double frames = scene.run.frames, frame = frame_time(scene, info);
  const double seconds = frames * frame;
  if (scene.run.frames == 0) return all;
  look_at_creep(scene, seconds, all);
  look_at_heat(scene, info, seconds, all);
  look_at_beginnings(scene, seconds, all);
  for (std::string& text : motion_warnings(scene, seconds, frame)) all.push_back(std::move(text));
  const double gravity = static_cast<double>(scene.solver.gravity.norm());
  double spacing = std::numeric_limits<double>::infinity();
  for (const BodyInfo& body : info.bodies) spacing = std::min(spacing, static_cast<double>(body.spacing));
  const double way = 0.5 * gravity * seconds * seconds + fastest(scene) * seconds;
  const double film = frames / scene.render.frames_per_second;
  const bool in_metres = is_in_metres(scene.solver.gravity);
  const bool in_milliseconds = in_metres && scene.run.frame_time && seconds > k_fastest_film * film;
  if (!in_milliseconds) look_at_steps(frame, frames, info, all);
  std::ostringstream text;
  text << "run: " << scene.run.frames << " frames of " << frame << " s cover " << seconds << " s";
  if (way > 0 && way < spacing)
    text << ", in which nothing falls or flies farther than " << way << " m, less than the spacing of "
         << spacing << " m; give more frames, or a longer frame_time";
  else if (in_metres && seconds < (scene.run.frame_time ? k_slowest_film : k_slowest_by_default) * film)
    text << ", and the film of them takes " << film << " s, " << std::round(film / seconds)
         << " times slower; frame_time = " << 1.0 / scene.render.frames_per_second << " shows real time";
  else if (in_milliseconds)
    text << ", and the film of them takes " << film << " s, " << std::round(seconds / film)
         << " times faster; frame_time is in seconds, and " << 1.0 / scene.render.frames_per_second
         << " shows real time";
  else
    return all;
  all.push_back(text.str());
  return all;
}

double frame_time(const Scene& scene, const SimulationInfo& info) {
  return scene.run.frame_time.value_or(static_cast<double>(info.time_step));
}

}  // namespace mallow
