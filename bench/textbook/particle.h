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
  Matrix moment = Matrix::Zero();           ///< A_j
  Matrix rest_moment = Matrix::Zero();      ///< Ā_j
  Matrix stretch = Matrix::Identity();      ///< S_j [model 2, section 5]
  double flow = 0;                          ///< κ_j
};

struct Particle {
  std::size_t group = 0;
  Vec position{0, 0, 0};  ///< x [m]
  Vec velocity{0, 0, 0};  ///< v [m/s]
  bool pinned = false;
  Vec pin_velocity{0, 0, 0};  ///< [m/s]
  double own_alpha = -1;      ///< in place of its group's where it is not below 0
  double own_yield = -1;      ///< likewise, the strain from which it flows
  double stiffness = 1;       ///< factor on the elastic modulus

  std::vector<std::size_t> neighbors = {};  ///< within the support radius, the particle itself left out
  double density = 0;                       ///< ρ [kg/m³]; of the last step that ran SPH
  double pressure = 0;                      ///< p [Pa]
  Vec sph_acceleration{0, 0, 0};            ///< a^SPH, of its own group [m/s²]
  Vec blended_acceleration{0, 0, 0};        ///< the same, each pair times the mean alpha of its two [m/s²]
  Vec external_acceleration{0, 0, 0};       ///< gravity and other groups [m/s²]
  Vec contact_acceleration{0, 0, 0};        ///< by colliders [m/s²]

  Vec reference{0, 0, 0};  ///< x̄ [m]
  Vec led{0, 0, 0};        ///< where its shape is matched, x or x + τ v [m]
  double weight = 0;       ///< w = m/|N| [kg]
  Region region = {};
  Vec goal{0, 0, 0};  ///< g [m]
  /// Mean of goal_ij − x_i over its regions, each times (1 − alpha) stiffness of its owner. [model 2, section
  /// 7]
  Vec pull{0, 0, 0};
};

/// Particles of one material and one reference shape.
struct Group {
  Material material;
  std::vector<std::size_t> members = {};
  double spacing = 0;                          ///< h [m]
  double mass = 0;                             ///< m, of a particle [kg]
  double rest_density = 0;                     ///< ρ0 [kg/m³]
  double alpha = 0;                            ///< of the last step
  double most_alpha = 0, most_elasticity = 0;  ///< of its particles: α, and (1 − α) stiffness
  double update_threshold = 0;                 ///< γ_u [m/s²]
  double viscosity = 0;                        ///< μ [Pa s]
  double pressure_coefficient = 0;             ///< k of the last step [m²/s²]
  double contact_share = 1;                    ///< of its pressure that acts between groups
  double cohesion = 0;                         ///< share of its negative pressure
  double judged_external = 0;                  ///< |a_ext| that the next check judges [m/s²]
  /// Mean |a_ext| of the steps since the last check, and how long they were [s].
  struct External {
    double seconds, mean;
  };
  std::vector<External> external = {};
  double region_radius = 0;  ///< [m]

  /// A group that is fluid for ever has no reference shape.
  bool keeps_reference() const { return material.alpha.lowest() < 1; }
};

inline double yield_of(const Particle& p, const Group& group) {
  return p.own_yield < 0 ? group.material.plastic_yield.value_or(0.0f) : p.own_yield;
}

inline double alpha_of(const Particle& p, const Group& group) {
  return p.own_alpha < 0 ? group.alpha : p.own_alpha;
}

}  // namespace mallow::textbook
