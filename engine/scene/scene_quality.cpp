#include "mallow/quality.h"
#include "mallow/scene.h"

namespace mallow {
namespace {

/// The scene with `change`(config or material, old config) made to its solver and to every material.
template <class Change>
Scene changed(const Scene& scene, const Change& change) {
  Scene result = scene;
  result.solver = change(scene.solver);
  for (SceneMaterial& material : result.materials)
    material.material = change(material.material, scene.solver);
  // A frame time that is left out is the full step of the scene as written, not of the one it is turned into.
  if (result.solver.time_step != scene.solver.time_step)
    result.run.frame_time = scene.run.frame_time.value_or(static_cast<double>(scene.solver.time_step));
  return result;
}

}  // namespace

Scene at_time_step(const Scene& scene, float factor) {
  return changed(scene, [&](const auto&... old) { return at_time_step(old..., factor); });
}

Scene with_quality(const Scene& scene, Quality quality) {
  Scene result = changed(scene, [&](const auto&... old) { return with_quality(old..., quality); });
  result.surface = with_quality(scene.surface, quality);
  return result;
}

}  // namespace mallow
