#include "textbook/from_scene.h"

#include <map>
#include <string>

namespace mallow::textbook {

Textbook from_scene(const Scene& scene, int threads) {
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
    textbook.add_body(sample(body, scene.file, threads), group);
  }
  for (const Collider& collider : scene.colliders) textbook.add_collider(collider);
  for (const ScenePin& pin : scene.pins) textbook.pin(pin.box, pin.velocity);
  return textbook;
}

}  // namespace mallow::textbook
