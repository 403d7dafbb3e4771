#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/surface_field.h"

namespace mallow {

/// The particles near one block, until the next call.
BlockNear& SurfaceField::near_block(std::uint32_t block) const {
  thread_local BlockNear near;
  particles_.find(blocks_, frame_, block, near);
  return near;
}

void SurfaceField::mean_at(std::uint32_t block, ConstVectors points, std::size_t n,
                           const PickedVectors& values, Vectors means) const {
  mean_at(
      near_block(block), points, n, [&](std::size_t particle) { return values[particle]; }, means);
}

void SurfaceField::body_at(std::uint32_t block, ConstVectors points, std::size_t n,
                           std::span<const std::uint32_t> bodies, std::span<std::uint32_t> found) const {
  BlockNear& near = near_block(block);
  thread_local std::vector<std::uint32_t> here;  // the bodies near the block, ascending
  thread_local std::vector<float> largest, shares[3];
  here.clear();
  for (std::size_t k = 0; k < near.count; ++k)
    here.push_back(bodies[particles_.cells().particle(near.place(k))]);
  std::sort(here.begin(), here.end());
  here.erase(std::unique(here.begin(), here.end()), here.end());

  std::fill(found.begin(), found.end(), 0u);
  largest.assign(found.size(), 0.0f);
  for (std::vector<float>& share : shares) share.resize(n);
  // Three at a time: a particle's share in each is a vector of 0 and 1, whose mean is taken.
  for (std::size_t first = 0; first < here.size(); first += 3) {
    const std::size_t count = std::min<std::size_t>(3, here.size() - first);
    const auto is_of = [&](std::size_t particle) {
      Vec3 of = Vec3::Zero();
      for (std::size_t a = 0; a < count; ++a)
        if (bodies[particle] == here[first + a]) of[static_cast<Eigen::Index>(a)] = 1;
      return of;
    };
    mean_at(near, points, n, is_of, {shares[0].data(), shares[1].data(), shares[2].data()});
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t p = 0; p < found.size(); ++p) {
        if (!(shares[a][p] > largest[p])) continue;
        largest[p] = shares[a][p];
        found[p] = here[first + a];
      }
    }
  }
}

template <class Value>
void SurfaceField::mean_at(BlockNear& near, ConstVectors points, std::size_t n, const Value& value,
                           Vectors means) const {
  thread_local std::vector<float> scaled[3], near_values[3];
  const float* const from[3] = {points.x, points.y, points.z};
  for (std::size_t a = 0; a < 3; ++a) {
    scaled[a].resize(n);
    for (std::size_t k = 0; k < n; ++k) scaled[a][k] = from[a][k] * shape_.voxel_size;
    near_values[a].resize(near.count);
  }
  for (std::size_t k = 0; k < near.count; ++k) {
    const Vec3 of_particle = value(particles_.cells().particle(near.place(k)));
    for (std::size_t a = 0; a < 3; ++a) near_values[a][k] = of_particle[static_cast<Eigen::Index>(a)];
  }
  const auto raw = [](const std::vector<float>(&axes)[3]) {
    return ConstVectors{axes[0].data(), axes[1].data(), axes[2].data()};
  };
  best_sum_lanes().mean(raw(scaled), n, near.columns(), raw(near_values), means);
}

}  // namespace mallow
