#include "surface/shape_turns.h"

#include <numeric>

#include "core/parallel.h"
#include "core/polar_rotation.h"
#include "surface/particle_cells.h"

namespace mallow {
namespace {

/// near: the particles of a region, by place in `cells`.
Eigen::Quaternionf turn_of(const ParticleCells& cells, const NearParticles& near, std::span<const Vec3> from,
                           std::span<const Vec3> to, std::span<const float> weights) {
  double sum = 0;
  Eigen::Vector3d center(0, 0, 0), moved(0, 0, 0);
  for (std::size_t k = 0; k < near.count; ++k) {
    const std::uint32_t j = cells.particle(near.places[k]);
    const auto w = static_cast<double>(weights[j]);
    sum += w;
    center += w * from[j].cast<double>();
    moved += w * to[j].cast<double>();
  }
  center /= sum;
  moved /= sum;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  double scale = 0;
  for (std::size_t k = 0; k < near.count; ++k) {
    const std::uint32_t j = cells.particle(near.places[k]);
    const auto w = static_cast<double>(weights[j]);
    const Eigen::Vector3d d = from[j].cast<double>() - center;
    a += w * (to[j].cast<double>() - moved) * d.transpose();
    scale += w * d.squaredNorm();
  }
  return polar_rotation(a, Eigen::Quaterniond::Identity(), scale).cast<float>();
}

}  // namespace

void find_turns(std::span<const Vec3> from, std::span<const Vec3> to, float spacing, float radius,
                std::span<const std::uint32_t> which, const Threads& threads,
                std::span<Eigen::Quaternionf> turns) {
  std::vector<std::uint32_t> all(from.size());
  std::iota(all.begin(), all.end(), 0u);
  ParticleCells cells;
  cells.sort({from, all}, spacing, radius, threads);
  std::vector<float> weights(from.size());
  // The neighbours are found twice rather than kept: bodies yield seldom, and lists are large.
  const auto for_each_region = [&](std::size_t n, const auto& particle, const auto& work) {
    parallel_for(
        threads, n,
        [&](std::size_t begin, std::size_t end) {
          thread_local NearParticles near;
          for (std::size_t k = begin; k < end; ++k) {
            cells.find_near(from[particle(k)].template cast<double>(), 0, near);
            work(k, near);
          }
        },
        64);
  };
  for_each_region(
      from.size(), [](std::size_t k) { return k; },
      [&](std::size_t k, const NearParticles& near) { weights[k] = 1.0f / static_cast<float>(near.count); });
  for_each_region(
      which.size(), [&](std::size_t k) { return which[k]; },
      [&](std::size_t k, const NearParticles& near) { turns[k] = turn_of(cells, near, from, to, weights); });
}

}  // namespace mallow
