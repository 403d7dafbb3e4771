#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mallow/material.h"

namespace mallow::textbook {

using Vec = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// N_j, the particles within the region radius of particle j in the reference shape, and how they lie now.
/// [TK eq. 7]
struct Region {
  std::vector<std::size_t> particles = {};  ///< the owner included; empty where no shape is matched
  double weight = 0;                        ///< Σ w_i [kg]
  Vec reference_center{0, 0, 0};            ///< c̄_j [m]
  Vec center{0, 0, 0};                      ///< c_j [m]
  Matrix rotation = Matrix::Identity();     ///< R_j
};

struct Particle {
  std::size_t group = 0;
  Vec position{0, 0, 0};  ///< x [m]
  Vec velocity{0, 0, 0};  ///< v [m/s]
  bool pinned = false;
  Vec pin_velocity{0, 0, 0};  ///< [m/s]

  std::vector<std::size_t> neighbors = {};  ///< within the support radius, the particle itself left out
  double density = 0;                       ///< ρ [kg/m³]; of the last step that ran SPH
  double pressure = 0;                      ///< p [Pa]
  Vec sph_acceleration{0, 0, 0};            ///< a^SPH, of its own group [m/s²]
  Vec external_acceleration{0, 0, 0};       ///< gravity and other groups [m/s²]
  Vec contact_acceleration{0, 0, 0};        ///< by colliders [m/s²]

  Vec reference{0, 0, 0};  ///< x̄ [m]
  double weight = 0;       ///< w = m/|N| [kg]
  Region region = {};
  Vec goal{0, 0, 0};  ///< g [m]
};

/// Particles of one material and one reference shape.
struct Group {
  Material material;
  std::vector<std::size_t> members = {};
  double spacing = 0;               ///< h [m]
  double mass = 0;                  ///< m, of a particle [kg]
  double rest_density = 0;          ///< ρ0 [kg/m³]
  double alpha = 0;                 ///< of the last step
  double update_threshold = 0;      ///< γ_u [m/s²]
  double viscosity = 0;             ///< μ [Pa s]
  double pressure_coefficient = 0;  ///< k of the last step [m²/s²]
  double contact_share = 1;         ///< of its pressure that acts between groups
  double cohesion = 0;              ///< share of its negative pressure
  double judged_external = 0;       ///< |a_ext| that the next check judges [m/s²]
  /// Mean |a_ext| of the steps since the last check, and how long they were [s].
  struct External {
    double seconds, mean;
  };
  std::vector<External> external = {};
  double region_radius = 0;  ///< [m]

  /// A group that is fluid for ever has no reference shape.
  bool keeps_reference() const { return material.alpha.lowest() < 1; }
};

}  // namespace mallow::textbook
