#include <algorithm>
#include <cmath>
#include <functional>

#include "mallow/errors.h"
#include "mallow/tuning.h"
#include "surface/nearest_points.h"

namespace mallow {
namespace {

/// Particles of the reference that stand for one of another sampling.
constexpr std::size_t k_nearest = 8;

ParticleId id_at(const ParticleFrame& frame, std::size_t i) {
  return frame.ids.empty() ? i : frame.ids[i];
}

float spacing_at(const Motion& motion, const ParticleFrame& frame, std::size_t i) {
  const std::uint32_t body = frame.bodies[i];
  return body < motion.spacings.size() ? motion.spacings[body] : 1.0f;
}

/// Where a particle is, and where the reference has it.
using Visit = std::function<void(const Vec3& x, const Vec3& reference, float spacing)>;

/// Visits the particles that both have; returns how many only one has.
std::size_t match_by_id(const ParticleFrame& a, const ParticleFrame& b, const Motion& reference,
                        const Visit& visit) {
  std::size_t i = 0, j = 0, matched = 0;
  while (i < a.positions.size() && j < b.positions.size()) {
    const ParticleId id_a = id_at(a, i), id_b = id_at(b, j);
    if (id_a == id_b) {
      visit(a.positions[i], b.positions[j], spacing_at(reference, b, j));
      ++matched;
    }
    // Frames are in the order of slots.
    const std::uint32_t slot_a = slot_of(id_a), slot_b = slot_of(id_b);
    if (slot_a <= slot_b) ++i;
    if (slot_b <= slot_a) ++j;
  }
  return a.positions.size() + b.positions.size() - 2 * matched;
}

/// For each particle of another sampling those of the reference that were nearest to it at the begin, and
/// their weights, in a row.
struct Neighbourhoods {
  std::size_t count = 0;  ///< of each
  std::vector<std::uint32_t> particles = {};
  std::vector<double> weights = {};
};

float least_spacing(const Motion& motion) {
  return motion.spacings.empty() ? 1.0f : *std::ranges::min_element(motion.spacings);
}

Neighbourhoods neighbourhoods(const ParticleFrame& frame, const ParticleFrame& reference, float spacing) {
  // The eighth of a lattice's points is within 1.5 spacings.
  const std::vector<NearestPoint> found =
      find_several_nearest(frame.positions, reference.positions, k_nearest, 1.5f * spacing, 1);
  Neighbourhoods result{.count = std::min(k_nearest, reference.positions.size())};
  for (const NearestPoint& near : found) result.particles.push_back(near.index);
  result.weights.resize(found.size());
  const auto square = [](float x) { return static_cast<double>(x) * static_cast<double>(x); };
  for (std::size_t i = 0; i < found.size(); i += result.count) {
    double sum = 0;
    const double farthest = square(found[i + result.count - 1].distance);
    for (std::size_t k = i; k < i + result.count; ++k)
      sum += result.weights[k] = 1 / (1e-6 * farthest + square(found[k].distance) + 1e-30);
    for (std::size_t k = i; k < i + result.count; ++k) result.weights[k] /= sum;
  }
  return result;
}

/// Sums of what the two motions differ by.
class Sums {
 public:
  Sums(const Motion& motion, const Motion& reference, const PixelOf& pixel)
      : motion_(motion), reference_(reference), pixel_(pixel) {
    if (motion.moments.empty() || reference.moments.empty()) return;
    const ParticleFrame& a = motion.moments.front().particles;
    const ParticleFrame& b = reference.moments.front().particles;
    if (a.positions.size() == b.positions.size() || b.positions.empty()) return;
    near_ = neighbourhoods(a, b, least_spacing(reference));
  }

  void add(std::size_t k) {
    const MotionMoment &a = motion_.moments[k], &b = reference_.moments[k];
    const Visit visit = [&](const Vec3& x, const Vec3& wanted, float spacing) {
      add_particle(x, wanted, spacing, b.particles.time);
    };
    if (near_.particles.empty())
      error_.unmatched += match_by_id(a.particles, b.particles, reference_, visit);
    else
      match_by_place(a.particles, b.particles, visit);
    const double h = static_cast<double>(least_spacing(reference_));
    const auto square = [](double x) { return x * x; };
    error_.height += square((a.height - b.height) / h);
    error_.spread += square((a.spread - b.spread) / h);
    error_.center += ((a.center - b.center) / h).squaredNorm();
    if (b.volume > 0) error_.volume += square(a.volume / b.volume - 1);
    error_.energy += square(a.energy - energy_of_reference(b));
    largest_kinetic_ = std::max(largest_kinetic_, b.kinetic_energy);
    error_.measures.resize(b.measures.size());
    for (std::size_t m = 0; m < std::min(a.measures.size(), b.measures.size()); ++m)
      error_.measures[m] += square(a.measures[m] - b.measures[m]);
    ++moments_;
  }

  MotionError result() {
    const double n = std::max<double>(1, static_cast<double>(moments_));
    for (double* sum : {&error_.height, &error_.spread, &error_.center, &error_.volume, &error_.energy})
      *sum = std::sqrt(*sum / n);
    for (double& sum : error_.measures) sum = std::sqrt(sum / n);
    error_.energy = largest_kinetic_ > 0 ? error_.energy / largest_kinetic_ : 0;
    if (!distances_.empty()) {
      error_.rms = std::sqrt(squares_ / static_cast<double>(distances_.size()));
      error_.median = median(distances_);
    }
    if (!pixels_.empty()) {
      error_.worst_pixels = *std::ranges::max_element(pixels_);
      error_.median_pixels = median(pixels_);
    }
    return error_;
  }

 private:
  static double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  }

  /// Bodies of another sampling may have another mass: energies are compared from their begins.
  double energy_of_reference(const MotionMoment& b) const {
    return b.energy - reference_.moments.front().energy + motion_.moments.front().energy;
  }

  void add_particle(const Vec3& x, const Vec3& wanted, float spacing, double time) {
    const double distance = static_cast<double>((x - wanted).norm()) / static_cast<double>(spacing);
    distances_.push_back(distance);
    squares_ += distance * distance;
    if (distance > error_.worst) {
      error_.worst = distance;
      error_.worst_time = time;
    }
    if (!pixel_) return;
    const auto a = pixel_(x), b = pixel_(wanted);
    if (a && b) pixels_.push_back((*a - *b).norm());
  }

  void match_by_place(const ParticleFrame& a, const ParticleFrame& b, const Visit& visit) {
    const ParticleFrame& first_a = motion_.moments.front().particles;
    const ParticleFrame& first_b = reference_.moments.front().particles;
    const std::size_t particles = near_.particles.size() / near_.count;
    for (std::size_t i = 0; i < std::min(particles, a.positions.size()); ++i) {
      Vec3 moved = Vec3::Zero();
      for (std::size_t k = i * near_.count; k < (i + 1) * near_.count; ++k) {
        const std::size_t j = near_.particles[k];
        if (j < b.positions.size())
          moved += static_cast<float>(near_.weights[k]) * (b.positions[j] - first_b.positions[j]);
      }
      visit(a.positions[i], first_a.positions[i] + moved,
            spacing_at(reference_, b, near_.particles[i * near_.count]));
    }
  }

  const Motion& motion_;
  const Motion& reference_;
  const PixelOf& pixel_;
  Neighbourhoods near_;
  std::vector<double> distances_, pixels_;
  double squares_ = 0, largest_kinetic_ = 0;
  std::size_t moments_ = 0;
  MotionError error_;
};

}  // namespace

double MotionError::shape() const {
  return std::max({height, spread, center});
}

MotionError motion_error(const Motion& motion, const Motion& reference, double from, const PixelOf& pixel) {
  if (!(from >= 0 && from < 1))
    throw ConfigError("from", std::to_string(from) + " is not allowed: a number in [0, 1)");
  const std::size_t count = std::min(motion.moments.size(), reference.moments.size());
  Sums sums(motion, reference, pixel);
  for (auto k = static_cast<std::size_t>(from * static_cast<double>(count)); k < count; ++k) sums.add(k);
  return sums.result();
}

}  // namespace mallow
