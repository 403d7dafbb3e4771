#pragma once

#include <optional>
#include <span>
#include <vector>

#include "colliders/shapes.h"
#include "render/ray.h"
#include "render/renderer.h"

namespace mallow::render {

/// What is shown of a plane that is not the floor.
struct Board {
  Vec3 center, u, v;
  float half_side;
  /// From a point of the plane to the nearest edge; below 0 beside the board.
  float edge_distance(const Vec3& x) const;
};

/// The colliders as a picture shows them. One rule makes kept-in shapes, walls and ramps all look right: a
/// face is there only for what comes from its free side, for eye and light alike. So one looks into a pool
/// through its front walls, and light falls in.
class Obstacles {
 public:
  Obstacles(std::span<const Collider> colliders, const Camera& camera);

  /// Height of the floor: the highest horizontal plane that is free above.
  std::optional<float> floor() const { return floor_; }

  /// Whether all but the floor have bounds; walls have none.
  bool is_bounded() const { return is_bounded_; }
  /// What holds them then; nothing where there are none.
  const std::optional<Aabb>& box() const { return box_; }

  struct Hit {
    float t;
    Vec3 normal;  ///< towards the free side
    std::uint32_t shape;
  };
  /// The nearest face seen from its free side, nearer than t_max.
  std::optional<Hit> nearest(const Ray& ray, float t_max) const;
  /// Whether a ray towards the light leaves the free side of a face behind it, that is: is shaded by it.
  bool shades(const Ray& to_light) const;

  /// The trace of a face that is looked through: how much it covers, and whose it is.
  struct Veil {
    float cover = 0;  ///< in [0, 1]
    float light = 0;  ///< linear grey of the veil
    std::uint32_t shape = 0;
  };
  Veil veil(const Ray& ray, float t_max) const;

 private:
  struct Shape {
    Primitive shape;  ///< a plane is given in the world
    Eigen::Matrix3f rotation;
    Vec3 translation;
    Aabb box;       ///< in the world; of a plane all there is
    bool is_solid;  ///< to what comes from the free side; the others are looked through entirely
    bool is_shell;  ///< looked through where it is seen from behind
    std::optional<Board> board;
  };
  template <class Solid>
  void add(const Solid& shape, const Pose& pose, const Camera& camera);
  void add(const Plane& plane, const Pose& pose, const Camera& camera);
  static Crossings cross(const Shape& shape, const Ray& ray);
  Veil look(const Shape& shape, const Vec3& position, float cosine) const;
  std::vector<Shape> shapes_;
  std::optional<float> floor_;
  bool is_bounded_ = true;
  std::optional<Aabb> box_;
  float view_size_;
};

/// Half the height of what the camera sees at its target [m]: the length that the look is measured in.
float view_size(const Camera& camera);

}  // namespace mallow::render
