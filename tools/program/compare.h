#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "program/compared_states.h"

namespace mallow::program {

/// How far surfaces are apart: from each vertex of either to the nearest vertex of the other, in spacings.
struct SurfaceDistance {
  bool same_bits = false;
  double rms = 0;
  double largest = 0;  ///< Hausdorff's, of vertices
};

/// How a frame of B differs from that of A. Distances are in spacings h of the particle's body.
struct FrameDifference {
  int frame = 0;
  double time_a = 0, time_b = 0;  ///< [s]
  bool same_bits = false;         ///< of all that the files say of particles
  std::size_t particles = 0;      ///< that are in both, by id
  std::size_t only_a = 0, only_b = 0;
  double rms = 0;
  double largest = 0;
  std::uint64_t particle = 0;  ///< where it is largest: slot of the id
  std::uint32_t body = 0;      ///< of that particle
  /// Height of the box around all particles, and kinetic energy, of B less that of A.
  double height = 0;                            ///< [m]
  std::optional<double> kinetic_energy = {};    ///< [J]
  std::optional<SurfaceDistance> surface = {};  ///< where both have one

  bool differs() const { return !same_bits || (surface && !surface->same_bits); }
  /// Whether anything is farther than `tolerance` [h], or only in one of the two.
  bool is_beyond(double tolerance) const;
};

/// How far each particle of B's frame is from that of A, by id [h]; infinity where A has none of it. `a`
/// knows its spacings. Throws IoError where a body has none.
std::vector<double> distances(const ComparedStates& a, const ComparedStates& b, int frame);

/// Why particles of the same id are not the same ones, where A and B begin with bodies of other samplings;
/// else empty.
std::string told_of_other_bodies(const ComparedStates& a, const ComparedStates& b, int first_frame);

/// Both have this frame. `a` knows its spacings.
FrameDifference compare_frame(const ComparedStates& a, const ComparedStates& b, int frame, int threads);

}  // namespace mallow::program
