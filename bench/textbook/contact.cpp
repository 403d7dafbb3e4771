#include "textbook/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

namespace mallow::textbook {
namespace {

/// φ and n = ∇φ at a point.
struct Surface {
  double distance;
  Vec normal;
};

Surface kept_inside(bool inside, const Surface& s) {
  return inside ? Surface{-s.distance, -s.normal} : s;
}

Surface distance_to(const Plane& plane, const Vec& x) {
  const Vec normal = plane.normal.cast<double>();
  return {(normal.dot(x) - plane.offset) / normal.norm(), normal.normalized()};
}

Surface distance_to(const Sphere& sphere, const Vec& x) {
  const Vec d = x - sphere.center.cast<double>();
  const double r = d.norm();
  // Any direction will do at the centre.
  return kept_inside(sphere.inside, {r - sphere.radius, r > 0 ? Vec(d / r) : Vec::UnitZ()});
}

Surface distance_to(const Box& box, const Vec& x) {
  const Vec min = box.min.cast<double>(), max = box.max.cast<double>();
  const Vec outside = x - x.cwiseMax(min).cwiseMin(max);
  if (outside != Vec::Zero()) return kept_inside(box.inside, {outside.norm(), outside.normalized()});

  // The nearest of the six faces: both depths are negative here.
  Surface face{-std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const double below = min[axis] - x[axis], above = x[axis] - max[axis];
    if (below > face.distance) face = {below, -Vec::Unit(axis)};
    if (above > face.distance) face = {above, Vec::Unit(axis)};
  }
  return kept_inside(box.inside, face);
}

/// The plane in which a particle meets a shape on its way of one step; infinitely far where it passes by.
template <class Shape>
Surface met_on_the_way(const Shape& shape, double offset, const Vec& x, const Vec& way) {
  double t = 0;
  Surface met = distance_to(shape, x);
  // Steps as long as the shape is far do not pass through it.
  for (int look = 0; look < 16 && met.distance - offset > way.norm() / 64; ++look) {
    t += (met.distance - offset) / way.norm();
    if (t >= 1) return {std::numeric_limits<double>::infinity(), met.normal};
    met = distance_to(shape, x + t * way);
  }
  return {met.distance - t * way.dot(met.normal), met.normal};
}

/// A particle that meets the parts of an obstacle one after the other.
class Meeting {
 public:
  Meeting(const Collider& collider, const ContactStep& step, const Vec& x, const Vec& before, const Vec& v)
      : collider_(collider), step_(step), x_(x), before_(before), v_(v) {}

  void operator()(const Plane& plane) { touch(distance_to(plane, x_)); }
  void operator()(const Sphere& sphere) {
    if (!sphere.inside) return touch(met_on_the_way(sphere, step_.contact_offset, x_, way()));
    const Surface end = distance_to(sphere, x_ + way());
    touch({end.distance - way().dot(end.normal), end.normal});
  }
  void operator()(const Box& box) {
    if (!box.inside) return touch(met_on_the_way(box, step_.contact_offset, x_, way()));
    for (int axis = 0; axis < 3; ++axis) {
      (*this)(Plane{Vec3::Unit(axis), box.min[axis]});
      (*this)(Plane{-Vec3::Unit(axis), -box.max[axis]});
    }
  }
  template <class Shape>
  void operator()(const Shape&) {
    throw std::invalid_argument("the textbook implementation knows planes, spheres and boxes alone");
  }
  void operator()(const Union& shapes) {
    for (const Primitive& part : shapes.parts)
      std::visit([this](const auto& shape) { (*this)(shape); }, part);
  }
  const Vec& velocity() const { return v_; }

 private:
  Vec surface_velocity() const { return collider_.velocity.cast<double>(); }
  Vec way() const { return step_.time_step * (v_ - surface_velocity()); }

  void touch(const Surface& met) {
    const double gap = met.distance - step_.contact_offset;
    const Vec relative = v_ - surface_velocity();
    const double normal_velocity = relative.dot(met.normal);
    if (gap + step_.time_step * normal_velocity >= 0) return;

    const Vec relative_before = before_ - surface_velocity();
    const double approach = relative_before.dot(met.normal);
    const double reach = -gap / step_.time_step;  // just touches at the end of the step
    const double target =
        std::max(gap >= 0 ? reach : std::min(reach, step_.max_push), bounce(approach, gap, met.normal));
    const Vec tangential = relative - normal_velocity * met.normal;
    const Vec tangential_before = relative_before - approach * met.normal;
    const double sliding = tangential.norm();
    const double friction = collider_.friction * (target - normal_velocity);
    double taken = sliding > 0 ? std::min(1.0, friction / sliding) : 1;
    if (const double along = tangential.dot(tangential_before); along < 0)
      taken = std::min(taken, std::max(0.0, 1 + along / tangential.squaredNorm()));
    v_ = surface_velocity() + target * met.normal + (1 - taken) * tangential;
  }

  /// So fast that a particle rises to e² of the height that it came from.
  double bounce(double approach, double gap, const Vec& normal) const {
    constexpr double k_none = -std::numeric_limits<double>::infinity();
    const double e = collider_.restitution;
    if (e == 0 || approach >= -2 * step_.gravity.norm() * step_.time_step) return k_none;
    const double gravity = std::max(0.0, -step_.gravity.dot(normal));
    const double half_kick = gravity * step_.time_step / 2, speed = half_kick - approach;
    const double square = e * e * speed * speed - 2 * (1 - e * e) * gravity * std::max(gap, 0.0);
    return square > 0 ? std::min(std::sqrt(square) - half_kick, -approach) : k_none;
  }

  const Collider& collider_;
  const ContactStep& step_;
  const Vec& x_;
  const Vec& before_;
  Vec v_;
};

}  // namespace

Vec resolve_contact(const Obstacle& obstacle, const ContactStep& step, const Vec& x, const Vec& before,
                    const Vec& v) {
  const Vec near = x - obstacle.moved;
  Meeting meeting(obstacle.collider, step, near, before, v);
  std::visit([&](const auto& shape) { meeting(shape); }, obstacle.collider.shape);
  return meeting.velocity();
}

}  // namespace mallow::textbook
