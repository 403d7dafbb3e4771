#include "sph/walls.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace mallow {
namespace {

/// The share of its kernel that a particle is taken to see at least: what is squeezed between walls sees next
/// to nothing, and its acceleration says little of what is around it.
constexpr float k_least_seen = 0.5f;

/// Takes in the walls around the particles of a block, one by one.
class WalledBlock {
 public:
  WalledBlock(const WalledBody& body, std::size_t begin, DensityKernel kernel, float support_radius,
              std::span<float> share, std::vector<Walls::Wall>& walls)
      : kernel_(kernel),
        inward_(support_radius - body.reach),
        radius_(support_radius),
        begin_(begin),
        share_(share),
        walls_(walls) {}

  void add(const NearWall& near) {
    const float q = std::max(near.distance + inward_, 0.0f) / radius_;
    if (!(q < 1)) return;
    const float share = half_space_share(kernel_, q);
    float& sum = share_[near.row];
    std::uint32_t& last = last_[near.row - begin_];
    float covered = 0;
    if (last != 0) {
      // Planes across each other cut off a part of one another's half space; of those that look the same way
      // the nearer counts; those that look at each other add up.
      const float along = direction(last).dot(near.normal), alike = std::max(along, 0.0f);
      const float across = 1 - std::abs(along);
      const bool farther = share <= sum;
      covered = across * sum + (farther ? alike : 0.0f);
      cover(last, across * share + (farther ? 0.0f : alike));
      sum += share - (across * share * sum + alike * std::min(share, sum));
    } else {
      sum = share;
    }
    const float left = 1 - covered;
    walls_.push_back({near.row, near.collider, last, left * share, left * half_space_gradient(q) / radius_,
                      kernel_ == DensityKernel::wendland ? left * wendland_half_space_slope(q) / radius_ : 0,
                      near.distance, near.normal});
    last = static_cast<std::uint32_t>(walls_.size());
  }

 private:
  /// In which the walls of a row push together.
  Vec3 direction(std::uint32_t last) const {
    Vec3 sum(0, 0, 0);
    for (std::uint32_t w = last; w != 0; w = walls_[w - 1].before)
      sum += walls_[w - 1].gradient * walls_[w - 1].normal;
    return sum.normalized();
  }
  void cover(std::uint32_t last, float part) {
    for (std::uint32_t w = last; w != 0; w = walls_[w - 1].before) {
      walls_[w - 1].share *= 1 - part;
      walls_[w - 1].gradient *= 1 - part;
      walls_[w - 1].slope *= 1 - part;
    }
  }

  const DensityKernel kernel_;
  const float inward_, radius_;  ///< how far behind a surface the matter begins [m], and σ
  const std::size_t begin_;
  const std::span<float> share_;
  std::vector<Walls::Wall>& walls_;
  std::array<std::uint32_t, k_block> last_{};  ///< of each row, counted from 1; 0: none
};

/// Zeros where the last step wrote.
void clear(Walls& walls) {
  if (!walls.any) return;
  for (const std::vector<Walls::Wall>& block : walls.walls) {
    for (const Walls::Wall& wall : block) {
      walls.share[wall.row] = 0;
      walls.acceleration.set(wall.row, Vec3(0, 0, 0));
    }
  }
}

}  // namespace

void Walls::release() {
  if (bytes() > 0) *this = {};
}

std::size_t Walls::bytes() const {
  std::size_t sum = share.bytes() + acceleration.bytes();
  for (const auto& block : near) sum += block.capacity() * sizeof(NearWall);
  for (const auto& block : walls) sum += block.capacity() * sizeof(Wall);
  return sum;
}

void find_walls(const VectorColumn& position, const VectorColumn& velocity,
                std::span<const PlacedCollider> colliders, DensityKernel kernel, float support_radius,
                const Execution& execution, Walls& walls) {
  clear(walls);
  walls.blocks.clear();
  for (const WalledBody& body : walls.bodies) walls.blocks.add(body.end - body.begin);
  walls.near.resize(walls.blocks.blocks.size());
  parallel_for(execution.threads, walls.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const WalledBody& body = walls.bodies[block.range];
    walls.near[number].clear();
    find_near_walls(position, velocity, body.begin + block.begin, body.begin + block.end, colliders,
                    body.reach, walls.near[number]);
  });
  walls.any = std::ranges::any_of(walls.near, [](const auto& block) { return !block.empty(); });
  if (!walls.any) return;
  walls.share.resize(position.size());
  walls.acceleration.resize(position.size());
  walls.walls.resize(walls.near.size());
  parallel_for(execution.threads, walls.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const WalledBody& body = walls.bodies[block.range];
    walls.walls[number].clear();
    if (walls.near[number].empty()) return;
    WalledBlock walled(body, body.begin + block.begin, kernel, support_radius, walls.share.span(),
                       walls.walls[number]);
    for (const NearWall& wall : walls.near[number]) walled.add(wall);
  });
}

Vec3 pushed_along(const Walls::Wall& wall, float alpha, float share, const Vec3& by_neighbors,
                  const Vec3& weight) {
  const auto tangential = [&](const Vec3& v) { return Vec3(v - v.dot(wall.normal) * wall.normal); };
  const Vec3 push = wall.share / std::max(1 - share, k_least_seen) * tangential(by_neighbors);
  if (alpha >= 1) return push;
  // A share may be below 0 by rounding.
  const float most = std::max(wall.share, 0.0f) * tangential(weight).norm(), size = push.norm();
  return size > most ? Vec3(most / size * push) : push;
}

Vec3 velocity_at(const ContactSurface& surface, const Vec3& x) {
  const Vec3 velocity(surface.velocity);
  if (!surface.turns) return velocity;
  return velocity + Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(surface.spin) *
                        (x - Vec3(surface.translation));
}

void add_load(float mass, const Vec3& change, const Vec3& x, const PlacedCollider& collider,
              ColliderLoad& load) {
  const Eigen::Vector3d given = -static_cast<double>(mass) * change.cast<double>();
  load.impulse += given;
  load.torque += Vec3(x - Vec3(collider.surface.translation)).cast<double>().cross(given);
}

void press_walls(const WallInput& in, std::span<const PlacedCollider> colliders, const Execution& execution,
                 Walls& walls) {
  const std::size_t count = in.all_loads || any_measures_load(colliders) ? colliders.size() : 0;
  walls.loads.assign(count, {});
  if (!walls.any) return;
  walls.partial_loads.assign(count * walls.blocks.blocks.size(), {});
  parallel_for(execution.threads, walls.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const WalledBody& body = walls.bodies[block.range];
    for (Walls::Wall& wall : walls.walls[number]) {
      const std::uint32_t row = wall.row;
      const float rho = in.density[row];
      const float excess = std::max(rho - body.group->rest_density, 0.0f);
      const float across = body.group->pressure_coefficient * excess / rho * wall.gradient;
      // Where particles differ in alpha, a^SPH is blended already.
      const Vec3& a = in.sph_acceleration.get(row);
      const Vec3 acts = in.alpha ? Vec3(a) : Vec3(body.alpha * a);
      const float alpha = in.alpha ? in.alpha[row] : body.alpha;
      const Vec3 push =
          alpha * across * wall.normal + pushed_along(wall, alpha, walls.share[row], acts, in.gravity);
      walls.acceleration.set(row, walls.acceleration.get(row) + push);
      wall.across = alpha * across;
      if ((in.all_loads || colliders[wall.collider].measures_load) && !(in.pin && in.pin[row] != 0))
        add_load(body.mass, push, in.position.get(row), colliders[wall.collider],
                 walls.partial_loads[number * count + wall.collider]);
    }
  });
  for (std::size_t k = 0; k < walls.partial_loads.size(); ++k) {
    walls.loads[k % count].impulse += walls.partial_loads[k].impulse;
    walls.loads[k % count].torque += walls.partial_loads[k].torque;
  }
}

namespace {

/// What friction makes of a velocity where a wall has pushed with `push` in the step [m/s].
Vec3 rubbed_by(const Walls::Wall& wall, const ContactSurface& surface, float push, const Vec3& x,
               const Vec3& before, const Vec3& v) {
  Vec3 u = velocity_at(surface, x - wall.distance * wall.normal);
  if (surface.carries) u += Vec3(surface.along);
  const auto slides = [&](const Vec3& w) { return Vec3(w - w.dot(wall.normal) * wall.normal); };
  const Vec3 way = slides(v - u);
  const float square = way.squaredNorm(), most = surface.friction * push;
  if (!(square > 0)) return Vec3(0, 0, 0);
  float taken = std::min(1.0f, most / std::sqrt(square));
  const float along = way.dot(slides(before - u));
  if (along < 0) taken = std::min(taken, std::max(0.0f, 1 + along / square));
  return -taken * way;
}

}  // namespace

void rub_walls(const RubInput& in, std::span<const PlacedCollider> colliders, const Execution& execution,
               Walls& walls, VectorColumn& velocity) {
  walls.rubbed.assign(walls.partial_loads.size(), {});
  const std::size_t count = walls.loads.size();
  parallel_for(execution.threads, walls.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    for (const Walls::Wall& wall : walls.walls[number]) {
      const std::uint32_t row = wall.row;
      const PlacedCollider& collider = colliders[wall.collider];
      if (!(wall.across > 0) || !(collider.surface.friction > 0) || (in.pin && in.pin[row] != 0)) continue;
      const Vec3 x = in.position.get(row), v = velocity.get(row);
      const Vec3 change =
          rubbed_by(wall, collider.surface, in.time_step * wall.across, x, in.before.get(row), v);
      velocity.set(row, v + change);
      if (count > 0)
        add_load(walls.bodies[block.range].mass, change, x, collider,
                 walls.rubbed[number * count + wall.collider]);
    }
  });
}

}  // namespace mallow
