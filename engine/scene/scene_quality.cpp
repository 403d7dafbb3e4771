#include "mallow/quality.h"
#include "mallow/scene.h"

namespace mallow {

Scene at_time_step(const Scene& scene, float factor) {
  Scene result = scene;
  result.solver = at_time_step(scene.solver, factor);
  for (SceneMaterial& material : result.materials)
    material.material = at_time_step(material.material, scene.solver, factor);
  result.run.frame_time = scene.run.frame_time.value_or(scene.solver.time_step);
  return result;
}

}  // namespace mallow
