#pragma once

#include "mallow/mesh.h"
#include "mallow/scene.h"

namespace mallow::bench {

/// The bodies of a scene before they were sampled.
class RestShape {
 public:
  RestShape(const Scene& scene, int threads);
  /// Mean distance of a mesh's vertices from the nearest body's surface [m].
  double mean_distance(const Mesh& mesh) const;

 private:
  std::vector<ImplicitShape> bodies_;
};

}  // namespace mallow::bench
