#include "mallow/quality.h"
#include "mallow/scene.h"

namespace mallow {
Scene at_time_step(const Scene& scene, float factor) {
  Scene result = scene;
  result.solver = at_time_step(scene.solver, factor);
  return result;
}

Scene with_quality(const Scene& scene, Quality quality) {
  Scene result = scene;
  result.solver = with_quality(scene.solver, quality);
  for (SceneMaterial& material : result.materials)
    material.material = with_quality(material.material, scene.solver, quality);
  result.surface = with_quality(scene.surface, quality);
  return result;
}

}  // namespace mallow
