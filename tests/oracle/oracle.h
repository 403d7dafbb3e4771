#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "mallow/collider.h"
#include "mallow/emitter.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/vec3.h"
#include "oracle/kernels.h"

/// The model read literally: double precision, every pair looked at, one struct per particle, an SVD for
/// every rotation. Nothing is shared with the engine but the structs that configure it, so that a mistake in
/// one is not a mistake in both. O(n²) a step: meant for a few hundred particles.
namespace mallow::oracle {

using Vec = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

struct Particle {
  std::size_t group = 0;
  std::size_t id = 0;  ///< in the order in which particles came
  Vec x{0, 0, 0};
  Vec v{0, 0, 0};
  bool pinned = false;
  Vec pin_velocity{0, 0, 0};
  double own_alpha = -1;   ///< in place of its group's where it is not below 0
  double own_yield = -1;   ///< likewise
  double stiffness = 1;    ///< factor on the elastic modulus
  double temperature = 0;  ///< T [K]

  Vec reference{0, 0, 0};                ///< x̄
  std::vector<std::size_t> region = {};  ///< N, the particle itself included
  Matrix rotation = Matrix::Identity();
  Matrix stretch = Matrix::Identity();  ///< S
  double flow = 0;                      ///< κ

  // What the last step found.
  /// What a collider that is filled with like matter is to SPH.
  struct Wall {
    double share, gradient;  ///< S, and B [1/m], what others cover left out
    Vec normal;
    double distance;  ///< [m]
    double left;      ///< the share of it that others do not cover
    Vec velocity;     ///< [m/s]
    double friction;
    double push = 0;  ///< what it has given across in this step [m/s]
  };
  std::vector<Wall> walls = {};
  double wall_share = 0;  ///< of the kernel's volume, of all walls
  double density = 0;
  double pressure = 0;
  Vec sph{0, 0, 0};                     ///< a^SPH of the same group [m/s²]
  Vec blended{0, 0, 0};                 ///< the same, each pair times the mean alpha of its two
  Vec external{0, 0, 0};                ///< gravity, user force, walls and the other groups [m/s²]
  Vec crossing{0, 0, 0};                ///< the part of `external` that is from the other groups [m/s²]
  Vec contact{0, 0, 0};                 ///< change of velocity by colliders over Δt [m/s²]
  Vec goal{0, 0, 0};                    ///< g
  Matrix moment = Matrix::Zero();       ///< A of its region
  Matrix rest_moment = Matrix::Zero();  ///< Ā
  Vec outward{0, 0, 0};                 ///< N: R (x̄ − c̄) of its region; 0 in a fluid
  Vec pull{0, 0, 0};  ///< mean of goal_ij − x_i over its regions, each times (1 − alpha) stiffness of its own
};

struct Group {
  Material material;
  double spacing = 0;
  double mass = 0;
  double rest_density = 0;
  double wendland_volume = 0;              ///< m/ρ0, such that its lattice is as dense by that kernel
  double update_threshold = 0;             ///< γ_u
  double viscosity = 0;                    ///< μ; where it follows temperatures, of the thickest particle
  double alpha = 0;                        ///< of the last step
  double least_alpha = 0, most_alpha = 0;  ///< of its particles
  double most_elasticity = 0;              ///< likewise, (1 − α) stiffness
  double pressure_coefficient = 0;         ///< k of the last step
  double contact_share = 1;                ///< of its pressure that acts between groups
  double cohesion = 0;                     ///< share of its negative pressure
  bool splits = false;                     ///< where it was torn
  bool may_be_torn = false;                ///< regions have changed since it was looked at
  /// Mean |a_ext| over the unpinned, from the start to the end of every step.
  struct External {
    double start, end, mean;
  };
  std::vector<External> external = {};
};

struct Step {
  double time_step = 0;     ///< Δt [s]
  double max_velocity = 0;  ///< V of eq. 12; 0 where no SPH acts
  std::vector<std::size_t> updated_groups;
  int volume_iterations = 0;  ///< that it took
};

/// Acceleration of a particle by the user, from time, id, position and velocity.
using Force = std::function<Vec(double, std::size_t, const Vec&, const Vec&)>;

void set_mass_and_rest_density(Group& group, double sigma);
Vec pushed_along(const Particle::Wall& wall, double alpha, double all, const Vec& by_neighbors,
                 const Vec& weight);

class Oracle {
 public:
  explicit Oracle(const SolverConfig& config) : config_(config) {}

  /// Groups, bodies, colliders and pins are added before the first step. Ids count particles in order of
  /// add_body.
  std::size_t add_group(const Material& material);
  void add_body(const std::vector<Vec>& positions, const std::vector<Vec>& velocities, double spacing,
                std::size_t group);
  void add_collider(const Collider& collider) { obstacles_.push_back({collider, Vec::Zero()}); }
  void pin(const Aabb& box, const Vec& velocity);
  /// A strand of a group of its own; its layers are these points across the flow, each layer turned by `turn`
  /// against the one before [rad]. Without jitter, keyframes and an end: such are not known.
  void add_emitter(const Emitter& emitter, const std::vector<Vec>& section, double turn,
                   const Material& material);
  /// Takes what is not pinned in a box, or outside of it, before each step.
  void add_sink(const Aabb& box, bool outside) { sinks_.push_back({box, outside}); }
  /// Parts of a group that was torn become groups of their own.
  void let_split(std::size_t group) { groups_[group].splits = true; }
  void set_force(Force force) { force_ = std::move(force); }
  /// A particle has these of its own; alpha below 0: its group's.
  void paint(std::size_t id, double alpha, double stiffness) {
    particles_[id].own_alpha = alpha;
    particles_[id].stiffness = stiffness;
  }
  /// The same of the strain from which it flows [1], and of its temperature at the start [K].
  void paint_yield(std::size_t id, double yield) { particles_[id].own_yield = yield; }
  void warm(std::size_t id, double temperature) { particles_[id].temperature = temperature; }
  /// Moves the particles away from their reference shape.
  void set_positions(const std::vector<Vec>& positions);

  Step step();

  double time() const { return time_; }
  const std::vector<Particle>& particles() const { return particles_; }
  const std::vector<Group>& groups() const { return groups_; }
  std::vector<Vec> positions() const;
  std::vector<Vec> velocities() const;

 private:
  struct Obstacle {
    Collider collider;
    Vec moved;  ///< since it was added
  };
  /// What makes sums over pairs of a lattice the Laplacian; by spacing.
  struct HeatLattice {
    double factor = 0, open = 0, exposure = 0, resistance = 0;
    /// What pairs of a particle of a density over that at rest count.
    double counts(double density) const;
  };
  /// What a particle exchanges with what is no particle.
  struct Bath {
    double conductance = 0;  ///< [W/K]
    double flow = 0;         ///< at 0 K [W]
  };

  struct Sink {
    Aabb box;
    bool outside;
  };

  struct Strand {
    Emitter emitter;
    std::vector<Vec> section;
    double turn = 0;
    std::size_t group = 0;
    std::size_t least_held = 0;                       ///< layers
    std::size_t layers = 0;                           ///< that there were
    double offset = 0;                                ///< how far the first has come [m]
    std::vector<std::vector<std::size_t>> held = {};  ///< places of the particles of each layer
  };

  void add_layers(Strand& strand, std::size_t count, const Vec& velocity);
  void flow_out();
  Vec velocity_of(const Strand& strand, double speed) const;
  void drive(double dt);
  std::vector<std::vector<std::size_t>> parts_of_group(std::size_t group) const;
  void split_torn();
  void drain();
  void rebuild_regions(std::size_t group);
  void flow(double dt);
  bool reframe_is_due(std::size_t group) const;
  bool is_torn(std::size_t group) const;
  bool has_flowed_too_far(std::size_t group) const;
  double strain_energy(std::size_t group) const;
  bool reframe(std::size_t group, bool waits);
  void list_regions(std::size_t group);
  void rest_anew(std::size_t group, double mean);
  void kick_by_pull(std::size_t group, double share);
  void settle();
  void follow_alpha();
  double mean_external_acceleration(std::size_t group) const;
  double judged_acceleration(std::size_t group) const;
  bool counts_steps() const { return config_.update_interval && config_.time_step_factor == 1; }
  double passed(double time, double period) const;
  double alpha_of(const Particle& p) const;
  double yield_of(const Particle& p) const;
  double viscosity_of(const Particle& p) const;
  bool carries_heat() const;
  void follow_temperatures();
  HeatLattice heat_lattice(const Group& group) const;
  static double heated(const Material& material, double temperature, double gained);
  Bath bath_of(const Particle& p, const HeatLattice& lattice) const;
  void conduct(double dt);
  bool is_painted() const;
  double stiffness(const Group& group) const;
  bool check_is_due() const;
  bool tears_are_looked_for() const;
  std::vector<std::size_t> update_references();
  void find_walls(Particle& p) const;
  Vec wall_acceleration(const Particle& p) const;
  void sum_densities();
  Vec pair_acceleration(const Particle& i, const Particle& j) const;
  void sum_accelerations();
  bool bodies_touch() const;
  bool act_on_each_other(const Particle& i, const Particle& j) const;
  void touch_bodies(double dt, std::vector<Vec>& v) const;
  bool needs_sph() const;
  bool has_limits() const;
  int volume_iterations() const;
  double max_velocity() const;
  double damped_limit(const Group& group, double a, double drag, double pull) const;
  double time_step(double max_velocity) const;
  void match_shapes(bool leads);
  double damping_rate(const Group& group, double deformation_speed) const;
  void damp(double dt);
  static void rub(const Vec& before, Particle& p);
  void touch(const Obstacle& obstacle, const Particle& particle, const Vec& before, double dt, Vec& v) const;
  int keep_volume(double dt, const std::vector<Vec>& before);
  int move(double dt);

  SolverConfig config_;
  std::vector<Group> groups_;
  std::vector<Particle> particles_;
  std::vector<Obstacle> obstacles_;
  std::vector<Strand> strands_;
  std::vector<Sink> sinks_;
  std::vector<HeatLattice> lattices_;
  Force force_;
  double dt0_ = 0;         ///< Δt0 [s]
  double longest_ = 0;     ///< longest step [s]
  double period_ = 0;      ///< between checks, where they are not counted in steps [s]
  double last_start_ = 0;  ///< of the step before [s]
  double time_ = 0;
  double last_check_ = 0;  ///< start of the last step that began with one [s]
  int steps_ = 0;
  std::size_t born_ = 0;  ///< particles that there have been
};

/// α at a time: linear between keys, constant outside.
double alpha_at(const AlphaSchedule& schedule, double time);
/// Σ W over an infinite cubic lattice, the point itself included.
double lattice_sum(double spacing, double support_radius, double (*kernel)(double, double) = poly6);
/// The rotation of the polar decomposition of `a`. `last` decides where `a` says nothing, that is about
/// directions in which it is smaller than 1e-12 `scale`.
Matrix polar_rotation(const Matrix& a, const Matrix& last, double scale);

}  // namespace mallow::oracle
