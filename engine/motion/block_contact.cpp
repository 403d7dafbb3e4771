#include "motion/block_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Distances here and those of `nearest` are rounded differently, by a few 1e-7 of the coordinates.
constexpr float k_rounding = 1e-5f;
/// Parts of a union that are remembered as near; where more are, rows are resolved one by one.
constexpr std::size_t k_near_parts = 32;

Obstacle obstacle(const Plane& plane) {
  const float length = plane.normal.stableNorm();
  const Vec3 normal = plane.normal / length;
  return {Obstacle::plane, false, {normal[0], normal[1], normal[2]}, {plane.offset / length, 0, 0}};
}
Obstacle obstacle(const Sphere& sphere) {
  const Vec3& center = sphere.center;
  return {Obstacle::sphere, sphere.inside, {center[0], center[1], center[2]}, {sphere.radius, 0, 0}};
}
Obstacle obstacle(const Box& box) {
  return {
      Obstacle::box, box.inside, {box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
}

/// No point of the bounds is nearer to the obstacle, but for rounding.
float least_distance(const Obstacle& o, const BlockBounds& bounds) {
  const Vec3 a(o.a), b(o.b), min(bounds.min), max(bounds.max);
  switch (o.kind) {
    case Obstacle::plane:
      return a.cwiseProduct(min).cwiseMin(a.cwiseProduct(max)).sum() - b[0];
    case Obstacle::sphere:
      if (o.inside) return b[0] - (a - min).cwiseMax(max - a).norm();
      return (min - a).cwiseMax(a - max).cwiseMax(0.0f).norm() - b[0];
    case Obstacle::box:
      if (o.inside) return (min - a).cwiseMin(b - max).minCoeff();
      return (min - b).cwiseMax(a - max).cwiseMax(0.0f).norm();
  }
  return 0;
}

float largest_coordinate(const Obstacle& o, const BlockBounds& bounds) {
  float largest = 0;
  for (const float* const corner : {o.a, o.b, bounds.min, bounds.max})
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(corner[k]));
  return largest;
}

/// Which rows of a block, and which parts of a collider, may touch.
class NearRows {
 public:
  NearRows(const ContactBlock& block, const Collider& collider, const ContactStep& step,
           const ContactKernels& kernels, const VectorColumn& velocity)
      : block_(block), collider_(collider), step_(step), kernels_(kernels), velocity_(velocity) {
    greatest_reach_ = step.contact_offset +
                      step.time_step * (std::sqrt(block.bounds.squared_speed) + collider.velocity.norm());
    if (const Union* const shapes = std::get_if<Union>(&collider.shape)) {
      for (const Primitive& part : shapes->parts) std::visit([&](const auto& shape) { mark(shape); }, part);
    } else {
      std::visit([&](const auto& shape) { mark(shape); }, collider.shape);
    }
  }
  bool any() const { return any_; }

  /// v of these rows becomes what it is after contact; `fastest` the largest |v|² of them, where it is less.
  void resolve(VectorColumn& velocity, float& fastest) const {
    std::array<std::uint32_t, k_block> rows;
    std::size_t count = 0;
    for (std::size_t i = block_.begin; i < block_.end; ++i) {
      // Always written, kept only if near: no branch to predict.
      rows[count] = static_cast<std::uint32_t>(i);
      count += flags_[i - block_.begin] != 0 && !(block_.pin && block_.pin[i] != 0);
    }
    if (count_ <= k_near_parts) {
      const Vec3& u = collider_.velocity;
      count = kernels_.resolve(
          {parts_.data(), count_, {u[0], u[1], u[2]}, collider_.restitution, collider_.friction}, step_,
          raw(block_.position), rows.data(), count, raw(velocity), fastest);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 v = resolve_contact(collider_, step_, block_.position.get(rows[k]), velocity.get(rows[k]));
      velocity.set(rows[k], v);
      fastest = std::max(fastest, v.squaredNorm());
    }
  }

 private:
  void mark(const Union&) {}
  template <class Shape>
  void mark(const Shape& shape) {
    const Obstacle o = obstacle(shape);
    const float slack = k_rounding * (largest_coordinate(o, block_.bounds) + greatest_reach_);
    // What is not a number is not far, either.
    if (least_distance(o, block_.bounds) > greatest_reach_ + slack) return;
    if (!any_) {
      any_ = true;
      std::fill_n(flags_.begin(), block_.end - block_.begin, std::uint8_t{0});
      kernels_.reach(raw(velocity_), collider_.velocity.data(), step_.time_step, step_.contact_offset,
                     block_.begin, block_.end, reach_.data());
    }
    kernels_.mark(o, raw(block_.position), slack, block_.begin, block_.end, reach_.data(), flags_.data());
    if (count_ < k_near_parts) parts_[count_] = o;
    ++count_;
  }

  const ContactBlock& block_;
  const Collider& collider_;
  const ContactStep& step_;
  const ContactKernels& kernels_;
  const VectorColumn& velocity_;
  float greatest_reach_;
  bool any_ = false;
  std::size_t count_ = 0;
  std::array<Obstacle, k_near_parts> parts_;
  std::array<std::uint8_t, k_block> flags_;
  alignas(64) std::array<float, k_block> reach_;
};

}  // namespace

void resolve_contacts(const ContactBlock& rows, std::span<const Collider> colliders, const ContactStep& step,
                      const ContactKernels& kernels, VectorColumn& velocity) {
  ContactBlock block = rows;
  for (const Collider& collider : colliders) {
    const NearRows near(block, collider, step, kernels, velocity);
    if (near.any()) near.resolve(velocity, block.bounds.squared_speed);
  }
}

}  // namespace mallow
