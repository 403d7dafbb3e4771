#include "tradeoff/knobs.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "mallow/errors.h"
#include "program/scene_changes.h"

namespace mallow::tradeoff {
namespace {

constexpr int k_default_iterations = 2;

Scene at_stride(Scene scene, int factor) {
  for (SceneMaterial& material : scene.materials) material.material.region_stride *= factor;
  return scene;
}

Scene with_voxels(Scene scene, float factor) {
  scene.surface = at_voxels(scene.surface, factor);
  return scene;
}

Scene native(Scene scene) {
  scene.solver.arithmetic = Arithmetic::native;
  return scene;
}

int iterations(const Scene& scene) {
  if (scene.solver.volume_iterations) return *scene.solver.volume_iterations;
  return std::ranges::any_of(scene.materials,
                             [](const SceneMaterial& m) { return m.material.plastic_yield.has_value(); })
             ? k_default_iterations
             : 0;
}

Scene at_iterations(Scene scene, int iterations) {
  scene.solver.volume_iterations = iterations;
  return scene;
}

/// How a shape or a mesh is filled with points; null for bodies that are not.
Sampling* sampling_of(SceneBody& body) {
  return std::visit(
      [](auto& source) -> Sampling* {
        if constexpr (requires { source.sampling; })
          return &source.sampling;
        else
          return nullptr;
      },
      body.source);
}

/// Boxes, shapes and meshes with cells `factor` times as large; nothing where there are other bodies.
std::optional<Scene> coarser(Scene scene, float factor) {
  if (!scene.emitters.empty() || scene.bodies.empty()) return std::nullopt;
  for (SceneBody& body : scene.bodies) {
    if (auto* box = std::get_if<Lattice>(&body.source)) {
      const Lattice before = *box;
      box->spacing *= factor;
      for (std::size_t a = 0; a < 3; ++a) {
        const float size = static_cast<float>(before.count[a]) * before.spacing;
        box->count[a] = static_cast<int>(std::lround(size / box->spacing));
        if (box->count[a] < 2) return std::nullopt;
        // In the middle of where it was, but never through the floor that it stands on.
        if (a < 2)
          box->corner[static_cast<Eigen::Index>(a)] +=
              0.5f * (size - static_cast<float>(box->count[a]) * box->spacing);
      }
    } else if (Sampling* sampling = sampling_of(body)) {
      if (sampling->spacing) *sampling->spacing *= factor;
      if (sampling->count)
        *sampling->count =
            std::max(8, static_cast<int>(static_cast<float>(*sampling->count) / std::pow(factor, 3.0f)));
    } else {
      return std::nullopt;
    }
  }
  if (scene.solver.support_radius) *scene.solver.support_radius *= factor;
  for (SceneMaterial& material : scene.materials) {
    if (material.material.region_radius) *material.material.region_radius *= factor;
    if (material.material.particle_mass && !material.material.rest_density)
      *material.material.particle_mass *= factor * factor * factor;
  }
  return scene;
}

}  // namespace

SceneTraits traits(const SimulationInfo& info) {
  return {.regions = std::ranges::any_of(info.bodies, [](const BodyInfo& body) { return body.regions > 0; }),
          .sums = info.sph || info.volume_iterations > 0};
}

std::vector<Setting> settings_around(const Scene& scene, const SceneTraits& traits) {
  std::vector<Setting> settings;
  const auto add = [&](const std::string& name, const Scene& changed, double cost) {
    settings.push_back({.name = name, .scene = changed, .cost = cost});
  };
  const auto add_quality = [&](Quality quality, double cost) {
    settings.push_back(
        {std::string("quality ") + name(quality), with_quality(scene, quality), cost, quality});
  };
  const auto steps = [&](float factor) { return at_time_step(scene, factor); };
  add("time_step_factor x 2", steps(2), 0.5);
  add_quality(Quality::realtime, 0.6);
  if (traits.regions) add("region_stride x 2", at_stride(scene, 2), 0.7);
  add("time_step_factor x 1.5", steps(1.5f), 0.67);
  add_quality(Quality::balanced, 0.8);
  if (traits.surface) add("voxels x 0.75", with_voxels(scene, 0.75f), 0.9);
  if (traits.sums) add("arithmetic native", native(scene), 0.9);
  if (traits.regions) {
    add("time_step_factor x 2, region_stride x 2", at_stride(steps(2), 2), 0.4);
    add("time_step_factor x 1.5, region_stride x 2", at_stride(steps(1.5f), 2), 0.5);
    add("region_stride x 3", at_stride(scene, 3), 0.6);
  }
  if (traits.sums) add("time_step_factor x 1.5, arithmetic native", native(steps(1.5f)), 0.6);
  add("time_step_factor x 0.5", steps(0.5f), 2);
  add_quality(Quality::accurate, 2);
  if (traits.regions) add("time_step_factor x 0.5, region_stride x 2", at_stride(steps(0.5f), 2), 1.4);
  if (const int n = iterations(scene); n > 0) {
    add("volume_iterations " + std::to_string(n - 1), at_iterations(scene, n - 1), 0.9);
    add("volume_iterations " + std::to_string(n + 1), at_iterations(scene, n + 1), 1.1);
  } else {
    add("volume_iterations 1", at_iterations(scene, 1), 1.3);
  }
  if (traits.surface) add("voxels x 1.5", with_voxels(scene, 1.5f), 1.2);
  if (const auto coarse = coarser(scene, 1.25f)) add("spacing x 1.25", *coarse, 0.45);
  std::erase_if(settings,
                [&](const Setting& setting) { return print_scene(setting.scene) == print_scene(scene); });
  return settings;
}

std::vector<Setting> settings_from(const Setting& from, const SceneTraits& traits) {
  std::vector<Setting> settings;
  const auto add = [&](const std::string& turn, const Scene& changed, double cost) {
    settings.push_back({.name = from.name + ", " + turn, .scene = changed, .cost = from.cost * cost});
  };
  const Scene& scene = from.scene;
  add("time_step_factor x 1.5", at_time_step(scene, 1.5f), 0.67);
  add("time_step_factor x 1.25", at_time_step(scene, 1.25f), 0.8);
  if (traits.regions) add("region_stride x 2", at_stride(scene, 2), 0.7);
  if (const int n = iterations(scene); n > 0)
    add("volume_iterations " + std::to_string(n - 1), at_iterations(scene, n - 1), 0.9);
  if (traits.surface) add("voxels x 0.75", with_voxels(scene, 0.75f), 0.9);
  if (traits.sums && scene.solver.arithmetic != Arithmetic::native)
    add("arithmetic native", native(scene), 0.9);
  add("time_step_factor x 0.8", at_time_step(scene, 0.8f), 1.25);
  return settings;
}

Scene finest(const Scene& scene, float factor) {
  Scene result = scene;
  result.solver.time_step_factor = scene.solver.time_step_factor * factor;
  for (SceneMaterial& material : result.materials) material.material.region_stride = 1;
  return result;
}

Knob parse_knob(const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto bad = [&]() -> ConfigError {
    return {"--knob",
            "'" + text + "' is not allowed: KEY=VALUE,VALUE,..., like solver.time_step_factor=0.5,2"};
  };
  if (equals == text.npos || equals == 0) throw bad();
  Knob knob{.key = text.substr(0, equals), .values = {""}};
  int depth = 0;
  bool quoted = false;
  for (const char c : text.substr(equals + 1)) {
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '[' || c == '{')) ++depth;
    if (!quoted && (c == ']' || c == '}')) --depth;
    if (c == ',' && depth == 0 && !quoted)
      knob.values.emplace_back();
    else
      knob.values.back() += c;
  }
  if (std::ranges::any_of(knob.values, &std::string::empty)) throw bad();
  return knob;
}

std::vector<Setting> turned(const Scene& scene, const Knob& knob, const std::vector<std::string>& overrides,
                            bool allow_outside_paths) {
  std::vector<Setting> settings;
  for (const std::string& value : knob.values) {
    std::vector<std::string> all = overrides;
    all.push_back(knob.key + "=" + value);
    settings.push_back({.name = all.back(),
                        .scene = read_scene(scene.file, all, {.allow_outside_paths = allow_outside_paths})});
  }
  return settings;
}

namespace {

/// Where lines belong: the header of a table, or, as TOML has no name for one of several tables, a comment.
std::string heading(const Scene& scene, const std::string& where) {
  const std::size_t bracket = where.find('[');
  if (bracket == where.npos) return "[" + where + "]\n";
  const std::string table = where.substr(0, bracket);
  const std::size_t index = std::stoul(where.substr(bracket + 1));
  // A scene may have left out some that nobody is made of.
  const std::string which = table == "material" && index < scene.materials.size()
                                ? "named \"" + scene.materials[index].name + '"'
                                : "number " + std::to_string(index + 1) + " in the file";
  return "# below the [[" + table + "]] that is " + which + ":\n";
}

}  // namespace

std::string lines_to_paste(const Scene& scene, const Scene& setting) {
  std::string text, section;
  for (const program::SceneChange& change : program::scene_changes(scene, setting)) {
    const std::size_t dot = change.key.find('.');
    const std::string where = change.key.substr(0, dot);
    if (where != section) {
      section = where;
      if (!text.empty()) text += '\n';
      text += heading(scene, where);
    }
    const std::string key = change.key.substr(dot + 1);
    text += change.now.empty() ? "# without " + key + "\n" : key + " = " + change.now + "\n";
  }
  return text;
}

}  // namespace mallow::tradeoff
