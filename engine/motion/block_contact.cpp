#include "motion/block_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Distances here and those of `nearest` are rounded differently, by a few 1e-7 of the coordinates.
constexpr float k_rounding = 1e-5f;

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
  return {Obstacle::box, false, {box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
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

/// A block that meets the parts of a collider one after the other. A part may throw it at the next one, so
/// that the rows in reach are found for each.
class BlockMeeting {
 public:
  BlockMeeting(ContactBlock& block, const Collider& collider, const ContactStep& step,
               const ContactKernels& kernels, VectorColumn& velocity)
      : block_(block),
        surface_(contact_surface(collider)),
        step_(step),
        kernels_(kernels),
        velocity_(velocity) {}

  void operator()(const Plane& plane) { at(plane); }
  void operator()(const Sphere& sphere) { at(sphere); }
  void operator()(const Box& box) {
    if (!box.inside) return at(box);
    for (const Plane& face : faces(box)) at(face);
  }
  void operator()(const Union& shapes) {
    for (const Primitive& part : shapes.parts) std::visit([&](const auto& shape) { (*this)(shape); }, part);
  }

 private:
  template <class Shape>
  void at(const Shape& shape) {
    const Obstacle o = obstacle(shape);
    const float reach = step_.contact_offset + step_.time_step * (std::sqrt(block_.bounds.squared_speed) +
                                                                  Vec3(surface_.velocity).norm());
    const float slack = k_rounding * (largest_coordinate(o, block_.bounds) + reach);
    // What is not a number is not far, either.
    if (least_distance(o, block_.bounds) > reach + slack) return;
    const std::size_t count = find_near_rows(o, slack);
    const std::size_t left =
        kernels_.resolve(o, surface_, step_, raw(block_.position), raw(block_.before), rows_.data(), count,
                         raw(velocity_), block_.bounds.squared_speed);
    for (std::size_t k = 0; k < left; ++k) {
      const std::uint32_t i = rows_[k];
      const Vec3 x = block_.position.get(i), v = velocity_.get(i);
      const Vec3 way = step_.time_step * (v - Vec3(surface_.velocity));
      const Vec3 after = resolve_contact(surface_, meet(shape, step_.contact_offset, x, way), step_,
                                         block_.before.get(i), v);
      velocity_.set(i, after);
      block_.bounds.squared_speed = std::max(block_.bounds.squared_speed, after.squaredNorm());
    }
  }

  /// Into rows_; returns how many.
  std::size_t find_near_rows(const Obstacle& o, float slack) {
    std::array<std::uint8_t, k_block> flags;
    alignas(64) std::array<float, k_block> reach;
    std::fill_n(flags.begin(), block_.end - block_.begin, std::uint8_t{0});
    kernels_.reach(raw(std::as_const(velocity_)), surface_.velocity, step_.time_step, step_.contact_offset,
                   block_.begin, block_.end, reach.data());
    kernels_.mark(o, raw(block_.position), slack, block_.begin, block_.end, reach.data(), flags.data());
    std::size_t count = 0;
    for (std::size_t i = block_.begin; i < block_.end; ++i) {
      // Always written, kept only if near: no branch to predict.
      rows_[count] = static_cast<std::uint32_t>(i);
      count += flags[i - block_.begin] != 0 && !(block_.pin && block_.pin[i] != 0);
    }
    return count;
  }

  ContactBlock& block_;
  const ContactSurface surface_;
  const ContactStep& step_;
  const ContactKernels& kernels_;
  VectorColumn& velocity_;
  std::array<std::uint32_t, k_block> rows_;
};

}  // namespace

void resolve_contacts(const ContactBlock& rows, std::span<const Collider> colliders, const ContactStep& step,
                      const ContactKernels& kernels, VectorColumn& velocity) {
  ContactBlock block = rows;
  for (const Collider& collider : colliders) {
    BlockMeeting meeting(block, collider, step, kernels, velocity);
    std::visit([&](const auto& shape) { meeting(shape); }, collider.shape);
  }
}

}  // namespace mallow
