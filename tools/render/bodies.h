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

/// Whether rays that are traced together go about the same way.
enum class Rays : std::uint8_t { scattered, together };

/// The bodies of a frame, as triangles or balls, in Embree.
class Bodies {
 public:
  Bodies();

  /// The mesh and palette must outlive the rays. Throws ConfigError where a material id has no appearance.
  /// exposure: time for which the shutter is open [s]; what has velocities moves with them meanwhile.
  void set_mesh(const Mesh& mesh, std::span<const Appearance> palette, float exposure);
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
  /// The same for many rays, the nearest of ray i before t_max[i]; eight at a time, which is faster.
  void nearest(std::span<const Ray> rays, std::span<const float> t_max, std::span<std::optional<Hit>> hits,
               Rays kind) const;
  /// The nearest hit of each ray inside a body, where it leaves, or enters another body first.
  struct Exit {
    float t = k_far;       ///< k_far where there is none
    Vec3 normal{0, 0, 0};  ///< smooth, against the ray
    bool enters = false;   ///< another body
  };
  void exits(std::span<const Ray> rays, std::span<Exit> exits) const;
  /// Distance to the nearest hit, k_far where there is none.
  float distance(const Ray& ray) const;
  bool occludes(const Ray& ray) const;
  /// Clears seen[i] where ray i meets something; leaves it where it was 0 already.
  void occlude(std::span<const Ray> rays, std::span<std::uint8_t> seen, Rays kind) const;
  /// Of all bodies through the shutter's opening; nothing where there are none.
  const std::optional<Aabb>& box() const { return box_; }

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  void commit(RTCGeometry geometry);
  void check() const;
  /// What was hit, of Embree's record of it.
  Hit hit_of(const Ray& ray, float t, const RTCHit& record) const;
  Vec3 smooth_normal(const RTCHit& record) const;
  void fill_mesh_hit(const RTCHit& record, bool in_place, Hit& hit) const;
  const std::vector<Vec3>& normals() const { return mesh_->normals.empty() ? normals_ : mesh_->normals; }

  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> scene_;
  const Mesh* mesh_ = nullptr;  // null: points
  std::vector<Vec3> normals_;   // per vertex, where the mesh has none
  std::optional<Aabb> box_;
  std::span<const std::uint32_t> body_of_;
  std::span<const Appearance> palette_;
};

}  // namespace mallow::render
