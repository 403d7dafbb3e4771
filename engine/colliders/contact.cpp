#include "colliders/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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

/// Turns in a step after which all is swept that ever is. What turns farther is met as if it turned by one
/// more than what is left of its whole turns, which ends in the same pose.
constexpr double k_most_turns = 2;

/// No point of the collider is farther from its origin. Of what keeps particles in, all is the collider.
float farthest_point(const Collider& collider) {
  float farthest = 0;
  visit_parts(collider, [&]<class Shape>(const Shape& shape) {
    const Aabb box = bounds(shape);
    farthest = std::max(farthest, ShapeTraits<Shape>::keeps_in(shape)
                                      ? std::numeric_limits<float>::infinity()
                                      : box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm());
  });
  return farthest;
}

void cut_turn(const Collider& collider, double seconds, const Eigen::Vector3d& stands,
              const Eigen::Matrix3d& rotation, PlacedCollider& placed) {
  placed.pieces.clear();
  const Eigen::Vector3d spin = collider.angular_velocity.cast<double>();
  const double rate = spin.norm(), whole = seconds * rate, round = 2 * std::numbers::pi;
  if (!(whole > k_most_turn)) return;
  const double angle = whole > k_most_turns * round ? round + std::fmod(whole, round) : whole;
  const double count = std::ceil(angle / k_most_turn);
  placed.pieces.resize(static_cast<std::size_t>(count));
  placed.radius = farthest_point(collider);
  Eigen::Map<RowMajor>(placed.piece_spin) =
      mean_spin((angle / whole * spin).cast<float>(), seconds / count).cast<float>();
  const auto turned_by = [&](double share) -> Eigen::Matrix3f {
    return (Eigen::AngleAxisd(share * angle, spin / rate).toRotationMatrix() * rotation).cast<float>();
  };
  for (std::size_t k = 0; k < placed.pieces.size(); ++k) {
    PlacedCollider::Piece& piece = placed.pieces[k];
    const double begin = static_cast<double>(k) / count, end = static_cast<double>(k + 1) / count;
    Eigen::Map<Vec3>(piece.translation) =
        (stands + begin * seconds * collider.velocity.cast<double>()).cast<float>();
    Eigen::Map<RowMajor>(piece.rotation) = turned_by(begin);
    Eigen::Map<RowMajor>(piece.turned) = turned_by(end);
  }
}

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
  cut_turn(collider, seconds, stands, rotation, placed);

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

/// What a particle at x gives whose velocity goes from `free` to v.
void add_load(const Vec3& free, const Vec3& v, const Vec3& x, const ContactSurface& surface,
              ColliderLoad& load) {
  const Eigen::Vector3d given = free.cast<double>() - v.cast<double>();
  load.impulse += given;
  load.torque += (x.cast<double>() - Vec3(surface.translation).cast<double>()).cross(given);
}

void add_touched(const Vec3& free, const Vec3& v, const ContactBlock& block, std::size_t row,
                 ContactSums& touched) {
  const Vec3 got = v - free;
  if (!got.isZero(0))
    touched.add(got.cast<double>(), block.position.get(row).cast<double>(),
                block.before.get(row).cast<double>());
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
    if (load_) add_loads(count);
    if (touched_) add_touches(count);
  }

 private:
  void remember(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) free_[k] = velocity_.get(rows_[k]);
  }
  void add_loads(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k)
      add_load(free_[k], velocity_.get(rows_[k]), block_.position.get(rows_[k]), surface_, *load_);
  }
  void add_touches(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k)
      add_touched(free_[k], velocity_.get(rows_[k]), block_, rows_[k], *touched_);
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

/// A block that meets a collider which turns far in the step, piece by piece of its turn. Rows go along as
/// the pieces leave them; here they count from 0.
class TurnMeeting {
 public:
  TurnMeeting(ContactBlock& block, const PlacedCollider& collider, const ContactStep& step,
              VectorColumn& velocity, ColliderLoad* load, ContactSums* touched)
      : block_(block),
        collider_(collider),
        surface_(collider.surface),
        step_(step),
        velocity_(velocity),
        load_(collider.measures_load ? load : nullptr),
        touched_(touched),
        count_(block.end - block.begin),
        share_(1 / static_cast<float>(collider.pieces.size())) {
    std::copy_n(collider.piece_spin, 9, surface_.spin);
    piece_step_.time_step = share_ * step.time_step;
    for (std::size_t i = block.begin; i < block.end; ++i)
      fastest_ = std::max(fastest_, block.before.get(i).squaredNorm());
  }

  void meet() {
    if (is_far()) return;
    take_rows();
    for (std::size_t k = 0; k < collider_.pieces.size(); ++k) {
      const PlacedCollider::Piece& piece = collider_.pieces[k];
      std::copy_n(piece.translation, 3, surface_.translation);
      std::copy_n(piece.rotation, 9, surface_.rotation);
      std::copy_n(piece.turned, 9, surface_.turned);
      kick(k);
      for (const PlacedCollider::Part& part : collider_.parts) meet(part);
      go_on();
    }
    give_means();
    block_.bounds.squared_speed = std::max(block_.bounds.squared_speed, fastest_);
  }

 private:
  using Vectors3 = std::array<std::array<float, k_block>, 3>;
  static Vectors raw(Vectors3& v) { return {v[0].data(), v[1].data(), v[2].data()}; }
  static ConstVectors raw_const(const Vectors3& v) { return {v[0].data(), v[1].data(), v[2].data()}; }

  /// What is not a number is not far.
  bool is_far() const {
    const Vec3 min(block_.bounds.min), max(block_.bounds.max), c(collider_.surface.translation);
    const float gap = (min - c).cwiseMax(c - max).cwiseMax(0.0f).norm();
    const float reach =
        step_.contact_offset + step_.time_step * (std::sqrt(fastest_) + Vec3(surface_.velocity).norm());
    return gap > (collider_.radius + reach) * (1 + k_rounding) +
                     k_rounding * (min.cwiseAbs().cwiseMax(max.cwiseAbs()).norm() + c.norm());
  }

  void take_rows() {
    const auto take = [&](const ConstVectors& from, Vectors3& to) {
      std::copy_n(from.x + block_.begin, count_, to[0].data());
      std::copy_n(from.y + block_.begin, count_, to[1].data());
      std::copy_n(from.z + block_.begin, count_, to[2].data());
    };
    take(mallow::raw(block_.position), x_);
    take(mallow::raw(block_.before), before_);
    take(mallow::raw(std::as_const(velocity_)), free_);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < count_; ++i) kick_[a][i] = share_ * (free_[a][i] - before_[a][i]);
    for (auto& sum : sum_) sum.fill(0);
    is_met_.fill(0);
  }

  /// What accelerates rows acts in each piece by its share, or friction of the first had all that presses
  /// them on. Those that nothing has met are where their step takes them.
  void kick(std::size_t piece) {
    const auto left = static_cast<float>(collider_.pieces.size() - 1 - piece);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < count_; ++i)
        v_[a][i] = is_met_[i] != 0 ? v_[a][i] + kick_[a][i] : free_[a][i] - left * kick_[a][i];
    for (std::size_t i = 0; i < count_; ++i) fastest_ = std::max(fastest_, velocity_of(i).squaredNorm());
  }

  void meet(const PlacedCollider::Part& part) {
    // Rows have left the bounds of the block by no more than their way.
    const float way = step_.time_step * std::sqrt(fastest_);
    const float speed =
        most_speed(block_.bounds, surface_) + Eigen::Map<const RowMajor>(surface_.spin).norm() * way;
    const float reach = step_.contact_offset + way + piece_step_.time_step * (std::sqrt(fastest_) + speed);
    const Bounds seen = seen_bounds(block_.bounds, surface_);
    float largest = seen.largest() + Vec3(surface_.translation).norm();
    for (const float number : part.numbers.at) largest = std::max(largest, std::abs(number));
    const float slack = k_rounding * (largest + reach);
    if (part.lanes->least_distance(part.numbers, seen.min.data(), seen.max.data()) > reach + slack) return;
    const std::size_t near =
        find_near_rows(part, surface_, piece_step_, raw_const(x_), raw_const(v_), slack, 0, count_,
                       block_.pin ? block_.pin + block_.begin : nullptr, rows_);
    for (std::size_t k = 0; k < near; ++k) came_[k] = velocity_of(rows_[k]);
    part.lanes->resolve(part.numbers, surface_, piece_step_, raw_const(x_), raw_const(before_), rows_.data(),
                        near, raw(v_), fastest_);
    for (std::size_t k = 0; k < near; ++k) is_met_[rows_[k]] |= velocity_of(rows_[k]) != came_[k];
  }

  /// To the end of the piece. Who was met came with what that made of it, to the next.
  void go_on() {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < count_; ++i) {
        const float went = is_met_[i] != 0 ? v_[a][i] : free_[a][i];
        x_[a][i] += piece_step_.time_step * went;
        sum_[a][i] += went;
        before_[a][i] = is_met_[i] != 0 ? went : before_[a][i];
      }
  }

  void give_means() {
    for (std::size_t i = 0; i < count_; ++i) {
      if (is_met_[i] == 0) continue;
      const std::size_t row = block_.begin + i;
      const Vec3 v = share_ * Vec3(sum_[0][i], sum_[1][i], sum_[2][i]), free = velocity_.get(row);
      velocity_.set(row, v);
      if (load_) add_load(free, v, block_.position.get(row), collider_.surface, *load_);
      if (touched_) add_touched(free, v, block_, row, *touched_);
    }
  }

  Vec3 velocity_of(std::size_t i) const { return {v_[0][i], v_[1][i], v_[2][i]}; }

  ContactBlock& block_;
  const PlacedCollider& collider_;
  ContactSurface surface_;
  const ContactStep& step_;
  ContactStep piece_step_ = step_;
  VectorColumn& velocity_;
  ColliderLoad* const load_;
  ContactSums* const touched_;
  const std::size_t count_;
  const float share_;
  float fastest_ = block_.bounds.squared_speed;  ///< no |v|² in any piece so far is more
  /// Of the rows: where they are, v^t or how they left the piece before, v as the step has it, its share of
  /// what accelerates them, v in the piece, and the sum of those.
  Vectors3 x_, before_, free_, kick_, v_, sum_;
  std::array<std::uint8_t, k_block> is_met_;
  BlockRows rows_;
  std::array<Vec3, k_block> came_;
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
    ColliderLoad* const load = loads.empty() ? nullptr : &loads[k];
    ContactSums* const touched = touches.empty() ? nullptr : &touches[k];
    if (colliders[k].pieces.empty()) {
      BlockMeeting meeting(block, colliders[k], step, velocity, load, touched);
      for (const PlacedCollider::Part& part : colliders[k].parts) meeting.meet(part);
    } else {
      TurnMeeting(block, colliders[k], step, velocity, load, touched).meet();
    }
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
