#include "program/compare.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "mallow/errors.h"
#include "mallow/ids.h"
#include "surface/nearest_points.h"

namespace mallow::program {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_bits(const ParticleFrame& a, const ParticleFrame& b) {
  return std::memcmp(&a.time, &b.time, sizeof a.time) == 0 && a.step == b.step &&
         same_bits(a.positions, b.positions) && same_bits(a.velocities, b.velocities) &&
         same_bits(a.bodies, b.bodies) && same_bits(a.ids, b.ids) && same_bits(a.alphas, b.alphas) &&
         same_bits(a.temperatures, b.temperatures);
}

bool same_bits(const Mesh& a, const Mesh& b) {
  return same_bits(a.vertices, b.vertices) && same_bits(a.triangles, b.triangles) &&
         same_bits(a.normals, b.normals) && same_bits(a.velocities, b.velocities) &&
         same_bits(a.material_ids, b.material_ids);
}

ParticleId id_of(const ParticleFrame& frame, std::size_t i) {
  return frame.ids.empty() ? i : frame.ids[i];
}

/// Calls visit(i, j) for the particles that are in both frames, by id.
template <class Visit>
void for_each_pair(const ParticleFrame& a, const ParticleFrame& b, const Visit& visit) {
  std::size_t i = 0, j = 0;
  while (i < a.positions.size() && j < b.positions.size()) {
    const ParticleId in_a = id_of(a, i), in_b = id_of(b, j);
    if (in_a == in_b) visit(i, j);
    const std::uint32_t slot_a = slot_of(in_a), slot_b = slot_of(in_b);  // which ascend
    if (slot_a <= slot_b) ++i;
    if (slot_b <= slot_a) ++j;
  }
}

double height(const ParticleFrame& frame) {
  if (frame.positions.empty()) return 0;
  const auto [low, high] = std::ranges::minmax(frame.positions, {}, [](const Vec3& p) { return p.z(); });
  return static_cast<double>(high.z()) - static_cast<double>(low.z());
}

std::optional<double> kinetic_energy(const ParticleFrame& frame, std::span<const double> masses) {
  double sum = 0;
  for (std::size_t i = 0; i < frame.velocities.size(); ++i) {
    const std::uint32_t body = frame.bodies.empty() ? 0 : frame.bodies[i];
    if (body >= masses.size() || masses[body] == 0) return std::nullopt;
    sum += 0.5 * masses[body] * frame.velocities[i].cast<double>().squaredNorm();
  }
  return sum;
}

/// Finite, and so that squares of distances are.
bool can_be_measured(const Mesh& mesh) {
  return std::ranges::all_of(mesh.vertices,
                             [](const Vec3& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() < 1e15f; });
}

SurfaceDistance distance_of(const Mesh& a, const Mesh& b, float spacing, int threads) {
  SurfaceDistance distance{.same_bits = same_bits(a, b)};
  if (distance.same_bits || (a.vertices.empty() && b.vertices.empty())) return distance;
  if (a.vertices.empty() || b.vertices.empty() || !can_be_measured(a) || !can_be_measured(b))
    return {.same_bits = false, .rms = k_infinity, .largest = k_infinity};
  double squares = 0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const NearestPoint& nearest : find_nearest(from->vertices, to->vertices, spacing / 2, threads)) {
      const double in_spacings = static_cast<double>(nearest.distance) / static_cast<double>(spacing);
      squares += in_spacings * in_spacings;
      distance.largest = std::max(distance.largest, in_spacings);
    }
  distance.rms = std::sqrt(squares / static_cast<double>(a.vertices.size() + b.vertices.size()));
  return distance;
}

std::uint32_t body_of(const ParticleFrame& frame, std::size_t i) {
  return frame.bodies.empty() ? 0 : frame.bodies[i];
}

/// In spacings of A's body. Throws IoError where it has none.
double distance_of(const ComparedStates& a, std::span<const SlotBody> bodies, const ParticleFrame& in_a,
                   std::size_t i, const ParticleFrame& in_b, std::size_t j) {
  const std::uint32_t body = body_of(in_a, i);
  if (body >= bodies.size())
    throw IoError({a.path().string(), 0, 0, "group",
                   "no spacing is known of body " + std::to_string(body) + "; give one with --spacing"});
  const Eigen::Vector3d way = in_b.positions[j].cast<double>() - in_a.positions[i].cast<double>();
  const double distance = way.norm() / static_cast<double>(bodies[body].spacing);
  if (std::isfinite(distance)) return distance;
  // The same place where no number is one.
  return std::memcmp(&in_a.positions[i], &in_b.positions[j], sizeof(Vec3)) == 0 ? 0 : k_infinity;
}

}  // namespace

std::vector<double> distances(const ComparedStates& a, const ComparedStates& b, int frame) {
  const ParticleFrame in_a = a.particles(frame), in_b = b.particles(frame);
  const std::vector<SlotBody> bodies = a.bodies(frame);
  std::vector<double> all(in_b.positions.size(), k_infinity);
  for_each_pair(in_a, in_b,
                [&](std::size_t i, std::size_t j) { all[j] = distance_of(a, bodies, in_a, i, in_b, j); });
  return all;
}

std::string told_of_other_bodies(const ComparedStates& a, const ComparedStates& b, int first_frame) {
  const ParticleFrame in_a = a.particles(first_frame), in_b = b.particles(first_frame);
  std::string what;
  const std::vector<float> apart_a = spacings_of(a.bodies(first_frame)),
                           apart_b = spacings_of(b.bodies(first_frame));
  for (std::size_t body = 0; body < std::min(apart_a.size(), apart_b.size()) && what.empty(); ++body)
    if (std::abs(apart_a[body] - apart_b[body]) > 1e-6f * apart_a[body])
      what = "particles of " + a.body_name(static_cast<std::uint32_t>(body), first_frame) + " are " +
             std::to_string(apart_a[body]) + " m apart in A and " + std::to_string(apart_b[body]) + " m in B";
  // Where ids are written, they tell which particles are gone.
  if (what.empty() && in_a.ids.empty() && in_b.ids.empty() && in_a.positions.size() != in_b.positions.size())
    what = "A begins with " + std::to_string(in_a.positions.size()) + " particles and B with " +
           std::to_string(in_b.positions.size());
  if (what.empty()) return "";
  return "A and B are of different bodies: " + what +
         ", so that particles of the same number are not the same ones. Their distances tell nothing; those "
         "of "
         "surfaces do";
}

bool FrameDifference::is_beyond(double tolerance) const {
  if (only_a > 0 || only_b > 0) return true;
  return largest > tolerance || (surface && surface->largest > tolerance);
}

FrameDifference compare_frame(const ComparedStates& a, const ComparedStates& b, int number, int threads) {
  const ParticleFrame in_a = a.particles(number), in_b = b.particles(number);
  const std::vector<SlotBody> bodies = a.bodies(number);
  FrameDifference difference{.frame = number, .time_a = in_a.time, .time_b = in_b.time};
  difference.same_bits = same_bits(in_a, in_b);
  double squares = 0;
  for_each_pair(in_a, in_b, [&](std::size_t i, std::size_t j) {
    const std::uint32_t body = body_of(in_a, i);
    const double distance = distance_of(a, bodies, in_a, i, in_b, j);
    ++difference.particles;
    squares += distance * distance;
    if (distance > difference.largest || difference.particles == 1) {
      difference.largest = distance;
      difference.particle = slot_of(id_of(in_a, i));
      difference.body = body;
    }
  });
  difference.only_a = in_a.positions.size() - difference.particles;
  difference.only_b = in_b.positions.size() - difference.particles;
  if (difference.particles > 0)
    difference.rms = std::sqrt(squares / static_cast<double>(difference.particles));
  difference.height = height(in_b) - height(in_a);
  const std::vector<double> masses_a = a.masses(number), masses_b = b.masses(number);
  const auto energy_a = kinetic_energy(in_a, masses_a);
  const auto energy_b = kinetic_energy(in_b, masses_b.empty() ? masses_a : masses_b);
  if (energy_a && energy_b) difference.kinetic_energy = *energy_b - *energy_a;
  const std::optional<Mesh> surface_a = a.surface(number), surface_b = b.surface(number);
  if (surface_a && surface_b)
    difference.surface = distance_of(*surface_a, *surface_b, std::ranges::min(spacings_of(bodies)), threads);
  return difference;
}

}  // namespace mallow::program
