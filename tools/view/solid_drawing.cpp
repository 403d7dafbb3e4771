// Colliders, as SceneDrawer draws them.
#include <Eigen/Geometry>
#include <algorithm>

#include "view/collider_mesh.h"
#include "view/scene_drawer.h"

namespace mallow::view {
namespace {

/// As tools/render has it.
const Vec3 k_obstacle{0.42f, 0.405f, 0.385f};

/// A plane that is the floor of the studio.
bool is_floor(const Plane& plane) {
  return plane.normal.z() > 0.9999f * plane.normal.norm();
}

Eigen::Matrix4f matrix_of(const Pose& pose) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.block<3, 3>(0, 0) = Eigen::Quaterniond(pose.rotation).normalized().toRotationMatrix().cast<float>();
  matrix.block<3, 1>(0, 3) = pose.translation.cast<float>();
  return matrix;
}

}  // namespace

std::vector<SceneDrawer::Solid>& SceneDrawer::solids_of(const Collider& collider, std::uint32_t slot) {
  std::vector<Solid>& solids = solids_[slot];
  if (!solids.empty()) return solids;
  const Eigen::Affine3f frame(matrix_of(collider.pose));
  const Vec3 center = frame.inverse() * Vec3((bounds_.min + bounds_.max) / 2);
  visit_parts(collider, [&](const auto& part) {
    const ColliderMesh form = mesh_of(Primitive(part), 0.8f * (bounds_.max - bounds_.min).norm(), center);
    Solid& solid = solids.emplace_back();
    solid.inside = form.inside;
    solid.is_flat = form.is_flat;
    solid.box = mallow::bounds(form.mesh);
    solid.count = static_cast<GLsizei>(3 * form.mesh.triangles.size());
    solid.vertices = std::make_unique<GlBuffer>();
    solid.normals = std::make_unique<GlBuffer>();
    solid.indices = std::make_unique<GlBuffer>();
    glGenVertexArrays(1, &solid.array);
    glBindVertexArray(solid.array);
    solid.vertices->fill<Vec3>(GL_ARRAY_BUFFER, form.mesh.vertices);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    solid.normals->fill<Vec3>(GL_ARRAY_BUFFER, form.mesh.normals);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    solid.indices->fill<std::array<std::uint32_t, 3>>(GL_ELEMENT_ARRAY_BUFFER, form.mesh.triangles);
  });
  return solids;
}

void SceneDrawer::take_colliders(const Frame& frame) {
  if (frame.scene != scene_) {
    for (const auto& [slot, solids] : solids_)
      for (const Solid& solid : solids) glDeleteVertexArrays(1, &solid.array);
    solids_.clear();
    scene_ = frame.scene;
  }
  slots_.clear();
  floor_.reset();
  for (std::size_t k = 0; k < frame.colliders.size(); ++k) {
    const Collider& collider = frame.colliders[k];
    if (const Plane* plane = std::get_if<Plane>(&collider.shape)) {
      const Plane there = placed(*plane, collider.pose);
      if (is_floor(there)) {
        const float height = there.offset / there.normal.z();
        floor_ = std::max(height, floor_.value_or(height));
        continue;
      }
    }
    for (Solid& solid : solids_of(collider, frame.collider_slots[k])) solid.pose = collider.pose;
    slots_.push_back(frame.collider_slots[k]);
  }
}

Aabb SceneDrawer::bounds_of_throwers(const Frame& frame) const {
  Eigen::AlignedBox3f all;
  if (!frame.mesh.vertices.empty()) {
    const Aabb box = mallow::bounds(frame.mesh);
    all.extend(Eigen::AlignedBox3f(box.min, box.max));
  }
  for (const Vec3& x : frame.positions) all.extend(x);
  if (!frame.positions.empty()) {
    const float most = frame.radii.empty() ? 0 : std::ranges::max(frame.radii);
    all.extend(all.max() + Vec3::Constant(2 * most));
    all.extend(all.min() - Vec3::Constant(2 * most));
  }
  for (const std::uint32_t slot : slots_)
    for (const Solid& solid : solids_.at(slot)) {
      if (solid.inside || solid.is_flat) continue;  // as draw_solids() has it
      const Eigen::AlignedBox3f box(solid.box.min, solid.box.max);
      all.extend(box.transformed(Eigen::Affine3f(matrix_of(solid.pose))));
    }
  if (all.isEmpty()) return {};
  return {all.min(), all.max()};
}

void SceneDrawer::draw_solids(GlProgram& program, bool shadows) {
  for (const std::uint32_t slot : slots_)
    for (const Solid& solid : solids_[slot]) {
      // A board throws no shadow, as the light comes over it; what is looked into shows its far side.
      if (shadows && solid.is_flat) continue;
      program.set("pose", matrix_of(solid.pose));
      program.set("side", solid.inside ? -1.0f : 1.0f);
      program.set("albedo", k_obstacle);
      if (!shadows) {
        glEnable(GL_CULL_FACE);
        glCullFace(solid.inside ? GL_FRONT : GL_BACK);
      } else if (solid.inside) {
        continue;
      }
      glBindVertexArray(solid.array);
      glDrawElements(GL_TRIANGLES, solid.count, GL_UNSIGNED_INT, nullptr);
    }
  glDisable(GL_CULL_FACE);
}

}  // namespace mallow::view
