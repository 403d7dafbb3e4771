#pragma once

#include <cmath>

#include "mallow/vec3.h"

namespace mallow {

/// Rounds the vertices of a mesh to floats, relative to a point near them where one is wanted.
class ReadOrigin {
 public:
  /// origin: becomes that point; nullptr: vertices are relative to 0.
  explicit ReadOrigin(Eigen::Vector3d* origin) : origin_(origin) {
    if (origin_) origin_->setZero();
  }

  Vec3 relative(const Eigen::Vector3d& vertex) {
    if (!origin_) return vertex.cast<float>();
    if (first_)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (std::abs(vertex[axis]) > k_far) (*origin_)[axis] = std::round(vertex[axis]);
    first_ = false;
    return (vertex - *origin_).cast<float>();
  }

 private:
  /// Nearer to 0 than this, floats keep a ten-thousandth or better: what all meshes are read with.
  static constexpr double k_far = 1000;

  Eigen::Vector3d* origin_;
  bool first_ = true;
};

}  // namespace mallow
