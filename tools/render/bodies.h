#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/mesh.h"
#include "render/obstacles.h"

namespace mallow::render {

/// The bodies of a frame, as triangles or balls, in Embree.
class Bodies {
 public:
  Bodies();

  /// The mesh and palette must outlive the rays. Throws ConfigError where a material id has no appearance.
  void set_mesh(const Mesh& mesh, std::span<const Appearance> palette);
  void set_points(std::span<const Vec3> positions, float radius, std::span<const std::uint32_t> bodies,
                  std::span<const Appearance> palette);

  struct Hit {
    float t;
    Vec3 position;
    Vec3 outside;  ///< where rays that leave the surface start
    Vec3 normal;   ///< smooth, towards the viewer
    Vec3 face;     ///< of the triangle itself, towards the viewer
    Vec3 albedo;
    Finish finish;
  };
  std::optional<Hit> nearest(const Ray& ray, float t_max) const;
  /// Distance to the nearest hit, k_far where there is none.
  float distance(const Ray& ray) const;
  bool occludes(const Ray& ray) const;

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  void commit(RTCGeometry geometry);
  void check() const;
  void fill_mesh_hit(const RTCRayHit& hit, Hit& result) const;

  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> scene_;
  const Mesh* mesh_ = nullptr;  // null: points
  std::vector<Vec3> normals_;   // per vertex, where the mesh has none
  std::span<const std::uint32_t> body_of_;
  std::span<const Appearance> palette_;
};

}  // namespace mallow::render
