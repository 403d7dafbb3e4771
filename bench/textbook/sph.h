#pragma once

#include <vector>

#include "mallow/solver_config.h"
#include "textbook/particle.h"

/// Section 1 of the model, [TK] eq. 1 to 4.
namespace mallow::textbook {

/// Positions -> neighbours of every particle.
void find_neighbors(const SolverConfig& config, std::vector<Particle>& particles);
/// Positions, neighbours -> densities, pressures. [TK eq. 3]
void sum_densities(const SolverConfig& config, const std::vector<Group>& groups,
                   std::vector<Particle>& particles);
/// Positions, velocities, densities, pressures, neighbours -> a^SPH; what comes from other groups is added to
/// the external acceleration. [TK eq. 1, 2, 4]
void sum_accelerations(const SolverConfig& config, const std::vector<Group>& groups,
                       std::vector<Particle>& particles);

/// λ of every particle, and the mean compression that asks for them: of velocities w, what contact makes of
/// v'. share: of the compression, by group. [model 2, section 2]
struct Compression {
  std::vector<double> multipliers;
  double mean = 0;
};
Compression find_compression(const SolverConfig& config, const std::vector<Group>& groups, double time_step,
                             const std::vector<double>& share, const std::vector<Vec>& contacted,
                             const std::vector<Particle>& particles);
/// One iteration that keeps densities: λ -> v'.
void correct_volume(const SolverConfig& config, const std::vector<Group>& groups,
                    const std::vector<double>& multipliers, std::vector<Particle>& particles);

/// Σ W over an infinite cubic lattice, the point itself included [1/m³].
double lattice_sum(double spacing, double support_radius);

}  // namespace mallow::textbook
