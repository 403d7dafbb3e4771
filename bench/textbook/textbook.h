#pragma once

#include <cstddef>
#include <vector>

#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "textbook/contact.h"
#include "textbook/particle.h"

/// The method of [TK] as one would first write it: double precision, one thread, one struct per particle with
/// a vector of its neighbours, an SVD for every rotation. The engine is timed against it, and at fine time
/// steps it is what the engine's results are measured by. It checks no input: the engine's classes do.
namespace mallow::textbook {

class Textbook {
 public:
  /// `threads` is passed over.
  explicit Textbook(const SolverConfig& config) : config_(config) {}

  /// Groups, bodies, colliders and pins are added before the first step. Groups and particles count from 0 in
  /// the order in which they are added; bodies of one group share one spacing.
  std::size_t add_group(const Material& material);
  void add_body(const Body& body, std::size_t group);
  void add_collider(const Collider& collider) { obstacles_.push_back({.collider = collider}); }
  /// Particles that are in `box` now move with `velocity` [m/s] from now on.
  void pin(const Aabb& box, const Vec3& velocity = {0, 0, 0});
  /// A particle has these of its own; alpha below 0: its group's.
  void paint(std::size_t id, double alpha, double stiffness);
  /// The same of the strain from which it flows.
  void paint_yield(std::size_t id, double yield) { particles_.at(id).own_yield = yield; }

  struct Step {
    double time_step = 0;        ///< Δt taken [s]
    double max_velocity = 0;     ///< V of eq. 12 [m/s]; 0 where no SPH acts
    int updated_references = 0;  ///< groups whose reference shape was updated at the start of this step
    int volume_iterations = 0;   ///< that it took
  };
  /// One step of algorithm 3.3 of the paper. Throws StepError and keeps positions and velocities where Δt
  /// would fall below Δt0/1000 or a velocity is not finite.
  Step step();

  double time() const { return time_; }  ///< simulated time [s]
  std::size_t size() const { return particles_.size(); }
  const std::vector<Particle>& particles() const { return particles_; }
  const std::vector<Group>& groups() const { return groups_; }
  std::vector<Vec> positions() const;     ///< by id [m]
  std::vector<Vec> velocities() const;    ///< by id [m/s]
  std::vector<double> densities() const;  ///< by id [kg/m³]; 0 where SPH never ran
  /// Mean |N_i| of a group, i included; 0 for a group that is fluid for ever, as it has no regions.
  double average_neighbors(std::size_t group) const;

 private:
  void settle_defaults();
  void follow_alpha();
  bool needs_sph() const;
  bool is_painted() const;
  bool counts_steps() const { return config_.update_interval && config_.time_step_factor == 1; }
  double passed(double time, double period) const;
  bool check_is_due() const;
  void kick_by_pull(const Group& group, double share);
  double stiffness(const Group& group) const;
  int update_references();
  double mean_external_acceleration(const Group& group) const;
  void measure_external(double time_step);
  double limited_time_step(double max_velocity) const;
  void choose_time_step(Step& step) const;
  Vec contacted(const Particle& p, const Vec& before, double time_step) const;
  double damped_limit(const Group& group, double pressure, double drag) const;
  void damp(const Group& group, double time_step);
  int keep_volume(double time_step, const std::vector<Vec>& before);
  int move_particles(double time_step);

  SolverConfig config_;
  std::vector<Particle> particles_;
  std::vector<Group> groups_;
  std::vector<Obstacle> obstacles_;
  double base_step_ = 0;     ///< Δt0 [s]
  double longest_step_ = 0;  ///< [s]
  double period_ = 0;        ///< between checks [s]
  double last_start_ = 0;    ///< of the step before [s]
  double time_ = 0;
  int steps_ = 0;
};

}  // namespace mallow::textbook
