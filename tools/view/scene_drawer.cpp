#include "view/scene_drawer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "render/environment.h"
#include "view/shaders.h"

namespace mallow::view {
namespace {

constexpr int k_palette_width = 1024;

void point_attribute(GLuint place, GLint components) {
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, components, GL_FLOAT, GL_FALSE, 0, nullptr);
}

GLuint nearest_texture(GLenum target) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(target, texture);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

SceneDrawer::SceneDrawer(bool plain)
    : plain_(plain),
      shadow_size_(plain ? 512 : 1024),
      particles_(shaders::k_particle_vertex, with_light(plain_, shaders::k_particle_fragment)),
      obstacles_(plain_ ? with_light(true, shaders::k_plain_obstacle_vertex) : shaders::k_obstacle_vertex,
                 plain_ ? shaders::k_plain_lit_fragment : with_light(false, shaders::k_obstacle_fragment)),
      backdrop_(plain_),
      mesh_shadow_(shaders::k_mesh_vertex, shaders::k_nothing_fragment),
      particle_shadow_(shaders::k_particle_vertex, shaders::k_nothing_fragment),
      obstacle_shadow_(shaders::k_obstacle_vertex, shaders::k_nothing_fragment) {
  for (GLuint* array : {&mesh_array_, &particle_array_, &empty_array_}) glGenVertexArrays(1, array);
  palette_ = nearest_texture(GL_TEXTURE_2D);
  shadow_map_ = nearest_texture(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // Beyond its edge nothing throws a shadow.
  constexpr float k_far[] = {1, 1, 1, 1};
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, k_far);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, shadow_size_, shadow_size_, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_INT, nullptr);
  glGenFramebuffers(1, &shadow_framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_map_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glEnable(GL_PROGRAM_POINT_SIZE);
}

SceneDrawer::~SceneDrawer() {
  for (const GLuint array : {mesh_array_, particle_array_, empty_array_}) glDeleteVertexArrays(1, &array);
  for (const auto& [slot, solids] : solids_)
    for (const Solid& solid : solids) glDeleteVertexArrays(1, &solid.array);
  const GLuint textures[] = {palette_, shadow_map_};
  glDeleteTextures(2, textures);
  glDeleteFramebuffers(1, &shadow_framebuffer_);
}

void SceneDrawer::begin_scene(const OrbitCamera& camera, const Aabb& bounds) {
  bounds_ = bounds;
  const render::Environment studio(camera.as_render_camera(), true);
  to_key_ = studio.key_direction();
  key_color_ = studio.key_color();
  zenith_ = studio.sky({0, 0, 1});
  horizon_ = 2 * studio.sky({0.866025f, 0, 0.5f}) - zenith_;
  open_floor_ = studio.open_floor();
  wall_ = studio.backdrop({0, 0, 1});
  for (int side = 0; side < 6; ++side) {
    Vec3 normal = Vec3::Zero();
    normal[side / 2] = side % 2 == 0 ? 1.0f : -1.0f;
    ambient_[static_cast<std::size_t>(side)] = studio.ambient(normal);
  }
  place_light(bounds.min, bounds.max);
}

void SceneDrawer::place_light(const Vec3& low, const Vec3& high) {
  const Vec3 middle = (low + high) / 2;
  const float radius = std::max(0.62f * (high - low).norm(), 1e-6f);
  const Vec3 u = Vec3::UnitZ().cross(to_key_).normalized(), v = to_key_.cross(u);
  to_light_.setIdentity();
  to_light_.block<1, 3>(0, 0) = u.transpose() / radius;
  to_light_.block<1, 3>(1, 0) = v.transpose() / radius;
  to_light_.block<1, 3>(2, 0) = -to_key_.transpose() / (4 * radius);
  to_light_.block<3, 1>(0, 3) = -to_light_.block<3, 3>(0, 0) * middle;
  shadow_length_ = 2 * radius / static_cast<float>(shadow_size_);
  shadow_is_old_ = true;
}

void SceneDrawer::take(const Frame& frame) {
  take_palette(frame);
  take_mesh(frame);
  take_particles(frame);
  take_colliders(frame);
  throwers_ = bounds_of_throwers(frame);
  skips_shadows_ = plain_ && !skips_shadows_;
  shadow_is_old_ = shadow_is_old_ || !skips_shadows_;
}

GlProgram& SceneDrawer::mesh_program() {
  std::unique_ptr<GlProgram>& program = mesh_programs_[finish_];
  if (!program && plain_)
    program = std::make_unique<GlProgram>(with_light(true, shaders::k_plain_mesh_vertex, finish_),
                                          shaders::k_plain_lit_fragment);
  if (!program)
    program = std::make_unique<GlProgram>(shaders::k_mesh_vertex,
                                          with_light(false, shaders::k_mesh_fragment, finish_));
  return *program;
}

void SceneDrawer::take_mesh(const Frame& frame) {
  const Mesh& mesh = frame.mesh;
  closed_ = !frame.has_skins;
  index_count_ = static_cast<GLsizei>(3 * mesh.triangles.size());
  if (index_count_ == 0) return;
  glBindVertexArray(mesh_array_);
  vertices_.fill<Vec3>(GL_ARRAY_BUFFER, mesh.vertices);
  point_attribute(0, 3);
  normals_.fill<Vec3>(GL_ARRAY_BUFFER, mesh.normals);
  point_attribute(1, 3);
  if (mesh.material_ids.empty()) {
    glDisableVertexAttribArray(2);
    glVertexAttribI1ui(2, 0);
  } else {
    vertex_bodies_.fill<std::uint32_t>(GL_ARRAY_BUFFER, mesh.material_ids);
    glEnableVertexAttribArray(2);
    glVertexAttribIPointer(2, 1, GL_UNSIGNED_INT, 0, nullptr);
  }
  indices_.fill<std::array<std::uint32_t, 3>>(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles);
}

void SceneDrawer::take_particles(const Frame& frame) {
  point_count_ = static_cast<GLsizei>(frame.positions.size());
  if (point_count_ == 0) return;
  glBindVertexArray(particle_array_);
  points_.fill<Vec3>(GL_ARRAY_BUFFER, frame.positions);
  point_attribute(0, 3);
  point_bodies_.fill<std::uint32_t>(GL_ARRAY_BUFFER, frame.bodies);
  glEnableVertexAttribArray(2);
  glVertexAttribIPointer(2, 1, GL_UNSIGNED_INT, 0, nullptr);
  const bool has_values = frame.values.size() == frame.positions.size();
  shown_ = !has_values ? 0 : are_numbers(frame.shown) ? 2 : 1;
  value_range_ = frame.value_range;
  if (has_values) {
    point_values_.fill<float>(GL_ARRAY_BUFFER, frame.values);
    point_attribute(3, 1);
  } else {
    glDisableVertexAttribArray(3);
  }
}

void SceneDrawer::take_palette(const Frame& frame) {
  const std::size_t bodies = std::max<std::size_t>(1, frame.palette.size());
  const std::size_t rows = (4 * bodies + k_palette_width - 1) / k_palette_width;
  finish_ = frame.palette.empty() ? -1 : static_cast<int>(frame.palette[0].finish);
  std::vector<float> texels(4 * k_palette_width * rows, 0);
  for (std::size_t body = 0; body < frame.palette.size(); ++body) {
    const Appearance& look = frame.palette[body];
    float* const at = &texels[16 * body];
    if (static_cast<int>(look.finish) != finish_) finish_ = -1;
    std::copy_n(look.color.data(), 3, at);
    at[3] = static_cast<float>(look.finish);
    at[4] = body < frame.radii.size() ? frame.radii[body] : 0;
    // What the shader would else take powers for: see tools/render/finishes.cpp.
    for (int k = 0; k < 3; ++k) {
      at[8 + k] = std::pow(look.color[k], 0.75f);
      at[12 + k] = std::pow(look.color[k], 1.4f);
    }
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, palette_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, k_palette_width, static_cast<GLsizei>(rows), 0, GL_RGBA,
               GL_FLOAT, texels.data());
}

Eigen::Matrix4f SceneDrawer::to_shadow() const {
  Eigen::Matrix4f to_map = Eigen::Matrix4f::Identity();
  to_map.diagonal().head<3>().setConstant(0.5f);
  to_map.col(3).head<3>().setConstant(0.5f);
  return to_map * to_light_;
}

Aabb SceneDrawer::on_shadow_map(const Aabb& box) const {
  const auto seen = Eigen::AlignedBox3f(box.min, box.max).transformed(Eigen::Affine3f(to_shadow()));
  // A little larger, as the map is read beside, and between its texels.
  const Vec3 around = Vec3::Constant(4 / static_cast<float>(shadow_size_));
  return {seen.min() - around, seen.max() + around};
}

void SceneDrawer::set_light(GlProgram& program, const OrbitCamera& camera) {
  program.use();
  program.set("projection_view", camera.projection_view());
  program.set("palette", 0);
  program.set("shadow_map", 1);
  program.set("eye", camera.eye());
  program.set("to_key", to_key_);
  program.set("key_color", key_color_);
  program.set("ambient_sides", std::span<const Vec3>(ambient_));
  program.set("sky_horizon", horizon_);
  program.set("sky_zenith", zenith_);
  program.set("open_floor", open_floor_);
  program.set("wall", wall_);
  program.set("to_shadow", to_shadow());
  program.set("shadow_texel", 1.0f / static_cast<float>(shadow_size_));
  program.set("shadow_bias", 2.5f * shadow_length_);
  program.set("floor_height", floor_.value_or(-1e30f));
  program.set("floor_fade", std::max(0.5f * (bounds_.max - bounds_.min).norm(), 1e-6f));
  program.set("middle", Vec3((bounds_.min + bounds_.max) / 2));
}

void SceneDrawer::draw_shadows() {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_);
  glViewport(0, 0, shadow_size_, shadow_size_);
  glClear(GL_DEPTH_BUFFER_BIT);
  on_map_ = on_shadow_map(throwers_);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2);
  if (index_count_ > 0) {
    mesh_shadow_.use();
    mesh_shadow_.set("projection_view", to_light_);
    if (closed_) glEnable(GL_CULL_FACE);  // what looks away from the light lies behind what looks at it
    glCullFace(GL_BACK);
    glBindVertexArray(mesh_array_);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
    glDisable(GL_CULL_FACE);
  }
  if (point_count_ > 0) {
    particle_shadow_.use();
    particle_shadow_.set("projection_view", to_light_);
    particle_shadow_.set("palette", 0);
    particle_shadow_.set("shown", 0);
    particle_shadow_.set("pixels", 0.8f / shadow_length_);  // a little larger: no light between them
    glBindVertexArray(particle_array_);
    glDrawArrays(GL_POINTS, 0, point_count_);
  }
  obstacle_shadow_.use();
  obstacle_shadow_.set("projection_view", to_light_);
  draw_solids(obstacle_shadow_, true);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void SceneDrawer::draw(const OrbitCamera& camera, int width, int height, int left, int bottom) {
  GLint target = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &target);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDepthFunc(GL_LEQUAL);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, palette_);
  if (shadow_is_old_) draw_shadows();
  shadow_is_old_ = false;
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, shadow_map_);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  glViewport(left, bottom, width, height);
  glClear(GL_DEPTH_BUFFER_BIT);
  if (index_count_ > 0) {
    GlProgram& program = mesh_program();
    set_light(program, camera);
    program.set("has_insides", closed_ ? 0 : 1);
    if (closed_) glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glBindVertexArray(mesh_array_);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
    glDisable(GL_CULL_FACE);
  }
  if (point_count_ > 0) {
    set_light(particles_, camera);
    particles_.set("shown", shown_);
    particles_.set("value_range", value_range_[0], value_range_[1]);
    particles_.set("pixels", 0.5f * static_cast<float>(height) * camera.projection()(1, 1));
    particles_.set("right", camera.right());
    particles_.set("up", camera.up());
    glBindVertexArray(particle_array_);
    glDrawArrays(GL_POINTS, 0, point_count_);
  }
  set_light(obstacles_, camera);
  draw_solids(obstacles_, false);
  // Last, and far behind all: what is hidden costs nothing.
  glBindVertexArray(empty_array_);
  backdrop_.draw({.from_clip = camera.projection_view().inverse(),
                  .sees_floor = floor_ && camera.eye().z() > *floor_,
                  .shadows = on_map_},
                 [&](GlProgram& program) { set_light(program, camera); });
  glBindVertexArray(0);
  glDisable(GL_DEPTH_TEST);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace mallow::view
