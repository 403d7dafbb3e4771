#include "surface/ellipsoids.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "mallow/instruction_level.h"

namespace mallow {
namespace {

/// How far a particle moves towards the mean of its neighbours [Yu & Turk 2013: 0.9 to 1].
constexpr double k_smoothing = 0.9;
/// A kernel's axes are at least this share of the kernel radius [Yu & Turk 2013, k_r = 4] ...
constexpr double k_least_ratio = 0.25;
/// ... and this many spacings, so that layers of particles join.
constexpr double k_least_axis = 0.75;
/// A lone particle's kernel is this many particle radii wide: so far distances outside of it are known.
constexpr double k_lone_axis = 1.6;
/// Σ w, relative to the inside of a body, at which kernels begin to be shaped, and at which they are in full.
/// A pair has 0.11, a string of particles 0.16, the corner of a body 0.4, a sheet 0.45.
constexpr double k_lone = 0.15, k_shaped = 0.4;
/// Layers of a body that its model looks at.
constexpr std::size_t k_layers = 20;
constexpr std::size_t k_clusters_at_once = 16;

/// A layer of particles taken as a sheet with one particle for each unit of its area, `d` from a point: the
/// integrals over it of w = 1 − r³ and of w times the square of a coordinate in the sheet.
struct SheetMoments {
  double weight = 0, square = 0;
  explicit SheetMoments(double d) {
    if (d >= 1) return;
    const double d2 = d * d, d4 = d2 * d2, d5 = d4 * d, d7 = d5 * d2;
    weight = std::numbers::pi * (1 - d2 - 0.4 * (1 - d5));
    square =
        std::numbers::pi / 2 * (0.5 * (1 - d4) - 2.0 / 7 * (1 - d7) - d2 * (1 - d2) + 0.4 * d2 * (1 - d5));
  }
};

/// Smoothly from 0 at `low` to 1 at `high`.
double blend(double x, double low, double high) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// shaped: 0 gives a lone particle's sphere, 1 axes as long as the neighbours are spread.
Ellipsoid make_shape(const AnisotropyModel& model, const Eigen::Matrix3d& variance, double shaped) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(variance);
  const Eigen::Vector3d spread = (eigen.eigenvalues().cwiseMax(0.0) / model.full_variance).cwiseSqrt();
  const Eigen::Vector3d spread_axes = spread.cwiseMax(model.shortest_axis).cwiseMin(1.0);
  const Eigen::Vector3d axes = model.lone_axis * Eigen::Vector3d::Ones() +
                               shaped * (spread_axes - model.lone_axis * Eigen::Vector3d::Ones());
  const Eigen::Matrix3d& v = eigen.eigenvectors();
  const Eigen::Matrix3f g = (v * axes.cwiseInverse().asDiagonal() * v.transpose()).cast<float>();
  // The box around an ellipsoid.
  const Eigen::Vector3f reach = (v * axes.asDiagonal()).rowwise().norm().cast<float>();
  return {.xx = g(0, 0),
          .xy = g(0, 1),
          .xz = g(0, 2),
          .yy = g(1, 1),
          .yz = g(1, 2),
          .zz = g(2, 2),
          .weight = static_cast<float>(std::lerp(model.lone_weight, model.peak / axes.prod(), shaped)),
          .reach = {reach.x(), reach.y(), reach.z()}};
}

}  // namespace

const SurfaceLanes& best_surface_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, surface_lanes);
}

AnisotropyModel::AnisotropyModel(double radius, double particle_radius) {
  using Layers = std::array<double, k_layers>;
  const double step = 1 / radius;
  // Half of a body: layer l at height −l · step.
  Layers weight{}, displacement{}, across{}, along{};
  for (std::size_t i = 0; i < k_layers; ++i) {
    double square = 0;
    for (std::size_t j = 0; j < k_layers; ++j) {
      const double d = (static_cast<double>(i) - static_cast<double>(j)) * step;
      const SheetMoments sheet(std::abs(d));
      weight[i] += sheet.weight;
      displacement[i] += sheet.weight * d;
      square += sheet.weight * d * d;
      along[i] += sheet.square;
    }
    displacement[i] /= weight[i];
    across[i] = square / weight[i] - displacement[i] * displacement[i];
    along[i] /= weight[i];
  }
  constexpr std::size_t k_middle = k_layers / 2;
  full_weight = weight[k_middle] * radius * radius;
  full_variance = along[k_middle];
  shortest_axis = std::min(1.0, std::max(k_least_ratio, k_least_axis / radius));

  // Density at the particle radius above the outermost layer: a kernel has 315/256 (1 − z²/a²)⁴ / a of it.
  peak = 315 / (64 * std::numbers::pi);
  for (std::size_t i = 0; i < k_middle; ++i) {
    const double axis =
        std::clamp(std::sqrt(std::max(across[i], 0.0) / full_variance), shortest_axis, 1.0) * radius;
    const double height = -static_cast<double>(i) + k_smoothing * radius * displacement[i];
    const double z = (particle_radius - height) / axis;
    threshold += 315.0 / 256 / axis * std::pow(std::max(0.0, 1 - z * z), 4);
  }
  peak /= radius * radius * radius;
  lone_axis = k_lone_axis * particle_radius / radius;
  lone_weight = threshold / std::pow(1 - 1 / (k_lone_axis * k_lone_axis), 3);
}

void Ellipsoids::fit(const AnisotropyModel& model, float radius, const Threads& threads,
                     ParticleCells& cells) {
  const std::size_t n = cells.count();
  const auto r = static_cast<double>(radius);
  centers_.resize_unset(n);
  unsorted_.resize(n);
  parallel_for(
      threads, cells.clusters(),
      [&](std::size_t begin, std::size_t end) {
        thread_local NearParticles near;
        for (std::size_t c = begin; c < end; ++c) {
          Eigen::Vector3d corner;
          cells.find_near_cluster(c, corner, near);
          const PlaceRange places = cells.cluster(c);
          float x[3][k_cluster] = {}, moments[k_moments][k_cluster];
          for (std::uint32_t i = places.begin; i < places.end; ++i)
            for (int a = 0; a < 3; ++a)
              x[a][i - places.begin] =
                  static_cast<float>((static_cast<double>(cells.position(i)[a]) - corner[a]) / r);
          best_surface_lanes().moments_at_points({x[0], x[1], x[2]}, k_cluster, near.positions(), near.count,
                                                 moments[0]);
          for (std::uint32_t i = places.begin; i < places.end; ++i) {
            const auto m = [&](std::size_t k) { return static_cast<double>(moments[k][i - places.begin]); };
            const Eigen::Vector3d mean = Eigen::Vector3d(m(1), m(2), m(3)) / m(0);
            Eigen::Matrix3d variance;
            variance << m(4), m(5), m(6), m(5), m(7), m(8), m(6), m(8), m(9);
            variance = variance / m(0) - mean * mean.transpose();
            const double shaped = blend(m(0) / model.full_weight, k_lone, k_shaped);
            unsorted_[i] = make_shape(model, variance, shaped);
            const Eigen::Vector3d moved = shaped * k_smoothing * r * mean;
            centers_.set(i, (cells.position(i).cast<double>() + moved).cast<float>());
          }
        }
      },
      k_clusters_at_once);
  cells.move(centers_, threads);
  shapes_.resize(n);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) shapes_[i] = unsorted_[cells.place_before_move(i)];
  });
}

}  // namespace mallow
