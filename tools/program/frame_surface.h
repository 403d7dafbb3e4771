#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mallow/mesh.h"
#include "mallow/skin.h"
#include "mallow/surface.h"

namespace mallow::program {

/// Draws what is seen of a simulation: the skins of bodies that have some, and a surface around the particles
/// of all others.
class FrameSurface {
 public:
  /// skins: must outlive this.
  FrameSurface(const SurfaceConfig& config, std::span<Skin> skins, int threads);
  Mesh draw(const Simulation& simulation);
  /// The same into a mesh whose memory is used again.
  void draw(const Simulation& simulation, Mesh& mesh);

 private:
  Surfacer surfacer_;
  std::span<Skin> skins_;
};

/// The volume that a closed mesh encloses [m³].
double enclosed_volume(const Mesh& mesh);
/// Adds the vertices and triangles of `part`, which has the same columns.
void append(const Mesh& part, Mesh& mesh);
/// The vertices of some bodies and the triangles between them, in their order. chosen: by material id.
Mesh part_of(const Mesh& mesh, const std::vector<bool>& chosen);

}  // namespace mallow::program
