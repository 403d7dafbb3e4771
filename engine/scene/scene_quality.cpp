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
  // Without a frame time, a step is a frame: frames must not grow or shrink with the steps.
  if (result.solver.time_step != scene.solver.time_step)
    result.run.frame_time = scene.run.frame_time.value_or(scene.solver.time_step);
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
