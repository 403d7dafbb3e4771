#include "view/settings_model.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "mallow/materials.h"
#include "program/scene_changes.h"
#include "program/shell_word.h"
#include "scene/scene_fields.h"
#include "simulation/settings.h"
#include "view/slider_span.h"

namespace mallow::view {
namespace {

using Kind = SettingsSection::Kind;
using scene_file::BoundField;
using scene_file::BoundFields;

BoundFields joined(BoundFields first, const BoundFields& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::string element(const char* list, std::size_t index) {
  return list + ('[' + std::to_string(index) + ']');
}

/// Calls visit(key, fields) with each shape of a collider that scenes hold as numbers: others are made of
/// points or a mesh.
template <class Visit>
void for_shapes(Collider& collider, const Visit& visit) {
  const auto visit_one = [&]<class Shape>(const std::string& before, Shape& shape) {
    if constexpr (std::is_same_v<typename scene_file::InScenes<Shape>::Type, Shape>)
      visit(before + ShapeTraits<Shape>::k_key, scene_file::fields(shape));
  };
  std::visit(
      [&]<class Shape>(Shape& shape) {
        if constexpr (std::is_same_v<Shape, Union>)
          for (std::size_t part = 0; part < shape.parts.size(); ++part)
            std::visit([&](auto& one) { visit_one(element("union", part) + '.', one); }, shape.parts[part]);
        else
          visit_one("", shape);
      },
      collider.shape);
}

}  // namespace

SettingsModel::SettingsModel(const Scene& scene, std::vector<std::string> overrides)
    : original_(scene), scene_(scene), overrides_(std::move(overrides)) {
  const auto add = [&](Kind kind, std::size_t index, std::string path, std::string title,
                       BoundFields fields) {
    sections_.push_back({kind, index, std::move(path), std::move(title), std::move(fields)});
  };
  const auto add_list = [&](Kind kind, const char* key, auto& list, const auto& fields_of) {
    for (std::size_t k = 0; k < list.size(); ++k)
      add(kind, k, element(key, k), element(key, k), fields_of(list[k]));
  };
  for (std::size_t k = 0; k < scene_.materials.size(); ++k)
    add(Kind::material, k, element("material", k), scene_.materials[k].name,
        scene_file::fields(scene_.materials[k]));
  add(Kind::solver, 0, "solver", "solver", scene_file::fields(scene_.solver));
  add(Kind::surface, 0, "surface", "surface", scene_file::fields(scene_.surface));
  add(Kind::run, 0, "run", "run", scene_file::fields(scene_.run));
  add(Kind::render, 0, "render", "render", scene_file::fields(scene_.render));
  add_list(Kind::body, "body", scene_.bodies,
           [](SceneBody& body) { return joined(scene_file::fields(body), scene_file::fields(body.source)); });
  add_list(Kind::collider, "collider", scene_.colliders,
           [](SceneCollider& collider) { return scene_file::fields(collider); });
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k)
    for_shapes(scene_.colliders[k], [&](const std::string& key, BoundFields fields) {
      const std::string path = element("collider", k) + '.' + key;
      add(Kind::collider, k, path, path, std::move(fields));
    });
  add_list(Kind::emitter, "emitter", scene_.emitters,
           [](SceneEmitter& emitter) { return scene_file::fields(emitter); });
  add_list(Kind::pin, "pin", scene_.pins,
           [](ScenePin& pin) { return joined(scene_file::fields(pin), scene_file::fields(pin.box)); });
  add_list(Kind::sink, "sink", scene_.sinks,
           [](SceneSink& sink) { return joined(scene_file::fields(sink), scene_file::fields(sink.box)); });
}

SettingsModel::Acts SettingsModel::acts(const SettingsSection& section, const BoundField& field) {
  const std::string_view name = field.name;
  const auto at_once = [](bool yes) { return yes ? Acts::at_once : Acts::when_built_anew; };
  switch (section.kind) {
    case Kind::solver:
      return at_once(changes_while_running(name));
    case Kind::material:
      return at_once(name != "name" && name != "temperature");
    case Kind::surface:
    case Kind::run:
      return Acts::at_once;
    case Kind::render:
      for (const char* const seen : {"eye", "target", "field_of_view", "frames_per_second"})
        if (name == seen) return Acts::at_once;
      return Acts::in_pictures_of_runs;
    default:
      return Acts::when_built_anew;
  }
}

std::function<void(Session&)> SettingsModel::command(const SettingsSection& section,
                                                     const BoundField& field) {
  if (acts(section, field) == Acts::when_built_anew) {
    ++waiting_;
    return {};
  }
  switch (section.kind) {
    case Kind::solver:
      return [solver = scene_.solver](Session& session) { session.set_solver(solver); };
    case Kind::material:
      return [index = section.index, material = scene_.materials[section.index]](Session& session) {
        session.set_material(index, material);
      };
    case Kind::surface:
      return [surface = scene_.surface](Session& session) { session.set_surface(surface); };
    case Kind::run:
      return [run = scene_.run](Session& session) { session.set_run(run); };
    case Kind::render:  // what a run's pictures have is there to be saved
      return [render = scene_.render](Session& session) { session.set_render(render); };
    default:
      return {};
  }
}

void SettingsModel::take(const Frame& frame) {
  if (frame.settings_number == settings_number_) return;
  settings_number_ = frame.settings_number;
  if (frame.waits) ++waiting_;
  // What waits to be rebuilt is kept: the frame does not know of it.
  for_fields<SolverConfig>([&](const auto& setting) {
    if (changes_while_running(setting.name)) scene_.solver.*setting.member = frame.solver.*setting.member;
  });
  for (std::size_t k = 0; k < std::min(frame.materials.size(), scene_.materials.size()); ++k) {
    const auto temperature = scene_.materials[k].material.temperature;
    scene_.materials[k].material = frame.materials[k];
    scene_.materials[k].material.temperature = temperature;
  }
}

std::function<void(Session&)> SettingsModel::take_preset(std::size_t material, const std::string& preset) {
  const MaterialPreset* const found = find_preset(preset);
  if (found == nullptr || material >= scene_.materials.size()) return {};
  SceneMaterial& target = scene_.materials[material];
  target.material = found->material;
  target.color = found->appearance.color;
  target.finish = found->appearance.finish;
  return [material, settings = target](Session& session) { session.take_preset(material, settings); };
}

bool SettingsModel::set_share(const BoundField& field, double share) {
  const auto set = [&]<class T>(T& value) {
    const double wanted = value_at(slider_span(field.range, static_cast<double>(value)), share);
    if constexpr (std::is_integral_v<T>)
      value = static_cast<T>(std::lround(wanted));
    else
      value = static_cast<T>(wanted);
    return true;
  };
  return std::visit(
      [&]<class T>(T* target) {
        if constexpr (std::is_same_v<T, int> || std::is_same_v<T, float>) {
          return set(*target);
        } else if constexpr (std::is_same_v<T, std::optional<int>> ||
                             std::is_same_v<T, std::optional<float>> ||
                             std::is_same_v<T, std::optional<double>>) {
          if (!*target) *target = static_cast<typename T::value_type>(std::max(1.0, field.range.lowest));
          return set(**target);
        } else if constexpr (std::is_same_v<T, Schedule>) {
          float value = target->at(0);
          set(value);
          *target = value;
          return true;
        } else if constexpr (std::is_same_v<T, Vec3>) {
          for (float& component : *target) set(component);
          return true;
        } else if constexpr (std::is_same_v<T, bool>) {
          *target = share >= 0.5;
          return true;
        } else {
          return false;
        }
      },
      field.target);
}

/// By the material's name, as a scene may have it from data/materials alone, where there is no list.
std::string SettingsModel::key_of_file(const std::string& key) const {
  constexpr std::string_view k_list = "material[";
  if (!key.starts_with(k_list)) return key;
  const std::size_t number = std::stoul(key.substr(k_list.size()));
  if (number >= original_.materials.size()) return key;
  const std::string& name = original_.materials[number].name;
  if (name.find_first_of(".[]") != name.npos) return key;
  return "material." + name + key.substr(key.find(']') + 1);
}

std::string SettingsModel::command_line(const std::string& run, std::vector<std::string> without) const {
  std::string line = "mallow run " + (run.empty() ? program::shell_word(scene_.file.string())
                                                  : "--resume " + program::shell_word(run));
  const auto set = [&](const std::string& change) { line += " --set " + program::shell_word(change); };
  if (run.empty())
    for (const std::string& own : overrides_) set(own);
  bool acts_no_more = false;
  for (const program::SceneChange& change : program::scene_changes(original_, scene_)) {
    if (change.now.empty())
      without.push_back(change.key + " left out");
    else if (!run.empty() && !change.key.starts_with("surface.") && !change.key.starts_with("render.") &&
             change.key != "run.frames")
      acts_no_more = true;
    else
      set(key_of_file(change.key) + "=" + change.now);
  }
  if (acts_no_more) without.insert(without.begin(), "settings of the motion that were changed here");
  std::string lacks;
  for (const std::string& one : without) lacks += (lacks.empty() ? "" : ", ") + one;
  return lacks.empty() ? line : line + "  # without " + lacks + ": S saves the scene as it stands";
}

}  // namespace mallow::view
