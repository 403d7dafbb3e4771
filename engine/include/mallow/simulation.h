#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <Eigen/Geometry>

#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/emitter.h"
#include "mallow/errors.h"
#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/material.h"
#include "mallow/report.h"
#include "mallow/saved_state.h"
#include "mallow/solver_config.h"
#include "mallow/vec3.h"

namespace mallow {

/// Three columns, one per component, seen without a copy. Row i of every view of a simulation is the same
/// particle; its id is ids()[i]. A view is valid until the next step or change of the simulation.
template <class Scalar>
class VectorColumns {
 public:
  /// As Eigen sees it: n × 3.
  using Map =
      Eigen::Map<std::conditional_t<std::is_const_v<Scalar>, const Eigen::Matrix<float, Eigen::Dynamic, 3>,
                                    Eigen::Matrix<float, Eigen::Dynamic, 3>>,
                 Eigen::Unaligned, Eigen::OuterStride<>>;

  /// data: x of row 0; y and z of it are `stride` and twice that further on.
  VectorColumns(Scalar* data, std::size_t size, std::size_t stride)
      : data_(data), size_(size), stride_(stride) {}

  /// Rows.
  std::size_t size() const { return size_; }
  /// One component of all rows.
  std::span<Scalar> x() const { return {data_, size_}; }
  /// @copydoc x()
  std::span<Scalar> y() const { return {data_ + stride_, size_}; }
  /// @copydoc x()
  std::span<Scalar> z() const { return {data_ + 2 * stride_, size_}; }
  /// The vector of a row, a copy.
  Vec3 operator[](std::size_t row) const {
    return {data_[row], data_[stride_ + row], data_[2 * stride_ + row]};
  }
  /// n × 3, a row per particle.
  Map eigen() const {
    return {data_, static_cast<Eigen::Index>(size_), 3,
            Eigen::OuterStride<>(static_cast<Eigen::Index>(stride_))};
  }

 private:
  Scalar* data_;
  std::size_t size_;
  std::size_t stride_;
};
using VectorView = VectorColumns<const float>;  ///< to read
using VectorSpan = VectorColumns<float>;        ///< to write

/// Rotations of the particles of a body, seen without a copy where its regions keep them. Valid until the
/// next step or change of the simulation.
class RotationView {
 public:
  /// columns: x, y, z and w of each region.
  RotationView(const std::array<const float*, 4>& columns, std::size_t size)
      : columns_(columns), size_(size) {}
  /// Particle i is turned as region entries[begin[i]] % regions.
  RotationView(const std::array<const float*, 4>& columns, std::size_t size, const std::uint32_t* begin,
               const std::uint32_t* entries, std::size_t regions)
      : columns_(columns), size_(size), begin_(begin), entries_(entries), regions_(regions) {}

  /// Particles of the body.
  std::size_t size() const { return size_; }
  /// The rotation of one of them, counted from the body's first.
  Eigen::Quaternionf operator[](std::size_t i) const {
    const std::size_t region = begin_ == nullptr ? i : entries_[begin_[i]] % regions_;
    return {columns_[3][region], columns_[0][region], columns_[1][region], columns_[2][region]};
  }

 private:
  std::array<const float*, 4> columns_;
  std::size_t size_;
  const std::uint32_t* begin_ = nullptr;
  const std::uint32_t* entries_ = nullptr;
  std::size_t regions_ = 0;
};

/// What a force callback sees.
struct ForceInput {
  double time;  ///< [s]
  std::span<const ParticleId> ids;
  VectorView positions;   ///< [m]
  VectorView velocities;  ///< [m/s]
};
/// Adds accelerations [m/s²] to what it is given; called once a step, before anything else moves. It may not
/// change or step the simulation that calls it: that throws ConfigError. What it throws ends the step, and
/// the state stays what it was before it.
using ForceCallback = std::function<void(const ForceInput&, VectorSpan accelerations)>;

/// What a ray meets first.
struct BodyHit {
  double distance;  ///< from the ray's origin [m]
  Vec3 position;    ///< [m]
  Vec3 normal;      ///< of the ball around the particle
  BodyId body;
  ParticleId particle;
};
/// @copydoc BodyHit
struct ColliderHit {
  double distance;  ///< from the ray's origin [m]
  Vec3 position;    ///< [m]
  Vec3 normal;      ///< towards the free side
  ColliderId collider;
};
/// See Simulation::nearest_particle().
struct NearestParticle {
  double distance;  ///< [m]
  ParticleId particle;
  BodyId body;
};
/// Pieces of a body that shape matching holds together: particles are in one where they share a region,
/// directly or through others.
struct BodyParts {
  std::size_t parts = 1;   ///< of four particles or more
  std::size_t crumbs = 0;  ///< smaller ones
};
/// A body as a whole; pinned particles count as all others.
struct BodyMotion {
  double mass;                       ///< [kg]
  Eigen::Vector3d center_of_mass;    ///< [m]
  Eigen::Vector3d velocity;          ///< of the centre of mass [m/s]
  Eigen::Vector3d angular_velocity;  ///< ω of the rigid body that has its spin [rad/s]
  Eigen::Vector3d momentum;          ///< [N s]
  double kinetic_energy;             ///< [J]
};

/// A scene in motion: SPH and shape matching blended by alpha [TK]. Results depend on the binary and on what
/// was added, never on the number of threads. One thread may use an object at a time; different objects are
/// independent. One that was moved from may only be assigned to or destroyed.
///
/// What holds of every call, and is said below where there is more to it: the id of a body, a material, a
/// collider, a pin or a particle is looked up, not searched for, and an id that names nothing, or nothing any
/// more, makes the call throw ConfigError. So does one that changes anything from within a force callback. A
/// call that throws ConfigError has changed nothing. One that names no cost takes a time that does not grow
/// with what there is, beyond emitters and sinks.
class MALLOW_EXPORT Simulation {
 public:
  /// Throws ConfigError with every value that is out of range.
  explicit Simulation(const SolverConfig& config);
  ~Simulation();
  /// Moves, without a copy of particles.
  Simulation(Simulation&&) noexcept;
  /// @copydoc Simulation(Simulation&&)
  Simulation& operator=(Simulation&&) noexcept;

  /// A material that bodies share; it stays, whoever is made of it. Throws ConfigError with every value that
  /// is out of range, or that steps are too long for.
  MaterialId add_material(const Material& material, std::string name = {});
  /// Adds a body; its particles get the next ids. Throws ConfigError, and changes nothing, also where a point
  /// is nearer than a tenth of the spacing to another one of the body or to a particle that is there, or
  /// where floats cannot tell points apart so far from 0. Costs a search around its points, and in the next
  /// step its regions.
  BodyId add_body(const Body& body, MaterialId material, std::string name = {});
  /// Adds a body of a material of its own, which material(BodyId) names: others may be made of it too. It
  /// goes with the last of them, and its id names nobody again.
  BodyId add_body(const Body& body, const Material& material, std::string name = {});
  /// Adds particles to a body, with its spacing: all of it is one piece, with one reference shape. In one
  /// that already moved the others keep where they rest, and a new particle rests beside the one that it is
  /// put next to, as that is turned and moved. Costs some passes over the body, and new lists for what is
  /// near what came. Throws what add_body() throws.
  void extend_body(BodyId body, const Body& more);
  /// A body is gone, and what leaned on it wakes. Its id and those of its particles name nobody again. No
  /// other body is touched; the cost is that of moving the rows behind it up. Throws ConfigError where there
  /// is none of this id, or no longer.
  void remove_body(BodyId body);
  /// Particles are gone. Those left of their bodies keep where they rest, and hold together by the regions
  /// that are left; a body without particles is removed. Costs some passes over their bodies, a move of the
  /// rows behind, and new lists for what was near them. Throws ConfigError, and removes none, where an id is
  /// not one or comes twice.
  void remove_particles(std::span<const ParticleId> ids);
  /// The same for all that are in a box now [m]. Looks at every particle. Returns how many; throws
  /// ConfigError where there are none.
  std::size_t remove_particles(const Aabb& region);
  /// Parts of a body that shape matching no longer holds together become bodies of their own, of the same
  /// material, that rest and move as they did: they touch each other as bodies do. The largest keeps the id,
  /// or the one that an emitter puts new layers behind; the others are named after it, and `split` events
  /// name them. Parts of fewer than four particles stay with it. Returns all of them, the one that keeps the
  /// id first: that alone where the body is in one part now. What it lost before, by an earlier call or as
  /// Body::splits says, is a body of its own and no part of it any more: the events of then named it. Costs a
  /// look at all its regions, and new lists where it is in several parts. Throws ConfigError where there is
  /// none of this id, and what prepare() throws.
  std::vector<BodyId> split(BodyId body);
  /// An obstacle from the next step on; what sleeps near it wakes. Throws ConfigError with every value that
  /// is out of range.
  ColliderId add_collider(const Collider& collider);
  /// Another one in its place from the next step on, under the same id: shape, pose, friction and all.
  /// Nothing feels the way from the old pose to the new one; set_pose(), set_twist() and keyframes move it.
  /// Throws what add_collider() throws, and ConfigError where there is none of this id.
  void set_collider(ColliderId id, const Collider& collider);
  /// It is gone from the next step on, and what sleeps near it wakes. Throws ConfigError where there is none
  /// of this id.
  void remove_collider(ColliderId collider);
  /// A nozzle, and a body that is its strand: what it holds behind it is there at once, and is part of the
  /// body in all that is asked of it (volume(), heat(), bounds(), motion()); held() names it, for who wants
  /// only what has left. Costs what add_body() costs, and every eighth layer what extend_body() costs. Throws
  /// what add_body() and pin() throw.
  EmitterId add_emitter(const Emitter& emitter, MaterialId material, std::string name = {});
  /// Its strand. Throws ConfigError where there is none of this id, or no longer.
  BodyId body(EmitterId emitter) const;
  /// As it is now, where it has moved. Throws as body() does.
  const Emitter& emitter(EmitterId emitter) const;
  /// Those that there are, in the order in which they were added.
  std::vector<EmitterId> emitter_ids() const;
  /// Particles of the layers that have not passed the nozzle, the next to leave first. Throws ConfigError
  /// where there is none of this id.
  std::vector<ParticleId> held(EmitterId emitter) const;
  /// How fast the strand leaves it, and how fast the nozzle itself moves, from now on [m/s]. It has no
  /// keyframes then. Throws ConfigError, and changes nothing, where one is out of range, or both are faster
  /// than any step carries.
  void set_flow(EmitterId emitter, const Schedule& speed, const Vec3& velocity = {0, 0, 0});
  /// The nozzle is gone and what it held is free. Looks at every particle. Throws ConfigError where there is
  /// none of this id.
  void remove_emitter(EmitterId emitter);
  /// Particles that come into a box, or out of it, and are not pinned, are removed at the start of every
  /// step [m]. Every step looks at every particle for it. Throws ConfigError where a number is not finite, or
  /// min not below max.
  SinkId add_sink(const Aabb& box, bool outside = false);
  /// Throws ConfigError where there is none of this id.
  void remove_sink(SinkId sink);
  /// How many particles it has taken. Throws as remove_sink() does.
  std::uint64_t drained(SinkId sink) const;
  std::vector<SinkId> sink_ids() const;  ///< of all that there are, as they were added
  /// Particles that are in `region` [m] now move with `velocity` [m/s] from now on and answer to nothing
  /// else. Looks at every particle. The region may hold none: that is a ConfigError, as nobody means it.
  /// Throws as the other does.
  PinId pin(const Aabb& region, const Vec3& velocity = {0, 0, 0});
  /// The same for particles by id. Throws ConfigError where an id is not one, a number is not finite, no step
  /// carries them so fast, or there are 65535 pins.
  PinId pin(std::span<const ParticleId> ids, const Vec3& velocity = {0, 0, 0});
  /// Its particles are free again, as fast as they are. Looks at every particle. Throws ConfigError where
  /// there is none of this id.
  void unpin(PinId pin);
  /// An empty function takes the callback away. What it gives an acceleration to does not sleep. Costs one
  /// call a step.
  void set_force(ForceCallback callback);

  /// [m/s²]; wakes all that sleeps. What follows from gravity where a config leaves it out stays as the first
  /// prepare() settled it. Throws ConfigError, and changes nothing, where a number is not finite.
  void set_gravity(const Vec3& gravity);
  /// How steps are taken from now on; take config() and change it. What may change is time_step_factor,
  /// gravity, rotation_iterations, volume_tolerance, neighbor_slack, acoustic_limit, sleep_speed, sleep_time,
  /// air_temperature and memory_limit: the rest is what a simulation was made with. Throws ConfigError, and
  /// changes nothing, where another setting differs, a value is out of range, or steps would be too long for
  /// a material's springs.
  void set_solver(const SolverConfig& config);
  /// What all bodies of a material are made of from now on. Wakes them. Reference shapes stay; the regions
  /// are built anew where their radius or stride changes. Throws ConfigError with every value that is out of
  /// range, or that steps are too long for.
  void set_material(MaterialId material, const Material& settings);
  /// As set last. Throws ConfigError where there is none of this id.
  const Material& material_settings(MaterialId material) const;
  /// Alpha of a material alone, in [0, 1]; particles that have their own keep it. Wakes its bodies. Throws as
  /// set_material() does.
  void set_alpha(MaterialId material, const AlphaSchedule& alpha);
  /// Alpha of particles from now on, in [0, 1], in place of their material's. All of their bodies keep what
  /// they have now, as if Body::alpha had said it. Throws ConfigError, and changes nothing, where a number is
  /// out of range, an id is not one, or a body would be too stiff for its steps.
  void set_alpha(std::span<const ParticleId> ids, float alpha);
  /// Factor on the modulus of particles from now on, see Body::stiffness. Throws as set_alpha() does.
  void set_stiffness(std::span<const ParticleId> ids, float stiffness);
  /// Temperature of particles now [K], finite. Throws ConfigError, and changes nothing, where an id is not
  /// one or its body carries no heat.
  void set_temperature(std::span<const ParticleId> ids, float temperature);
  /// Temperature of a collider from now on, over time [K]; nullopt: no heat passes. Throws ConfigError where
  /// a number is not finite, or there is none of this id.
  void set_temperature(ColliderId collider, const std::optional<Schedule>& temperature);
  /// The velocity of a collider from now on [m/s], finite. It has no keyframes then. Throws as set_twist()
  /// does.
  void set_velocity(ColliderId collider, const Vec3& velocity);
  /// [m/s], and [rad/s] about its pose's translation; no keyframes then. Throws ConfigError where a number is
  /// not finite, or there is none of this id.
  void set_twist(ColliderId collider, const Vec3& velocity, const Vec3& angular_velocity);
  /// Puts a collider where it then stands still, without keyframes. seconds: 0, it is there at once and moves
  /// nothing on the way; > 0, it takes so long [s] and moves what it meets. Throws ConfigError where a number
  /// is out of range. There is no callback that a step asks for poses, as no state could save it: a program
  /// that has a pose for every time says before each advance(seconds) where the collider is after it,
  /// set_pose(collider, my_pose(time() + seconds), seconds). At the end of each the pose is that one,
  /// whatever steps led there; in between it moves and turns evenly, so take seconds as short as the motion
  /// asks for.
  void set_pose(ColliderId collider, const Pose& pose, double seconds = 0);
  /// The velocity of the particles of a pin from now on [m/s]. Looks at every particle. Throws ConfigError
  /// where a number is not finite, no step carries them so fast, or there is none of this id.
  void set_velocity(PinId pin, const Vec3& velocity);
  /// The particles of a pin go `way` [m] in the next `seconds`, > 0, evenly, and stay there. Throws as
  /// set_velocity() of a pin does.
  void move_pin(PinId pin, const Vec3& way, double seconds);
  /// Of all particles of a body that are not pinned: [m/s], and [rad/s] about its centre of mass, along the
  /// axes of the world. Wakes it; costs a pass over its particles. Throws ConfigError, and changes nothing,
  /// where there is none of this id, a number is not finite, or a particle would be so fast that no step
  /// carries it: steps are a thousandth of the longest at least, and none moves anything farther than the
  /// support radius, less half a spacing where bodies touch.
  void set_velocity(BodyId body, const Vec3& velocity, const Vec3& angular_velocity = {0, 0, 0});
  /// Of particles that are not pinned [m/s]. Throws ConfigError, and changes nothing, where an id is not one,
  /// and as the other does.
  void set_velocity(std::span<const ParticleId> ids, const Vec3& velocity);
  /// Moves a body, pinned particles too, so that its centre of mass is there [m]; some passes over them.
  /// Where it then overlaps another body, contact pushes apart those particles that are near each other; two
  /// that stand deep in each other may stay so. Throws ConfigError, and changes nothing, also where floats
  /// cannot tell its particles apart.
  void set_position(BodyId body, const Vec3& center_of_mass);
  /// Adds momentum [N s] to the particles of a body that are not pinned, the same to each. Throws as
  /// set_velocity() does.
  void add_impulse(BodyId body, const Vec3& impulse);
  /// Adds momentum [N s] to what is in a ball [m], most in its middle and none at its rim: as (1 − r²/R²)² of
  /// the mass there. Returns how many particles got some; where there is none, none is given. Throws as
  /// set_velocity() does.
  std::size_t add_impulse(const Vec3& center, float radius, const Vec3& impulse);
  /// A body that is not enabled stands where it is, is met by nothing, taken by no sink, and costs nothing.
  /// The nozzle of a strand stands still with it, and so does its clock: enabled again it goes on from where
  /// it stood, and its start, stop, keyframes and keys of the speed come later by that. It is still seen in
  /// every view, goes on as fast as it was when it is enabled again, and nothing may be added where it
  /// overlaps it: enabled again, the two would stand in one place. Throws ConfigError where there is none of
  /// this id, or no longer.
  void enable(BodyId body, bool enabled);
  /// As set last; true at first. Throws as enable() does.
  bool is_enabled(BodyId body) const;
  /// From the next step on events() tells where bodies begin and cease to touch colliders and each other, and
  /// with `hit_impulse` [N s], >= 0, each step in which one gets at least that from what it touches; what
  /// lies still gets m |g| Δt. That holds for all bodies that there are and that come; nullopt: for none, and
  /// what was told of is forgotten. Two touch while some particles push or hold each other, and until none
  /// have for 4 time_steps, so that no tremble parts them; they do so in sleep, and part where one is removed
  /// or not enabled. Bodies that merge, or that SolverConfig::contact keeps apart by pressure, do not touch
  /// each other. Costs a fortieth of a step in a heap of small cubes, less where less touches, and nothing
  /// where it is not asked for. Throws ConfigError where the impulse is out of range, or there is no such
  /// body.
  void report_contacts(std::optional<double> hit_impulse = std::numeric_limits<double>::infinity());
  /// The same for all contacts of one body; of two that say it the lower impulse counts.
  void report_contacts(BodyId body,
                       std::optional<double> hit_impulse = std::numeric_limits<double>::infinity());
  /// What an application wants to find with a body again: any 64 bits, that no step looks at; saved with it.
  /// Throws ConfigError where there is none of this id, or no longer.
  void set_user_data(BodyId body, std::uint64_t data);
  /// As set last; 0 at first. Throws as set_user_data() does.
  std::uint64_t user_data(BodyId body) const;
  /// Ends the sleep of a body and of those that fell asleep with it (SolverConfig::sleep_speed). What moves
  /// beside it or pushes it, and every call here that changes something near it, does that too. Where it is
  /// awake, or not enabled, nothing changes. Throws ConfigError where there is none of this id, or no longer.
  void wake(BodyId body);
  /// It is enabled and does not sleep: steps move it. Throws as wake() does.
  bool is_awake(BodyId body) const;

  /// Allocates, sorts and builds what the first step needs; step() does it where it was not done. The first
  /// call settles what a config leaves out, from the bodies that are there; later ones do not change it.
  /// Where no particle has come yet, they are left to a later call, and steps only pass the time: a level may
  /// begin empty where SolverConfig::time_step is given. Throws ConfigError where nothing says how long a
  /// step is, steps are too long for a material's springs, or neighbour lists would take more than
  /// memory_limit.
  void prepare();
  /// One step of algorithm 3.3 of the paper. Throws StepError and keeps the state where Δt would fall below
  /// Δt0/1000 or a number is not finite: it names the particle and the phase.
  StepReport step();
  /// One step on the way to the time `end` [s], after time(): the fewest equal steps that the limits on Δt
  /// allow share what is left, and this is the first of them. A varying Δt lets the energy of a swinging body
  /// drift, so the last step is no sliver; where one step is enough, time() is `end` after it, to the last
  /// bit. Throws ConfigError where `end` is not after time(), and what step() throws.
  StepReport step_towards(double end);
  /// As many steps as `seconds` take, in [0, ∞): time() is time() + seconds after them, to the last bit.
  /// Throws ConfigError where that is no such number, and what step() throws: then the steps before that one
  /// were taken, as time() tells.
  AdvanceReport advance(double seconds);

  /// Of all bodies.
  std::size_t particle_count() const;
  /// As many as bodies() has.
  std::size_t body_count() const;
  /// Those that there are, in the order of their rows.
  std::vector<BodyId> bodies() const;
  /// The first body of this name, in the order of bodies(); nullopt where none is called so. The first call
  /// looks at each body, later ones only at those of the name.
  std::optional<BodyId> find_body(std::string_view name) const;
  /// As it was added; where that was without one, a name was made. Valid until bodies come or go. Throws
  /// ConfigError where there is none of this id, or no longer.
  const std::string& name(BodyId body) const;
  /// What happened to bodies in the last step, and in calls since the one before it; contacts by ascending
  /// ids, for each body colliders first. The same for any number of threads.
  std::span<const BodyEvent> events() const;
  double time() const;              ///< simulated time [s]
  std::int64_t step_count() const;  ///< steps taken
  /// As given; from the first prepare() on with the time_step that is in force. What else was left out,
  /// info() tells.
  const SolverConfig& config() const;
  /// As given, in the poses that they have now, in the order in which they were added; see collider_ids().
  const std::vector<Collider>& colliders() const;
  /// Of each of colliders().
  std::vector<ColliderId> collider_ids() const;
  const Collider& collider(ColliderId id) const;  ///< throws ConfigError where there is none
  /// What particles gave a collider in the last step; zeros before the first. What sleeps goes on pushing as
  /// it did in the step after which it fell asleep. Its measure_load must be set: else ConfigError. Summed in
  /// double, in an order that does not depend on the number of threads.
  ColliderLoad load(ColliderId id) const;

  /// The particle of each row; sorting moves rows, never ids.
  std::span<const ParticleId> ids() const;
  /// [m]. A scene whose first body is more than a thousand spacings from 0 is kept relative to a point near
  /// it, so that it moves as it would at 0; then this is a copy, in which digits are lost, made once a step.
  VectorView positions() const;
  VectorView velocities() const;  ///< [m/s]
  /// ρ [kg/m³] of the last step; empty where no SPH ran. By poly6 [TK eq. 3], or by Wendland's kernel where
  /// volume_iterations run.
  std::span<const float> densities() const;
  /// Alpha of every row as it acts; empty where no body has its own by particle (Body::alpha,
  /// Body::stiffness, set_alpha()). As prepare() and the last step left it.
  std::span<const float> alphas() const;
  /// Factor on the modulus of every row; empty as alphas() is.
  std::span<const float> stiffnesses() const;
  /// T of every row [K], 0 of bodies that carry no heat; empty where none does.
  std::span<const float> temperatures() const;
  /// The rows of a body in every view.
  struct Rows {
    std::size_t begin, end;
  };
  /// Where the body stands now. Throws ConfigError where there is none of this id.
  Rows rows(BodyId body) const;
  /// h of the body [m]. Throws ConfigError where there is none of this id, or no longer.
  float spacing(BodyId body) const;
  /// What the body is made of. Throws ConfigError where there is none of this id.
  MaterialId material(BodyId body) const;

  /// The row of a particle in every view. Throws ConfigError where there is none of this id, or no longer.
  std::size_t row(ParticleId id) const;
  /// Heat of a body [J], above that of it solid at its solidus, or at 0 K where it has none; 0 where it
  /// carries none. Summed in double over its particles. Throws as spacing() does.
  double heat(BodyId body) const;
  /// Alpha of a particle now. Throws ConfigError as row() does.
  float alpha(ParticleId id) const;
  /// x̄ of a particle [m], relative to a place in the middle of its body's: their mean, until particles come
  /// or go. Throws ConfigError as row() does, and where the body keeps no reference shape. [TK eq. 7]
  Vec3 rest_position(ParticleId id) const;
  /// R of the region that a particle owns, as the last step left it; with a region_stride above 1, of the
  /// first region that it is in. Throws as rest_position() does. [TK eq. 7]
  Eigen::Quaternionf rotation(ParticleId id) const;
  /// rest_position() of all particles of a body: entry k is of row rows(body).begin + k. Throws ConfigError
  /// where there is no such body, and where it keeps no reference shape.
  VectorView rest_positions(BodyId body) const;
  /// rotation() of all particles of a body, in the same order. Throws as rest_positions() does.
  RotationView rotations(BodyId body) const;

  /// Copies in the order of slots, whatever that of rows is: entry i is particle i where none was removed.
  std::vector<Vec3> positions_by_id() const;
  /// @copydoc positions_by_id()
  std::vector<Vec3> velocities_by_id() const;
  std::vector<std::uint32_t> bodies_by_id() const;  ///< slot of the body of each particle

  /// The first particle that a ray meets, of bodies that are enabled: the ball around it, as large as
  /// surfaces are drawn around it by default. direction: of any length but 0. farthest: [m], may be infinite.
  /// Looks at every particle for the boxes of their blocks. Throws ConfigError where a number is not finite,
  /// direction is 0, or farthest below 0.
  std::optional<BodyHit> raycast(const Vec3& origin, const Vec3& direction,
                                 double farthest = std::numeric_limits<double>::infinity()) const;
  /// The first surface of a collider that a ray meets from where particles may be. Looks at every collider.
  /// Throws as raycast() does.
  std::optional<ColliderHit> raycast_colliders(
      const Vec3& origin, const Vec3& direction,
      double farthest = std::numeric_limits<double>::infinity()) const;
  /// Particles of enabled bodies whose centres are in a box [m], by ascending id. Looks at every particle.
  /// Its corners may be infinite; throws ConfigError where min is above max, or either is not a number.
  std::vector<ParticleId> particles_in(const Aabb& box) const;
  /// The same in a ball [m]. Throws ConfigError where a number is not finite, or radius not above 0.
  std::vector<ParticleId> particles_in(const Vec3& center, float radius) const;
  /// The particle of an enabled body that is nearest to a point [m]; nullopt where there is none. Looks at
  /// every particle. Throws ConfigError where a number is not finite.
  std::optional<NearestParticle> nearest_particle(const Vec3& point) const;
  /// The box around the centres of a body's particles [m]. Looks at each of them. Throws ConfigError where
  /// there is none of this id, or no longer.
  Aabb bounds(BodyId body) const;
  /// What a body does as a whole: sums in double over its particles, in one order. Throws as bounds() does.
  BodyMotion motion(BodyId body) const;

  /// Energies as they are now, summed in double; slow, as every region is solved exactly. SPH pressure keeps
  /// no energy that could be summed, so a fluid's is what it moves and falls with. What prepare() would do is
  /// done first, and throws what that throws.
  Energy energy() const;
  /// Those of one body, pinned particles left out; as costly, for its particles. Throws ConfigError where
  /// there is none of this id.
  Energy energy(BodyId body) const;
  /// The space that a body takes up [m³]. Where SPH ran in the last step, of its particles by their
  /// densities, mass over density, one that is less dense than at rest as at rest: how it is compressed, not
  /// how it is stretched. Else, where shapes are matched, of its particles at rest times the mean determinant
  /// of the affine maps that take regions from their rest shapes to where they are: a reference shape that
  /// has given way to a compressed one knows of that no more. Else of its particles at rest. Summed in
  /// double, as slow as energy(), and throws as that does.
  double volume(BodyId body) const;

  /// In how many parts a body is now; in one where no shapes are matched. Looks at all its regions. What
  /// prepare() would do is done first, as energy() does it, and throws what that throws, or as bounds() does.
  BodyParts parts(BodyId body) const;

  /// 64 bits of positions and velocities in id order, time and step: equal states have equal hashes.
  std::uint64_t state_hash() const;
  /// All that later steps depend on; engine/STEP.md lists it. Not the force callback, which no bytes can
  /// hold.
  SavedState save() const;
  /// A simulation that goes on where a saved one stood: with the same bits as that one, by the same build of
  /// mallow, with any number of threads. Whoever had set a force sets it again before the next step.
  /// densities() and events() are empty until then, and instruction_level is the machine's best. Throws
  /// ConfigError that names the chunk where a state is not whole, is of another version, or holds what no
  /// simulation could.
  static Simulation restore(const SavedState& saved, int threads = 0,
                            std::shared_ptr<Executor> executor = nullptr);

  /// What runs and what it holds. What prepare() would do is done first, as energy() does it.
  SimulationInfo info() const;

  struct State;  ///< internal

 private:
  friend struct StateAccess;  // of tests
  std::unique_ptr<State> state_;
};

}  // namespace mallow
