#include "view/collider_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace mallow::view {
namespace {

constexpr int k_around = 64;  ///< corners of a circle
constexpr int k_cells = 56;   ///< along the longest side of what is meshed from distances

/// A point of a profile: along the axis, away from it, and the normal in these two.
struct ProfilePoint {
  float along, away, normal_along, normal_away;
};

/// A profile turned about the line from `start` along `axis`.
Mesh turned(const std::vector<ProfilePoint>& profile, const Vec3& start, const Vec3& axis) {
  const Vec3 other = std::abs(axis.z()) < 0.9f ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 u = axis.cross(other).normalized(), v = axis.cross(u);
  Mesh mesh;
  for (const ProfilePoint& point : profile)
    for (int k = 0; k < k_around; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / k_around;
      const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
      mesh.vertices.push_back(start + point.along * axis + point.away * out);
      mesh.normals.push_back((point.normal_along * axis + point.normal_away * out).normalized());
    }
  const auto corner = [](std::size_t ring, int k) {
    return static_cast<std::uint32_t>(ring * k_around + static_cast<std::size_t>(k % k_around));
  };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring)
    for (int k = 0; k < k_around; ++k) {
      mesh.triangles.push_back({corner(ring, k), corner(ring, k + 1), corner(ring + 1, k)});
      mesh.triangles.push_back({corner(ring + 1, k), corner(ring, k + 1), corner(ring + 1, k + 1)});
    }
  return mesh;
}

/// Two half circles of `radius`, `length` apart.
std::vector<ProfilePoint> round_profile(float radius, float length) {
  std::vector<ProfilePoint> profile;
  constexpr int k_steps = 16;
  for (int half = 0; half < 2; ++half)
    for (int k = 0; k <= k_steps; ++k) {
      const float angle =
          std::numbers::pi_v<float> / 2 * (static_cast<float>(k) / k_steps + static_cast<float>(half) - 1);
      const float along = std::sin(angle), away = std::cos(angle);
      profile.push_back({radius * along + (half == 0 ? 0 : length), radius * away, along, away});
    }
  return profile;
}

/// Flat ends of two radii, `length` apart.
std::vector<ProfilePoint> flat_profile(float start_radius, float end_radius, float length) {
  const float slope = start_radius - end_radius;
  return {{0, 0, -1, 0},
          {0, start_radius, -1, 0},
          {0, start_radius, slope, length},
          {length, end_radius, slope, length},
          {length, end_radius, 1, 0},
          {length, 0, 1, 0}};
}

void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& x : {Vec3(corner), Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)}) {
    mesh.vertices.push_back(x);
    mesh.normals.push_back(u.cross(v).normalized());
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

Mesh mesh_of_box(const Box& box) {
  Mesh mesh;
  const Vec3 side = box.max - box.min;
  const Vec3 x(side.x(), 0, 0), y(0, side.y(), 0), z(0, 0, side.z());
  add_quad(mesh, box.min, y, x);
  add_quad(mesh, box.min, x, z);
  add_quad(mesh, box.min, z, y);
  add_quad(mesh, box.max, -x, -y);
  add_quad(mesh, box.max, -z, -x);
  add_quad(mesh, box.max, -y, -z);
  return mesh;
}

/// The zero of signed distances on a grid, a vertex in each cell that it crosses, pulled onto it (surface
/// nets [Gibson 1998]).
template <class Shape>
class DistanceMesher {
 public:
  explicit DistanceMesher(const Shape& shape) : shape_(shape), sign_(shape.inside ? -1.0f : 1.0f) {
    const Aabb box = bounds(shape);
    const Vec3 side = box.max - box.min;
    cell_ = side.maxCoeff() / (k_cells - 4);
    origin_ = box.min - Vec3::Constant(2 * cell_);
    for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(side[axis] / cell_) + 5;
    distances_.resize(static_cast<std::size_t>(size_.prod()));
    for (int k = 0; k < size_.z(); ++k)
      for (int j = 0; j < size_.y(); ++j)
        for (int i = 0; i < size_.x(); ++i) distances_[place({i, j, k})] = distance(point({i, j, k}));
  }

  Mesh mesh() {
    for (int k = 0; k + 1 < size_.z(); ++k)
      for (int j = 0; j + 1 < size_.y(); ++j)
        for (int i = 0; i + 1 < size_.x(); ++i) add_vertex({i, j, k});
    for (int axis = 0; axis < 3; ++axis)
      for (const auto& [at, vertex] : vertices_) add_face(at, axis);
    return std::move(mesh_);
  }

 private:
  using Index = Eigen::Vector3i;
  struct Less {
    bool operator()(const Index& a, const Index& b) const {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    }
  };
  Vec3 point(const Index& at) const { return origin_ + cell_ * at.cast<float>(); }
  std::size_t place(const Index& at) const {
    return static_cast<std::size_t>((at.z() * size_.y() + at.y()) * size_.x() + at.x());
  }
  /// Positive outside of the solid.
  float distance(const Vec3& x) const { return sign_ * nearest(shape_, x).distance; }

  void add_vertex(const Index& at) {
    Vec3 sum = Vec3::Zero();
    int crossings = 0;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        if (corner >> axis & 1) continue;
        Index a = at + Index(corner & 1, corner >> 1 & 1, corner >> 2), b = a;
        ++b[axis];
        const float from = distances_[place(a)], to = distances_[place(b)];
        if ((from < 0) == (to < 0)) continue;
        sum += point(a) + (point(b) - point(a)) * (from / (from - to));
        ++crossings;
      }
    if (crossings == 0) return;
    Vec3 x = sum / static_cast<float>(crossings);
    SurfacePoint near = nearest(shape_, x);
    x -= near.distance * near.normal;
    near = nearest(shape_, x + 0.05f * cell_ * sign_ * near.normal);
    vertices_[at] = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(x);
    mesh_.normals.push_back(sign_ * near.normal);
  }

  /// Around the edge from `at` along an axis.
  void add_face(const Index& at, int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (at[u] == 0 || at[v] == 0) return;
    Index end = at;
    ++end[axis];
    const bool starts_in = distances_[place(at)] < 0;
    if (starts_in == (distances_[place(end)] < 0)) return;
    Index cells[4] = {at, at, at, at};
    --cells[1][u];
    --cells[2][u];
    --cells[2][v];
    --cells[3][v];
    std::uint32_t corners[4];
    for (int k = 0; k < 4; ++k) {
      const auto found = vertices_.find(cells[k]);
      if (found == vertices_.end()) return;
      corners[k] = found->second;
    }
    if (!starts_in) std::swap(corners[1], corners[3]);
    mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
    mesh_.triangles.push_back({corners[0], corners[2], corners[3]});
  }

  const Shape& shape_;
  float sign_, cell_ = 1;
  Vec3 origin_;
  Index size_;
  std::vector<float> distances_;
  std::map<Index, std::uint32_t, Less> vertices_;
  Mesh mesh_;
};

struct Mesher {
  float size;
  Vec3 center;

  ColliderMesh operator()(const Plane& plane) const {
    const Vec3 normal = plane.normal.normalized();
    const float offset = plane.offset / plane.normal.norm();
    const Vec3 level = Vec3::UnitZ().cross(normal);
    const Vec3 u = level.norm() > 1e-3f ? Vec3(level.normalized()) : Vec3::UnitX();
    const Vec3 v = normal.cross(u);
    const Vec3 middle = center - (normal.dot(center) - offset) * normal;
    ColliderMesh result;
    result.is_flat = true;
    add_quad(result.mesh, middle - size * (u + v), 2 * size * u, 2 * size * v);
    return result;
  }
  ColliderMesh operator()(const Sphere& sphere) const {
    return {turned(round_profile(sphere.radius, 0), sphere.center, Vec3::UnitZ()), sphere.inside};
  }
  ColliderMesh operator()(const Box& box) const { return {mesh_of_box(box), box.inside}; }
  ColliderMesh operator()(const Capsule& capsule) const {
    const Vec3 axis = capsule.end - capsule.start;
    return {turned(round_profile(capsule.radius, axis.norm()), capsule.start, axis.normalized()),
            capsule.inside};
  }
  ColliderMesh operator()(const Cylinder& cylinder) const {
    const Vec3 axis = cylinder.end - cylinder.start;
    return {turned(flat_profile(cylinder.radius, cylinder.radius, axis.norm()), cylinder.start,
                   axis.normalized()),
            cylinder.inside};
  }
  ColliderMesh operator()(const Cone& cone) const {
    const Vec3 axis = cone.end - cone.start;
    return {
        turned(flat_profile(cone.start_radius, cone.end_radius, axis.norm()), cone.start, axis.normalized()),
        cone.inside};
  }
  /// Any other by its distances.
  template <class Shape>
  ColliderMesh operator()(const Shape& shape) const {
    return {DistanceMesher<Shape>(shape).mesh(), shape.inside};
  }
};

}  // namespace

ColliderMesh mesh_of(const Primitive& part, float size, const Vec3& center) {
  return std::visit(Mesher{size, center}, part);
}

}  // namespace mallow::view
