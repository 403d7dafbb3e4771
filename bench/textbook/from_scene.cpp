#include "textbook/from_scene.h"

#include <map>
#include <string>

#include "mallow/errors.h"

namespace mallow::textbook {
namespace {

void refuse(bool is_there, const std::string& field) {
  if (is_there) throw ConfigError(field, "is not known to the textbook implementation");
}

/// What it would pass over without a word.
void check(const Scene& scene) {
  refuse(!scene.emitters.empty(), "emitter[0]");
  refuse(!scene.sinks.empty(), "sink[0]");
  bool has_fluid = false;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m].material;
    const std::string name = "material[" + std::to_string(m) + "].";
    refuse(material.temperature.has_value(), name + "temperature");
    refuse(material.adhesion > 0, name + "adhesion");
    has_fluid = has_fluid || material.alpha.highest() > 0;
  }
  refuse(scene.solver.wall_pressure && has_fluid && !scene.colliders.empty(), "solver.wall_pressure");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const std::string name = "body[" + std::to_string(b) + "].";
    refuse(!body.paint.empty(), name + "paint");
    refuse(body.merges, name + "merges");
    refuse(body.splits, name + "splits");
  }
}

/// Of columns of a file of points.
void check(const Body& body, std::size_t number) {
  const std::string name = "body[" + std::to_string(number) + "].";
  refuse(!body.alpha.empty(), name + "alpha");
  refuse(!body.stiffness.empty(), name + "stiffness");
  refuse(!body.plastic_yield.empty(), name + "plastic_yield");
  refuse(!body.temperature.empty(), name + "temperature");
}

}  // namespace

Textbook from_scene(const Scene& scene, int threads) {
  check(scene);
  Textbook textbook(scene.solver);
  std::map<std::string, Material> materials;
  for (const SceneMaterial& material : scene.materials) materials.emplace(material.name, material.material);

  // Bodies that name the same group share one; a body that names none has its own.
  std::map<std::string, std::size_t> groups;
  for (const SceneBody& body : scene.bodies) {
    const auto known = groups.find(body.group);
    const std::size_t group =
        known != groups.end() ? known->second : textbook.add_group(materials.at(body.material));
    if (!body.group.empty()) groups.emplace(body.group, group);
    const Body sampled = sample(body, scene.file, threads);
    check(sampled, static_cast<std::size_t>(&body - scene.bodies.data()));
    textbook.add_body(sampled, group);
  }
  for (const Collider& collider : scene.colliders) textbook.add_collider(collider);
  for (const ScenePin& pin : scene.pins) textbook.pin(pin.box, pin.velocity);
  return textbook;
}

}  // namespace mallow::textbook
