#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "view/backdrop.h"
#include "view/camera.h"
#include "view/frame.h"
#include "view/gl_program.h"

namespace mallow::view {

/// Draws frames with OpenGL 3.3: surfaces, particles as balls, colliders, the studio around them, and the key
/// light's shadow.
class SceneDrawer {
 public:
  /// plain: the driver draws in software, and shadows are to be cheap: harder, and drawn for every second
  /// picture.
  explicit SceneDrawer(bool plain);
  ~SceneDrawer();
  SceneDrawer(const SceneDrawer&) = delete;
  SceneDrawer& operator=(const SceneDrawer&) = delete;

  /// A scene begins: its light hangs beside the camera, and `bounds` is what is to be seen [m].
  void begin_scene(const OrbitCamera& camera, const Aabb& bounds);
  /// What is drawn from now on: copies it to the graphics memory, once.
  void take(const Frame& frame);
  /// Into the framebuffer that is bound, at a place in it; its depth is cleared.
  void draw(const OrbitCamera& camera, int width, int height, int left = 0, int bottom = 0);
  std::size_t triangles() const { return static_cast<std::size_t>(index_count_ / 3); }

 private:
  struct Solid {
    GLuint array = 0;
    std::unique_ptr<GlBuffer> vertices, normals, indices;
    GLsizei count = 0;
    bool inside = false, is_flat = false;
    Aabb box;  ///< of its own frame [m]
    Pose pose;
  };
  void take_mesh(const Frame& frame);
  void take_particles(const Frame& frame);
  void take_palette(const Frame& frame);
  void take_colliders(const Frame& frame);
  std::vector<Solid>& solids_of(const Collider& collider, std::uint32_t slot);
  void place_light(const Vec3& low, const Vec3& high);
  /// What throws shadows [m].
  Aabb bounds_of_throwers(const Frame& frame) const;
  Eigen::Matrix4f to_shadow() const;
  Aabb on_shadow_map(const Aabb& box) const;
  void draw_shadows();
  void set_light(GlProgram& program, const OrbitCamera& camera);
  void draw_solids(GlProgram& program, bool shadows);

  const bool plain_;
  const int shadow_size_;  ///< of the map, texels
  bool skips_shadows_ = false;
  /// The program for meshes of one finish, or of all where they have several.
  GlProgram& mesh_program();
  GlProgram particles_, obstacles_;
  Backdrop backdrop_;
  GlProgram mesh_shadow_, particle_shadow_, obstacle_shadow_;
  std::map<int, std::unique_ptr<GlProgram>> mesh_programs_;  ///< by finish; -1: of all
  int finish_ = -1;                                          ///< of all bodies
  GLuint mesh_array_ = 0, particle_array_ = 0, empty_array_ = 0;
  GlBuffer vertices_, normals_, vertex_bodies_, indices_;
  GlBuffer points_, point_bodies_, point_values_;
  GLsizei index_count_ = 0, point_count_ = 0;
  int shown_ = 0;  ///< of particles, as their shader has it
  std::array<float, 2> value_range_{0, 1};
  GLuint palette_ = 0, shadow_map_ = 0, shadow_framebuffer_ = 0;

  // Of the scene.
  int scene_ = -1;
  Aabb bounds_{{0, 0, 0}, {1, 1, 1}};
  std::optional<float> floor_;                          ///< height [m]
  std::map<std::uint32_t, std::vector<Solid>> solids_;  ///< by slot of the collider
  std::vector<std::uint32_t> slots_;                    ///< that are there
  Vec3 to_key_{0, 0, 1}, key_color_{1, 1, 1}, horizon_, zenith_, open_floor_, wall_;
  std::array<Vec3, 6> ambient_;
  Eigen::Matrix4f to_light_ = Eigen::Matrix4f::Identity();    ///< world to the clip space of the key light
  float shadow_length_ = 1;                                   ///< of a texel of the shadow map [m]
  Aabb throwers_{{0, 0, 0}, {1, 1, 1}}, on_map_ = throwers_;  ///< [m], and on the map as it is
  bool shadow_is_old_ = true;
  bool closed_ = true;  ///< the mesh is, and its insides are never seen
};

}  // namespace mallow::view
