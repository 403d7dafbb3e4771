#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mallow/simulation.h"
#include "view/frame.h"

namespace mallow::view {

/// What particles are coloured by.
class ParticleValues {
 public:
  /// Of every row, or none where there is no such quantity: of appearances, of what does not run.
  void find(const Simulation& simulation, Shown shown, std::vector<float>& values);

 private:
  /// Strain of every particle: the most by which its distance to one of its neighbours at rest has changed,
  /// by that distance. Neighbours are kept until the reference shape changes.
  void find_strains(const Simulation& simulation, std::vector<float>& values);
  struct RestNeighbors {
    std::vector<Vec3> rest;             ///< of each row of the body
    std::vector<std::uint32_t> starts;  ///< of each row, and the end
    std::vector<std::uint32_t> list;
  };
  std::map<BodyId, RestNeighbors> neighbors_;
};

}  // namespace mallow::view
