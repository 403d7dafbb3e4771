#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mallow/surface.h"

namespace mallow {

/// The particles of each surface in the order that sums are taken in: that of ids, or of rows where there are
/// none. Keeps its memory.
class ParticleOrder {
 public:
  /// joined: one surface for all bodies. Throws ConfigError where ids are not as said in SurfaceParticles;
  /// all else of the particles has been checked.
  void sort(const SurfaceParticles& particles, bool joined);

  std::size_t surfaces() const { return start_.size() - 1; }
  std::size_t count() const { return rows_.size(); }
  /// Their rows.
  std::span<const std::uint32_t> rows(std::size_t surface) const {
    return {rows_.data() + start_[surface], start_[surface + 1] - start_[surface]};
  }
  std::size_t bytes() const;

 private:
  void add(std::size_t surface, std::uint32_t row) { rows_[next_[surface]++] = row; }

  std::vector<std::size_t> start_{0, 0};  ///< surfaces + 1: first row of each in rows_
  std::vector<std::uint32_t> rows_;
  // Scratch.
  std::vector<std::size_t> next_;
  std::vector<std::uint32_t> row_of_slot_;
  std::vector<std::uint32_t> surface_of_row_;
};

/// The rows of a body, where there are so many in all.
inline Simulation::Rows rows_of(const SurfaceBody& body, std::size_t count) {
  return body.rows.value_or(Simulation::Rows{0, count});
}

}  // namespace mallow
