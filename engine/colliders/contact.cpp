#include "colliders/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "colliders/pose.h"
#include "colliders/shapes.h"
#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// Distances here and those in lanes are rounded differently, by a few 1e-7 of the coordinates.
constexpr float k_rounding = 1e-5f;

void place(const Collider& collider, const Vec3& origin, float time_step, InstructionLevel level,
           PlacedCollider& placed) {
  ContactSurface& surface = placed.surface;
  const Eigen::Vector3d stands = collider.pose.translation - origin.cast<double>();
  surface.restitution = collider.restitution;
  surface.friction = collider.friction;
  surface.turns = turns(collider);
  Eigen::Map<Vec3>(surface.velocity) = collider.velocity;
  Eigen::Map<Vec3>(surface.along) = collider.surface_velocity;
  surface.carries = !collider.surface_velocity.isZero(0);
  Eigen::Map<Vec3>(surface.translation) = stands.cast<float>();
  const Eigen::Matrix3d rotation = rotation_of(collider.pose);
  const auto seconds = static_cast<double>(time_step);
  const Eigen::Matrix3d spin = mean_spin(collider.angular_velocity, seconds);
  Eigen::Map<RowMajor>(surface.rotation) = rotation.cast<float>();
  Eigen::Map<RowMajor>(surface.turned) = (rotation + seconds * spin * rotation).cast<float>();
  Eigen::Map<RowMajor>(surface.spin) = spin.cast<float>();
  placed.measures_load = collider.measure_load;

  const Eigen::Vector3d by = surface.turns ? Eigen::Vector3d(0, 0, 0) : stands;
  placed.parts.clear();
  visit_parts(collider, [&]<class Shape>(const Shape& shape) {
    ShapeTraits<Shape>::visit_met(shape, [&]<class Met>(const Met& met) {
      placed.parts.push_back({ShapeTraits<Met>::numbers(met, by), &ShapeTraits<Met>::lanes(level)});
    });
  });
}

struct Bounds {
  Vec3 min, max;
  float largest() const { return std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff()); }
};

/// Around all points of a block as the shapes of a collider see them.
Bounds seen_bounds(const BlockBounds& block, const ContactSurface& surface) {
  const Vec3 min(block.min), max(block.max);
  if (!surface.turns) return {min, max};
  const Eigen::Matrix3f back = Eigen::Map<const RowMajor>(surface.rotation).transpose();
  const Vec3 middle = back * (0.5f * (min + max) - Vec3(surface.translation));
  const Vec3 half = back.cwiseAbs() * (0.5f * (max - min));
  return {middle - half, middle + half};
}

/// No point of the collider that is at one of a block is faster.
float most_speed(const BlockBounds& block, const ContactSurface& surface) {
  const float speed = Vec3(surface.velocity).norm();
  if (!surface.turns) return speed;
  const Vec3 min(block.min), max(block.max), c(surface.translation);
  return speed + Eigen::Map<const RowMajor>(surface.spin).norm() * (max - c).cwiseMax(c - min).norm();
}

using BlockRows = std::array<std::uint32_t, k_block>;

/// Of the rows [begin, end), those that are not pinned and not out of reach of a part. Returns how many.
std::size_t find_near_rows(const PlacedCollider::Part& part, const ContactSurface& surface,
                           const ContactStep& step, ConstVectors position, ConstVectors velocity, float slack,
                           std::size_t begin, std::size_t end, const std::uint16_t* pin, BlockRows& rows) {
  std::array<std::uint8_t, k_block> flags;
  std::fill_n(flags.begin(), end - begin, std::uint8_t{0});
  part.lanes->mark(part.numbers, surface, step, position, velocity, slack, begin, end, flags.data());
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    // Always written, kept only if near: no branch to predict.
    rows[count] = static_cast<std::uint32_t>(i);
    count += flags[i - begin] != 0 && !(pin && pin[i] != 0);
  }
  return count;
}

/// A block that meets the parts of a collider one after the other. A part may throw it at the next one, so
/// that the rows in reach are found for each.
class BlockMeeting {
 public:
  BlockMeeting(ContactBlock& block, const PlacedCollider& collider, const ContactStep& step,
               VectorColumn& velocity, ColliderLoad* load, ContactSums* touched)
      : block_(block),
        surface_(collider.surface),
        step_(step),
        velocity_(velocity),
        load_(collider.measures_load ? load : nullptr),
        touched_(touched),
        seen_(seen_bounds(block.bounds, surface_)),
        speed_(most_speed(block.bounds, surface_)) {
    largest_ = seen_.largest();
    if (surface_.turns) largest_ += Vec3(surface_.translation).norm();
  }

  void meet(const PlacedCollider::Part& part) {
    const float reach =
        step_.contact_offset + step_.time_step * (std::sqrt(block_.bounds.squared_speed) + speed_);
    float largest = largest_;
    for (const float number : part.numbers.at) largest = std::max(largest, std::abs(number));
    const float slack = k_rounding * (largest + reach);
    // What is not a number is not far, either.
    if (part.lanes->least_distance(part.numbers, seen_.min.data(), seen_.max.data()) > reach + slack) return;
    const std::size_t count =
        find_near_rows(part, surface_, step_, raw(block_.position), raw(std::as_const(velocity_)), slack,
                       block_.begin, block_.end, block_.pin, rows_);
    if (load_ || touched_) remember(count);
    part.lanes->resolve(part.numbers, surface_, step_, raw(block_.position), raw(block_.before), rows_.data(),
                        count, raw(velocity_), block_.bounds.squared_speed);
    if (load_) add_load(count);
    if (touched_) add_touched(count);
  }

 private:
  void remember(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) free_[k] = velocity_.get(rows_[k]);
  }
  void add_load(std::size_t count) {
    const Eigen::Vector3d c = Vec3(surface_.translation).cast<double>();
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector3d given = free_[k].cast<double>() - velocity_.get(rows_[k]).cast<double>();
      load_->impulse += given;
      load_->torque += (block_.position.get(rows_[k]).cast<double>() - c).cross(given);
    }
  }
  void add_touched(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t row = rows_[k];
      const Vec3 got = velocity_.get(row) - free_[k];
      if (!got.isZero(0))
        touched_->add(got.cast<double>(), block_.position.get(row).cast<double>(),
                      block_.before.get(row).cast<double>());
    }
  }

  ContactBlock& block_;
  const ContactSurface& surface_;
  const ContactStep& step_;
  VectorColumn& velocity_;
  ColliderLoad* const load_;
  ContactSums* const touched_;
  const Bounds seen_;
  const float speed_;
  float largest_;
  BlockRows rows_;
  std::array<Vec3, k_block> free_;
};

}  // namespace

void place_colliders(std::span<const Collider> colliders, const Vec3& origin, float time_step,
                     InstructionLevel level, std::vector<PlacedCollider>& placed) {
  placed.resize(colliders.size());
  for (std::size_t k = 0; k < colliders.size(); ++k) place(colliders[k], origin, time_step, level, placed[k]);
}

bool any_measures_load(std::span<const PlacedCollider> colliders) {
  return std::any_of(colliders.begin(), colliders.end(),
                     [](const PlacedCollider& collider) { return collider.measures_load; });
}

void resolve_contacts(const ContactBlock& rows, std::span<const PlacedCollider> colliders,
                      const ContactStep& step, VectorColumn& velocity, std::span<ColliderLoad> loads,
                      std::span<ContactSums> touches) {
  ContactBlock block = rows;
  for (std::size_t k = 0; k < colliders.size(); ++k) {
    BlockMeeting meeting(block, colliders[k], step, velocity, loads.empty() ? nullptr : &loads[k],
                         touches.empty() ? nullptr : &touches[k]);
    for (const PlacedCollider::Part& part : colliders[k].parts) meeting.meet(part);
  }
}

void find_near_walls(const VectorColumn& position, const VectorColumn& velocity, std::size_t begin,
                     std::size_t end, std::span<const PlacedCollider> colliders, float reach,
                     std::vector<NearWall>& near) {
  const Aabb box = box_around(position, begin, end);
  BlockBounds bounds{};
  std::copy_n(box.min.data(), 3, bounds.min);
  std::copy_n(box.max.data(), 3, bounds.max);
  // Without time there is no way but this.
  ContactStep still{};
  still.contact_offset = reach;
  BlockRows rows;
  std::array<float, k_block> distance;
  std::array<std::array<float, k_block>, 3> normal;
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const ContactSurface& surface = colliders[c].surface;
    const Bounds seen = seen_bounds(bounds, surface);
    for (const PlacedCollider::Part& part : colliders[c].parts) {
      if (part.lanes->least_distance(part.numbers, seen.min.data(), seen.max.data()) > reach) continue;
      const std::size_t count =
          find_near_rows(part, surface, still, raw(position), raw(velocity), 0, begin, end, nullptr, rows);
      part.lanes->separate(part.numbers, surface, raw(position), rows.data(), count, distance.data(),
                           {normal[0].data(), normal[1].data(), normal[2].data()});
      for (std::size_t k = 0; k < count; ++k)
        near.push_back({rows[k], static_cast<std::uint32_t>(c), distance[k],
                        Vec3(normal[0][k], normal[1][k], normal[2][k])});
    }
  }
}

}  // namespace mallow
