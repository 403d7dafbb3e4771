#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "neighbors/cell_grid.h"
#include "neighbors/search_lanes.h"
#include "surface/picked_vectors.h"

namespace mallow {

/// The particles within a radius of a box, in radii from its lowest corner, in the order of their numbers: so
/// sums over them have the same bits wherever other particles are, though these move the cells.
struct NearParticles {
  std::vector<PlaceRange> ranges;
  std::vector<std::uint32_t> places;
  std::vector<float> x, y, z;
  std::size_t count = 0;
  /// Particles by number, a bit each, and words of these that are not 0; between searches all are 0.
  std::vector<std::uint64_t> numbers, words;

  ConstVectors positions() const { return {x.data(), y.data(), z.data()}; }
};

/// The particles that a surface is drawn around, sorted so that those near a box are found quickly. Of
/// crowds in one place a few count: more would say nothing new, and take for ever. Keeps its memory.
class ParticleCells {
 public:
  /// positions: finite. spacing: their h [m]. radius: of the searches [m].
  void sort(const PickedVectors& positions, float spacing, float radius, const Threads& threads);
  /// The same particles elsewhere, and sorted anew. positions: by place.
  void move(VectorColumn& positions, const Threads& threads);

  float radius() const { return radius_; }  ///< [m]
  std::size_t count() const { return grid_.order.size(); }
  Vec3 position(std::size_t place) const { return grid_.sorted.get(place); }
  /// Number of a particle as it was given to sort().
  std::uint32_t particle(std::size_t place) const {
    const std::uint32_t i = grid_.order[place];
    return particle_.empty() ? i : particle_[i];
  }
  /// Place of a particle before the last move().
  std::uint32_t place_before_move(std::size_t place) const { return grid_.order[place]; }

  void find_near(const Eigen::Vector3d& corner, double side, NearParticles& near) const;
  /// The same without offsets from the corner.
  void find_places_near(const Eigen::Vector3d& corner, double side, NearParticles& near) const;
  /// Positions of particles by their places [m]; x, y and z with room for k_cluster more.
  void positions(std::span<const std::uint32_t> places, std::vector<float>* axes) const;

  /// Clusters of up to eight particles that follow each other, near each other.
  std::size_t clusters() const { return grid_.clusters(); }
  PlaceRange cluster(std::size_t c) const { return {grid_.cluster_start[c], grid_.cluster_start[c + 1]}; }
  /// The particles near a cluster, in radii from `corner`, the lowest of the cluster's box.
  void find_near_cluster(std::size_t c, Eigen::Vector3d& corner, NearParticles& near) const;

  std::size_t bytes() const {
    return positions_.bytes() + grid_.bytes() +
           (particle_.capacity() + place_of_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  bool thin_crowds();
  void sort_into_cells(const Threads& threads);
  void order_by_number(NearParticles& near) const;
  void find_places(const Bounds& box, NearParticles& near) const;
  void find_near(const Bounds& box, const Eigen::Vector3d& corner, NearParticles& near) const;

  float radius_ = 0;
  VectorColumn positions_;
  std::vector<std::uint32_t> particle_;  ///< of each position, as given; empty: as they are
  std::vector<std::uint32_t> place_of_;  ///< by number of a particle, where it has a place
  CellGrid grid_;
};

}  // namespace mallow
